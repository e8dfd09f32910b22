"""The pure step: one control period from state to state, and many of them without coming back to Python.

    advance           one tick, with its trace: live and headless runs
    advance_coupled   the same with the velocities of the centralised safety filter
    roll              k ticks in one call: baselines, previews, studies; bit for bit the same states

All are `run_ticks`, the one fused kernel.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from higvf_console.control import printed
from higvf_console.control.controller import compute
from higvf_console.control.forms import PRINTED
from higvf_console.control.guidance.obstacles import world_at
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import PackedParameters, Parameters, SafetyParameters, filter_parameters, packed
from higvf_console.control.plan import Plan
from higvf_console.control.safety.hazards import hazard_table
from higvf_console.control.safety.safety_filter import filter_velocities
from higvf_console.core.arrays import Bools, Floats, Ints, bools, floats, ints
from higvf_console.core.state import (
    NO_PATH,
    NO_PRIORITY,
    NOBODY,
    Intent,
    Motion,
    PathStatus,
    PointerState,
    SimState,
    Trace,
    World,
)
from higvf_console.sim.disturbances import as_measured, seen_positions
from higvf_console.sim.fires import burn, crews, growth_rates
from higvf_console.sim.metrics import clearances, stalls
from higvf_console.sim.unicycle import body_centres, headings_after

if TYPE_CHECKING:
    from higvf_console.control.safety.coupled_filter import CoupledFilter


class Rollout(NamedTuple):
    """The history of a roll of T ticks: N robots, M fires.

    Attributes:
        position: (T, N, 2) controlled points [m].
        loss_area: (T, M) [m^2].
        clearance: (T,) smallest of the team [m].
        burning: (T, M) which fires burn.
        deadlocked: (T,) whether a robot was deadlocked.
        infeasible: (T,) whether a robot could not meet all barrier constraints.
        path_status: (T,) a `PathStatus`.
    """

    position: Floats
    loss_area: Floats
    clearance: Floats
    burning: Bools
    deadlocked: Bools
    infeasible: Bools
    path_status: Ints


def initial_state(position: Floats, fire_radius: Floats, world: World, heading: float = 0.0) -> SimState:
    """The state at tick 0: robots at rest, all fires burning.

    Args:
        position: (N, 2) controlled points [m].
        fire_radius: (M,) [m].
        world: for its boundaries.
        heading: of all unicycles [rad].
    """
    robots, fires = len(position), len(fire_radius)
    motion = Motion(
        tick=0,
        position=floats(position, -1, 2),
        heading=np.full(robots, heading),
        velocity=np.zeros((robots, 2)),
        intention=np.zeros((robots, 2)),
        target=ints([NOBODY] * robots),
        target_value=np.zeros(robots),
        circulation=np.zeros((robots, len(world.boundary) + fires + len(world.mover)), np.int64),
        stalled=np.zeros(robots),
        recovery_stage=np.zeros(robots, np.int64),
        fire_radius=floats(fire_radius, -1),
        fire_progress=np.zeros(fires),
        fire_burning=bools([True] * fires),
        path_parameter=0.0,
        path_status=int(PathStatus.NONE),
        path_idle=0.0,
        path_gap=math.inf,
        path_left=math.inf,
        robot_peak=0.0,
        human_peak=0.0,
    )
    intent = Intent(NO_PATH, 0, False, False, NO_PRIORITY)
    return SimState(motion, intent, PointerState(np.full(2, np.nan), np.zeros((0, 2)), "", False, False))


class Filtered(NamedTuple):
    """What a safety filter answered: N robots, or none where the distributed filter is to be asked.

    Attributes:
        velocity: (N, 2) [m/s].
        active_constraints: (N,) barrier constraints that shaped the robot's velocity.
        infeasible: (N,) no velocity met all constraints.
    """

    velocity: Floats
    active_constraints: Ints
    infeasible: Bools


_NOT_YET = Filtered(np.zeros((0, 2)), ints([]), bools([]))


def advance(state: SimState, world: World, params: Parameters, budget: float = 0.0) -> tuple[SimState, Trace]:
    """The state one control period later, and why; clearances grow by `budget` [m], see `controlled`."""
    motion, trace = run_ticks(state.motion, state.intent, world, packed(params, budget), 1, _NO_HISTORY, _NOT_YET)
    return SimState(motion, state.intent, state.pointer_state), trace


def advance_coupled(
    state: SimState, world: World, params: Parameters, safety: "CoupledFilter"
) -> tuple[SimState, Trace]:
    """As `advance`, with the centralised filter in place of the distributed one; it has no fast `roll`.

    A first step gives the nominal velocities; the second one moves as the centralised filter answers.
    """
    motion, values = state.motion, packed(params)
    _, trace = run_ticks(motion, state.intent, world, values, 1, _NO_HISTORY, _NOT_YET)
    hazards = hazards_now(motion, trace.crew, world, values)
    seen = seen_positions(motion, params)
    filtered = safety.filter_velocities(seen, trace.nominal, hazards, filter_parameters(params))
    motion, trace = run_ticks(motion, state.intent, world, values, 1, _NO_HISTORY, Filtered(*filtered))
    return SimState(motion, state.intent, state.pointer_state), trace


def roll(state: SimState, world: World, params: Parameters, ticks: int) -> tuple[SimState, Rollout]:
    """The state `ticks` control periods later, nothing commanded on the way, and the history."""
    history = _empty_history(ticks, len(state.motion.position), len(state.motion.fire_radius))
    if ticks == 0:
        return state, history
    motion, _ = run_ticks(state.motion, state.intent, world, packed(params), ticks, history, _NOT_YET)
    return SimState(motion, state.intent, state.pointer_state), history


def _empty_history(ticks: int, robots: int, fires: int) -> Rollout:
    return Rollout(
        position=np.empty((ticks, robots, 2)),
        loss_area=np.empty((ticks, fires)),
        clearance=np.empty(ticks),
        burning=np.empty((ticks, fires), np.bool_),
        deadlocked=np.empty(ticks, np.bool_),
        infeasible=np.empty(ticks, np.bool_),
        path_status=np.empty(ticks, np.int64),
    )


_NO_HISTORY = _empty_history(0, 0, 0)


@kernel
def tick(
    motion: Motion, intent: Intent, now: World, after: World, params: PackedParameters, filtered: Filtered
) -> tuple[Motion, Trace]:
    """One control period: perceive, compute, filter, move, burn.

    Args:
        motion: at its start.
        intent: what the operator asks for.
        now: the world at its start.
        after: the world at its end.
        params: all tunable parameters.
        filtered: the answer of the centralised filter; empty where the distributed one is to be asked.

    Returns:
        The motion at its end, and why.
    """
    plan, crew, rate, seen = decide(motion, intent, now, params)
    velocity, active_constraints, infeasible = filtered.velocity, filtered.active_constraints, filtered.infeasible
    if velocity.shape[0] == 0:
        velocity, active_constraints, infeasible = filter_velocities(
            seen, plan.nominal, _hazards(motion, rate, now, params), _safety_params(params)
        )
    return settle(motion, intent, plan, crew, rate, velocity, active_constraints, infeasible, after, params)


@kernel
def decide(motion: Motion, intent: Intent, world: World, params: PackedParameters) -> tuple[Plan, Ints, Floats, Floats]:
    """All before the safety filter.

    Returns:
        The controller's plan, made from measured positions; each fire's crew (M,) and growth (M,) [m/s], which depend
        on true ones; and the measured positions (N, 2) [m].
    """
    seen = motion
    if params[0].robots.position_noise > 0.0:
        seen = as_measured(motion, params[0].robots)
    if params[0].forms.human == PRINTED:
        plan = printed.compute(seen, intent, world, params[0])
    else:
        plan = compute(seen, intent, world, params[0])
    crew = crews(motion, plan.steered, world, params[0])
    return plan, crew, growth_rates(motion, crew, world), seen.position


@kernel
def settle(
    motion: Motion, intent: Intent, plan: Plan, crew: Ints, rate: Floats, velocity: Floats, active_constraints: Ints,
    infeasible: Bools, world: World, packed_params: PackedParameters,
) -> tuple[Motion, Trace]:  # fmt: skip
    """All after the safety filter: controlled points move, bodies with them, fires burn, metrics are taken.

    Args:
        motion: at the start of the period.
        intent: whether the team is stopped.
        plan: from the controller.
        crew: (M,) robots at work on each fire.
        rate: (M,) growth of each fire [m/s].
        velocity: (N, 2) commanded velocities [m/s].
        active_constraints: (N,) how many shaped the robot's velocity.
        infeasible: (N,) no velocity met all constraints.
        world: at the end of the period.
        packed_params: all tunable parameters.

    Returns:
        The motion at the end of the period, and its trace.
    """
    params = packed_params[0]
    if intent.stopped:
        velocity = np.zeros(velocity.shape)
    radius, fire_progress, burning = burn(motion, crew, rate, world, params)
    look_ahead, period = params.robots.look_ahead, params.safety.control_period
    moved = Motion(
        tick=motion.tick + 1,
        position=motion.position + period * velocity,
        heading=headings_after(motion.heading, velocity, look_ahead, period),
        velocity=velocity,
        intention=plan.intention,
        target=plan.target,
        target_value=plan.target_value,
        circulation=plan.circulation,
        stalled=stalls(motion, plan, velocity, active_constraints, crew, world, params),
        recovery_stage=plan.recovery_stage,
        fire_radius=radius,
        fire_progress=fire_progress,
        fire_burning=burning,
        path_parameter=plan.path_parameter,
        path_status=plan.path_status,
        path_idle=plan.path_idle,
        path_gap=plan.path_gap,
        path_left=plan.path_left,
        robot_peak=max(motion.robot_peak, _largest(plan.robot_intention)),
        human_peak=max(motion.human_peak, _largest(plan.human_intention)),
    )
    body = body_centres(moved.position, moved.heading, look_ahead)
    clearance, barrier = clearances(body, radius, burning, world, params.body)
    trace = Trace(
        fire_value=plan.fire_value,
        terms=_terms(plan),
        blending=plan.blending,
        active_constraints=active_constraints,
        infeasible=infeasible,
        deadlocked=moved.stalled >= params.stall.stall_time,
        clearance=clearance,
        barrier=barrier,
        links=_pairs(plan.link_start, plan.link_to),
        component=plan.component,
        crew=crew,
    )
    return moved, trace


@kernel
def _safety_params(params: PackedParameters) -> SafetyParameters:
    """The filter's tunables as the tuple that it carries in its own tuples (a record cannot be part of one)."""
    safety = params[0].safety
    return SafetyParameters(
        safety.robot_clearance, safety.obstacle_clearance, safety.pair_gain, safety.obstacle_gain, safety.speed_limit,
        safety.control_period, params[0].forms.h_index,
    )  # fmt: skip


@kernel
def hazards_now(motion: Motion, crew: Ints, world: World, params: PackedParameters) -> Floats:
    """The table of hazards (H, 9) that the filter knows at the motion's tick, with (M,) robots at work on each fire."""
    now = world_at(world, motion.tick, params[0].safety.control_period)
    return _hazards(motion, growth_rates(motion, crew, now), now, params)


@kernel
def _hazards(motion: Motion, rate: Floats, now: World, params: PackedParameters) -> Floats:
    """The table; fires grow at `rate` (M,) [m/s], not so in [27] as printed."""
    known = np.zeros(rate.shape[0]) if params[0].forms.fire_constraint == PRINTED else rate
    return hazard_table(
        now.capsules, now.capsule_velocity, now.walls, now.fire_position, motion.fire_radius, known, motion.fire_burning
    )  # fmt: skip


@kernel
def _largest(vectors: Floats) -> float:
    """Length of the longest of vectors (N, 2)."""
    square = 0.0
    for i in range(vectors.shape[0]):
        square = max(square, vectors[i, 0] * vectors[i, 0] + vectors[i, 1] * vectors[i, 1])
    return math.sqrt(square)


@kernel
def _terms(plan: Plan) -> Floats:
    """(N, 5, 2) as `Trace` names them."""
    terms = np.empty((plan.nominal.shape[0], 5, 2))
    for i in range(terms.shape[0]):
        for axis in range(2):
            terms[i, 0, axis] = plan.robot_intention[i, axis]
            terms[i, 1, axis] = plan.human_intention[i, axis]
            terms[i, 2, axis] = plan.formation[i, axis]
            terms[i, 3, axis] = plan.blended[i, axis]
            terms[i, 4, axis] = plan.nominal[i, axis]
    return terms


@kernel
def _pairs(start: Ints, to: Ints) -> Ints:
    """(E, 2) links i < j."""
    pairs = np.empty((to.shape[0] // 2, 2), np.int64)
    count = 0
    for i in range(start.shape[0] - 1):
        for entry in range(start[i], start[i + 1]):
            if to[entry] > i:
                pairs[count, 0], pairs[count, 1] = i, to[entry]
                count += 1
    return pairs


@kernel
def run_ticks(
    motion: Motion, intent: Intent, world: World, params: PackedParameters, ticks: int, history: Rollout,
    filtered: Filtered,
) -> tuple[Motion, Trace]:  # fmt: skip
    """The motion after some control periods, and the trace of the last.

    One entry for single steps and for rolls: the whole controller is compiled once, and both are bit for bit the same.

    Args:
        motion: now.
        intent: what the operator asks for, the same in all periods.
        world: of any tick.
        params: all tunable parameters.
        ticks: how many control periods, at least 1.
        history: receives the first periods, as many as it has room for.
        filtered: as of `tick`.
    """
    period = params[0].safety.control_period
    now = world_at(world, motion.tick, period)
    k = 0
    while True:
        after = world_at(world, motion.tick + 1, period)
        motion, trace = tick(motion, intent, now, after, params, filtered)
        if k < history.clearance.shape[0]:
            _note(k, motion, trace, history)
        k += 1
        if k >= ticks:
            return motion, trace
        now = after


@kernel
def _note(k: int, motion: Motion, trace: Trace, history: Rollout) -> None:
    """Writes tick k into the history."""
    for i in range(motion.position.shape[0]):
        history.position[k, i, 0], history.position[k, i, 1] = motion.position[i, 0], motion.position[i, 1]
    for j in range(motion.fire_radius.shape[0]):
        history.loss_area[k, j] = math.pi * motion.fire_radius[j] ** 2
        history.burning[k, j] = motion.fire_burning[j]
    least, deadlocked, infeasible = math.inf, False, False
    for i in range(trace.clearance.shape[0]):
        if trace.clearance[i] < least or math.isnan(trace.clearance[i]):
            least = trace.clearance[i]
        deadlocked, infeasible = deadlocked or trace.deadlocked[i], infeasible or trace.infeasible[i]
    history.clearance[k], history.deadlocked[k], history.infeasible[k] = least, deadlocked, infeasible
    history.path_status[k] = motion.path_status
