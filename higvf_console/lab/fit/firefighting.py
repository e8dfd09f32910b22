"""Fast firefighting runs without a session, with an optional scripted operator; bit for bit as `run_headless`.

A tick of a session costs several times that of the kernel, and a fit needs ten thousand runs. These runs publish no
snapshots. They skip the time before the team moves, advance tick by tick while the operator may still act, as a session
does, and then in chunks that end where a fire goes out. An operator who waits for a fire to go out branches off the run
without an operator, so that the ticks before are computed once.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.interface import ChannelState, Interface, OperatorContext
from higvf_console.core.state import PathKind, SimState
from higvf_console.operator.reducer import apply_command
from higvf_console.sim.metrics import loss_area
from higvf_console.sim.simulation import roll
from higvf_console.world.setup import Setup

_CHUNK = 64  # ticks


class FirefightingRun(NamedTuple):
    """Result of a run.

    Attributes:
        order: numbers of the fires, from 1, in the order in which they went out.
        loss_area: (M,) area burnt by each fire [m^2].
        ticks: control periods until all fires were out or the run was ended.
        min_clearance: minimum clearance of the run [m].
    """

    order: tuple[int, ...]
    loss_area: Floats
    ticks: int
    min_clearance: float


class Milestone(NamedTuple):
    """A run at the end of a tick in which fires went out, or at its start.

    Attributes:
        state: the state.
        order: fire indices, in the order in which they went out.
        min_clearance: minimum clearance until then [m].
    """

    state: SimState
    order: tuple[int, ...]
    min_clearance: float


class Branch(NamedTuple):
    """An operator who does nothing before a fire is out.

    Attributes:
        operator: polled once at the start, and then from the tick in which the fire goes out.
        fire: index of the fire.
    """

    operator: Interface
    fire: int


def run_firefighting(
    setup: Setup, duration: float, operator: Interface | None = None, limits: Floats | None = None
) -> FirefightingRun:  # fmt: skip
    """Runs until all fires are out or the duration is over.

    Args:
        setup: world, parameters and start state.
        duration: maximum session time [s].
        operator: polled each tick until its channel has ended; None = no operator.
        limits: (M,) loss areas [m^2]; the run ends early when a fire exceeds its limit.
    """
    start = Milestone(setup.start if operator else state_before_departure(setup), (), math.inf)
    return result(_milestones(start, setup, duration, operator, limits))


def milestones(setup: Setup, duration: float, limits: Floats | None = None) -> tuple[Milestone, ...]:
    """The milestones of the run without an operator; the last one is its end.

    Args:
        setup: world, parameters and start state.
        duration: maximum session time [s].
        limits: (M,) loss areas [m^2]; the run ends early when a fire exceeds its limit.
    """
    start = Milestone(state_before_departure(setup), (), math.inf)
    return tuple(_milestones(start, setup, duration, None, limits))


def result(run: Sequence[Milestone]) -> FirefightingRun:
    """The result of a run, from its milestones."""
    motion = run[-1].state.motion
    order = tuple(fire + 1 for fire in run[-1].order)
    return FirefightingRun(order, loss_area(motion), motion.tick, run[-1].min_clearance)


def run_branch(alone: Sequence[Milestone], branch: Branch, setup: Setup, duration: float) -> FirefightingRun:
    """The run with an operator, from where it leaves the run without one; the result of `run_firefighting`.

    Args:
        alone: milestones of the run without an operator.
        branch: the operator; if its fire never goes out, the result is that of the run without an operator.
        setup: world, parameters and start state.
        duration: maximum session time [s].

    Raises:
        ValueError: the operator acts at the start.
    """
    if branch.operator.poll(_context(setup.start, (), setup)):  # the start: it forgets the run before
        raise ValueError(f"{branch.operator.name} acts at the start, before fire {branch.fire + 1} is out")
    start = next((at for at in alone if branch.fire in at.order), alone[-1])
    return result(_milestones(start, setup, duration, branch.operator, None))


def _milestones(
    start: Milestone, setup: Setup, duration: float, operator: Interface | None, limits: Floats | None
) -> list[Milestone]:
    """The milestones of a run after `start`; the last one is its end."""
    state, out, clearance = start
    found: list[Milestone] = []
    last = math.ceil(duration / setup.params.safety.control_period - 1e-9)
    while state.motion.tick < last and state.motion.fire_burning.any():
        if limits is not None and (loss_area(state.motion) > limits).any():
            break
        ticks = min(_CHUNK, last - state.motion.tick)
        if operator is not None:
            state, busy = _apply_operator(state, operator, out, setup)
            operator, ticks = (operator, 1) if busy else (None, ticks)
        burning = state.motion.fire_burning
        state, nearest = _roll_to_change(state, setup, ticks)
        clearance = min(clearance, nearest)
        gone = tuple(int(fire) for fire in (burning & ~state.motion.fire_burning).nonzero()[0])
        if gone:
            out += gone
            found.append(Milestone(state, out, clearance))
    return [*found, Milestone(state, out, clearance)]


def state_before_departure(setup: Setup) -> SimState:
    """The state one tick before the start delay is over, or the start state if a robot may move before.

    A team in formation, at rest and without a path stands still during the start delay. The fires grow by the same step
    each tick.
    """
    motion, intent, params = setup.start.motion, setup.start.intent, setup.params
    period = params.safety.control_period
    ticks = max(0, math.ceil(params.fires.start_delay / period - 1e-9) - 1)
    at_rest = not motion.velocity.any() and not motion.intention.any() and intent.path.kind == PathKind.NONE
    if ticks == 0 or motion.tick or not at_rest or (motion.position != setup.world.formation).any():
        return setup.start
    growth = np.repeat((setup.world.fire_growth * period)[None], ticks, axis=0)
    radius = np.add.accumulate(np.vstack([motion.fire_radius, growth]))[-1]
    return setup.start._replace(motion=motion._replace(tick=ticks, fire_radius=floats(radius)))


def _apply_operator(state: SimState, operator: Interface, out: tuple[int, ...], setup: Setup) -> tuple[SimState, bool]:
    """Applies the commands of the operator as a session does.

    Returns:
        The next state, and whether the operator may still act.
    """
    for command in operator.poll(_context(state, out, setup)):
        state, _ = apply_command(state, command, setup)
    time = state.motion.tick * setup.params.safety.control_period
    return state, operator.health(time).state is not ChannelState.ENDED


def _context(state: SimState, out: tuple[int, ...], setup: Setup) -> OperatorContext:
    """What an operator is told at a state in which the fires `out` are out."""
    return OperatorContext(
        time=state.motion.tick * setup.params.safety.control_period,
        operator="operator",
        viewport=None,
        clutch=state.pointer_state.clutch,
        paused=state.intent.paused,
        influenced=state.intent.influenced,
        extinguished=out,
        robots=len(state.motion.position),
    )


def _roll_to_change(state: SimState, setup: Setup, ticks: int) -> tuple[SimState, float]:
    """The state after `ticks`, or after the tick in which a fire goes out, and the minimum clearance until then [m]."""
    burning, clearance = state.motion.fire_burning.tobytes(), math.inf
    while True:
        after, history = roll(state, setup.world, setup.params, ticks)
        if after.motion.fire_burning.tobytes() == burning or ticks == 1:
            return after, min(clearance, float(history.clearance.min()))
        half = ticks // 2
        middle, history = roll(state, setup.world, setup.params, half)
        if middle.motion.fire_burning.tobytes() == burning:
            state, clearance, ticks = middle, min(clearance, float(history.clearance.min())), ticks - half
        else:
            ticks = half
