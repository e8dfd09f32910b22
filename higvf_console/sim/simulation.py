"""The pure step: one control period from state to state, and many of them without coming back to Python.

    advance   one tick, with its trace: live and headless runs
    roll      k ticks in one call: baselines, previews, studies; bit for bit the same states

Both run `tick`, the one fused kernel.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.controller import Plan, compute
from higvf_console.control.forms import PRINTED
from higvf_console.control.gains import Gains, PackedGains, SafetyGains, packed
from higvf_console.control.guidance.field import FieldKind, field_at
from higvf_console.control.kernel import closed, kernel
from higvf_console.control.safety.coupled_filter import CoupledFilter
from higvf_console.control.safety.safety_filter import filter_velocities
from higvf_console.core.arrays import Bools, Floats, Ints, bools, floats, ints
from higvf_console.core.state import (
    NO_PATH,
    NO_PRIORITY,
    NOBODY,
    Drawing,
    Intent,
    Motion,
    PathStatus,
    SimState,
    Trace,
    World,
)
from higvf_console.sim.disturbances import as_measured
from higvf_console.sim.fires import burn, crews, growth_rates
from higvf_console.sim.metrics import clearances, stalls
from higvf_console.sim.unicycle import body_centres, headings_after


class Rollout(NamedTuple):
    """The history of a roll of T ticks: N robots, M fires.

    Attributes:
        position: (T, N, 2) controlled points [m].
        loss_area: (T, M) [m^2].
        clearance: (T,) smallest of the team [m].
        burning: (T, M) which fires burn.
        deadlocked: (T,) whether a robot was deadlocked.
        infeasible: (T,) whether a robot could not meet all barrier rows.
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
        world: for its rings.
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
        side=np.zeros((robots, len(world.ring) + fires), np.int64),
        stalled=np.zeros(robots),
        rung=np.zeros(robots, np.int64),
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
    return SimState(motion, intent, Drawing(np.full(2, np.nan), np.zeros((0, 2)), "", False, False))


def advance(state: SimState, world: World, gains: Gains) -> tuple[SimState, Trace]:
    """The state one control period later, and why."""
    motion, trace = tick(state.motion, state.intent, world, packed(gains))
    return SimState(motion, state.intent, state.drawing), trace


def advance_coupled(state: SimState, world: World, gains: Gains, safety: CoupledFilter) -> tuple[SimState, Trace]:
    """As `advance`, with the centralised filter in place of the distributed one; it has no fast `roll`."""
    plan, crew, rate, seen = decide(state.motion, state.intent, world, packed(gains))
    filtered = safety.filter_velocities(
        seen, plan.nominal, world.circles, world.bars, world.walls, world.fire_position,
        state.motion.fire_radius, _seen_rate(rate, packed(gains)), state.motion.fire_burning,
        _safety_gains(packed(gains)),
    )  # fmt: skip
    motion, trace = settle(state.motion, state.intent, plan, crew, rate, *filtered, world, packed(gains))
    return SimState(motion, state.intent, state.drawing), trace


def roll(state: SimState, world: World, gains: Gains, ticks: int) -> tuple[SimState, Rollout]:
    """The state `ticks` control periods later, nothing commanded on the way, and the history."""
    motion, history = _roll(state.motion, state.intent, world, packed(gains), ticks)
    return SimState(motion, state.intent, state.drawing), history


@kernel
def tick(motion: Motion, intent: Intent, world: World, gains: PackedGains) -> tuple[Motion, Trace]:
    """Perceive, compute, filter, move, burn."""
    plan, crew, rate, seen = decide(motion, intent, world, gains)
    velocity, active_rows, infeasible = filter_velocities(
        seen, plan.nominal, world.circles, world.bars, world.walls, world.fire_position,
        motion.fire_radius, _seen_rate(rate, gains), motion.fire_burning, _safety_gains(gains),
    )  # fmt: skip
    return settle(motion, intent, plan, crew, rate, velocity, active_rows, infeasible, world, gains)


@kernel
def decide(motion: Motion, intent: Intent, world: World, gains: PackedGains) -> tuple[Plan, Ints, Floats, Floats]:
    """All before the safety filter.

    Returns:
        The controller's plan, made from measured positions; each fire's crew (M,) and growth (M,) [m/s], which depend
        on true ones; and the measured positions (N, 2) [m].
    """
    seen = motion
    if gains[0].robots.position_noise > 0.0:
        seen = as_measured(motion, gains[0].robots)
    plan = compute(seen, intent, world, gains[0])
    crew = crews(motion, plan.steered, world, gains[0])
    return plan, crew, growth_rates(motion, crew, world), seen.position


@kernel
def settle(
    motion: Motion, intent: Intent, plan: Plan, crew: Ints, rate: Floats, velocity: Floats, active_rows: Ints,
    infeasible: Bools, world: World, packed_gains: PackedGains,
) -> tuple[Motion, Trace]:  # fmt: skip
    """All after the safety filter: controlled points move, bodies with them, fires burn, the judges look."""
    gains = packed_gains[0]
    if intent.stopped:
        velocity = np.zeros(velocity.shape)
    radius, fire_progress, burning = burn(motion, crew, rate, world, gains)
    look_ahead, period = gains.robots.look_ahead, gains.safety.control_period
    moved = Motion(
        motion.tick + 1, motion.position + period * velocity,
        headings_after(motion.heading, velocity, look_ahead, period), velocity, plan.intention, plan.target,
        plan.target_value, plan.side, stalls(motion, plan, velocity, active_rows, crew, world, gains), plan.rung,
        radius, fire_progress, burning, plan.path_parameter, plan.path_status, plan.path_idle, plan.path_gap,
        plan.path_left,
        max(motion.robot_peak, _largest(plan.robot_intention)), max(motion.human_peak, _largest(plan.human_intention)),
    )  # fmt: skip
    body = body_centres(moved.position, moved.heading, look_ahead)
    clearance, barrier = clearances(body, radius, burning, world, gains.body)
    trace = Trace(
        plan.fire_value, _terms(plan), plan.blending, active_rows, infeasible,
        moved.stalled >= gains.stall.stall_time, clearance, barrier,
        _pairs(plan.link_start, plan.link_to), plan.component, crew,
    )  # fmt: skip
    return moved, trace


@kernel
def _safety_gains(gains: PackedGains) -> SafetyGains:
    """The filter's tunables as the tuple that it carries in its own tuples (a record cannot be part of one)."""
    safety = gains[0].safety
    return SafetyGains(
        safety.robot_clearance, safety.obstacle_clearance, safety.pair_rate, safety.obstacle_rate, safety.speed_limit,
        safety.control_period, gains[0].forms.h_index,
    )  # fmt: skip


@kernel
def _seen_rate(rate: Floats, gains: PackedGains) -> Floats:
    """Growth of the fires (M,) as the filter's rows know it [m/s]; none in [27] as printed."""
    return np.zeros(rate.shape[0]) if gains[0].forms.fire_row == PRINTED else rate


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
def _roll(motion: Motion, intent: Intent, world: World, gains: PackedGains, ticks: int) -> tuple[Motion, Rollout]:
    position = np.empty((ticks, motion.position.shape[0], 2))
    loss = np.empty((ticks, motion.fire_radius.shape[0]))
    clearance = np.empty(ticks)
    burning = np.empty((ticks, motion.fire_radius.shape[0]), np.bool_)
    deadlocked, infeasible = np.empty(ticks, np.bool_), np.empty(ticks, np.bool_)
    status = np.empty(ticks, np.int64)
    for k in range(ticks):
        motion, trace = tick(motion, intent, world, gains)
        position[k] = motion.position
        loss[k] = math.pi * motion.fire_radius**2
        clearance[k] = trace.clearance.min() if trace.clearance.shape[0] > 0 else math.inf
        burning[k] = motion.fire_burning
        deadlocked[k], infeasible[k] = trace.deadlocked.any(), trace.infeasible.any()
        status[k] = motion.path_status
    return motion, Rollout(position, loss, clearance, burning, deadlocked, infeasible, status)


def warm_up(state: SimState, world: World, gains: Gains) -> None:
    """Compiles everything that a run can call, then forbids compilation: no tick can stall on it."""
    plan, crew, rate, _ = decide(state.motion, state.intent, world, packed(gains))
    robots = len(state.motion.position)
    settle(
        state.motion, state.intent, plan, crew, rate, plan.nominal, np.zeros(robots, np.int64),
        np.zeros(robots, np.bool_), world, packed(gains),
    )  # fmt: skip
    advance(state, world, gains)
    roll(state, world, gains, 1)
    field_at(FieldKind.BLENDED, np.zeros((1, 2)), state, world, gains)
    for function in (decide, settle, tick, _roll):
        closed(function)
