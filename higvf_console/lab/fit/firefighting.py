"""Fast firefighting runs without a session, with an optional scripted operator; bit for bit as `run_headless`.

A tick of a session costs several times that of the kernel, and a fit needs ten thousand runs. These runs publish no
snapshots. They skip the time before the team moves, advance tick by tick while the operator may still act, as a session
does, and then in chunks that end where a fire goes out.
"""

import math
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
    state, clearance = (setup.start if operator else state_before_departure(setup)), math.inf
    out: tuple[int, ...] = ()
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
        out += tuple(int(fire) for fire in (burning & ~state.motion.fire_burning).nonzero()[0])
    return FirefightingRun(tuple(fire + 1 for fire in out), loss_area(state.motion), state.motion.tick, clearance)


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
    time, intent = state.motion.tick * setup.params.safety.control_period, state.intent
    context = OperatorContext(
        time=time,
        operator="operator",
        viewport=None,
        clutch=state.pointer_state.clutch,
        paused=intent.paused,
        influenced=intent.influenced,
        extinguished=out,
        robots=len(state.motion.position),
    )
    for command in operator.poll(context):
        state, _ = apply_command(state, command, setup)
    return state, operator.health(time).state is not ChannelState.ENDED


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
