"""The controller, one control period: perceive, intend, keep formation, share, blend, go round. Start reading here.

    links, components            who talks to whom
    theta, target, v_t           what each robot sees and wants            [10]-[13]
    w, v_h                       what the human wants of one robot         [2]
    v_s                          what the team makes of it together        [15], [16]
    v_f, lambda, v               the formation, blended in                 [14], [17]-[19]
    composite step               the way round obstacles, on one side      [7], [8]

The result is a nominal velocity for each robot; only the safety filter turns it into motion.
"""

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from higvf_console.arrays import Bools, Floats, Ints
from higvf_console.control.blending import blended_velocity
from higvf_console.control.following import following, progress
from higvf_console.control.formation import formation_velocity
from higvf_console.control.gains import Gains, PackedGains, packed
from higvf_console.control.guiding import agree_sides, composite_velocity, guiding_vector, has_human
from higvf_console.control.intention import shared_intention
from higvf_console.control.kernel import kernel
from higvf_console.control.neighbours import components, within
from higvf_console.control.obstacles import fire_ring, ring_table
from higvf_console.control.paths import EVERYWHERE, WINDOW
from higvf_console.control.perception import choose_target, fire_value, interval_room, robot_intention
from higvf_console.state import NOBODY, Intent, Motion, PathStatus, SimState, World


class Plan(NamedTuple):
    """What one control period decides before the safety filter; fields as in `Motion` and `Trace`."""

    nominal: Floats
    intention: Floats
    target: Ints
    target_value: Floats
    side: Ints
    path_parameter: float
    path_status: int
    path_idle: float
    path_gap: float
    steered: Bools  # (N,) whether a human intention acts in the robot's component
    fire_value: Floats
    robot_intention: Floats
    human_intention: Floats
    formation: Floats
    blending: Floats
    blended: Floats
    link_start: Ints
    link_to: Ints
    component: Ints


@kernel
def compute(motion: Motion, intent: Intent, world: World, gains: Gains) -> Plan:
    """One control period of HI-GVF for the whole team, up to the nominal velocities."""
    robots, fires = motion.position.shape[0], world.fire_position.shape[0]
    start, to = links(motion.position, world, gains)
    component = components(start, to)
    w, status, idle, gap = progress(motion, intent, gains)
    human = following(motion, intent) and status == PathStatus.FOLLOWING
    steered = has_human(component, intent.influenced, human)

    value = np.zeros((robots, fires))
    target = np.full(robots, NOBODY)
    target_value = np.zeros(robots)
    robot = np.zeros((robots, 2))
    awake = np.zeros(robots, np.bool_)  # by component: someone there has a target, or the human acts
    waiting = motion.tick * gains.safety.control_period < gains.fires.start_delay
    hidden = interval_room(world.circles, world.bars)
    for i in range(robots):
        x, y = motion.position[i, 0], motion.position[i, 1]
        for j in range(fires):
            if motion.fire_burning[j]:
                value[i, j] = fire_value(
                    x, y, world.fire_position[j, 0], world.fire_position[j, 1], motion.fire_radius[j],
                    gains.perception.perception_range, world.circles, world.bars, hidden,
                )  # fmt: skip
        if not waiting:
            target[i], target_value[i] = _target(i, value, motion, gains)
        if target[i] != NOBODY:
            fire = target[i]
            seen = value[i, fire] if value[i, fire] > 0.0 else target_value[i]
            robot[i, 0], robot[i, 1] = robot_intention(
                x, y, seen, world.fire_position[fire, 0], world.fire_position[fire, 1], motion.fire_radius[fire],
                gains.perception, gains.safety, gains.fires,
            )  # fmt: skip
        if target[i] != NOBODY or steered[i]:
            awake[component[i]] = True

    guide = np.zeros((robots, 2))
    if human:
        x, y = motion.position[intent.influenced]
        guide[intent.influenced, 0], guide[intent.influenced, 1] = guiding_vector(
            intent.path, w, WINDOW, x, y, gains.path
        )

    intention = np.zeros((robots, 2))
    formation = np.zeros((robots, 2))
    blending = np.zeros(robots)
    blended = np.zeros((robots, 2))
    for i in range(robots):
        x, y = motion.position[i, 0], motion.position[i, 1]
        if intent.paused:
            intention[i] = motion.intention[i]
        elif awake[component[i]]:
            psi = 1.0 if human and i == intent.influenced else 0.0
            intention[i, 0], intention[i, 1] = shared_intention(
                i, motion.intention[i, 0], motion.intention[i, 1], robot[i, 0], robot[i, 1], guide[i, 0], guide[i, 1],
                psi, motion.intention, start, to, gains.intention, gains.safety.control_period,
            )  # fmt: skip
        formation[i, 0], formation[i, 1] = formation_velocity(
            i, x, y, motion.position, world.formation, start, to, gains.formation
        )
        blended[i, 0], blended[i, 1], blending[i] = blended_velocity(
            intention[i, 0], intention[i, 1], formation[i, 0], formation[i, 1], gains.blending
        )

    table = ring_table(motion, world)
    leader = intent.influenced if human else NOBODY
    side = agree_sides(blended, motion.position, motion.side, component, leader, table, gains.rings)
    nominal = np.zeros((robots, 2))
    if not (intent.paused or intent.stopped):
        for i in range(robots):
            own_ring = NOBODY if steered[i] else fire_ring(target[i], world)
            x, y = motion.position[i, 0], motion.position[i, 1]
            vx, vy = composite_velocity(blended[i, 0], blended[i, 1], x, y, i, side, own_ring, table, gains.rings)
            speed = math.sqrt(vx * vx + vy * vy)
            share = gains.safety.speed_limit / speed if speed > gains.safety.speed_limit else 1.0
            nominal[i, 0], nominal[i, 1] = share * vx, share * vy

    return Plan(
        nominal, intention, target, target_value, side, w, status, idle, gap, steered, value, robot, guide, formation,
        blending, blended, start, to, component,
    )  # fmt: skip


@kernel
def links(position: Floats, world: World, gains: Gains) -> tuple[Ints, Ints]:
    """Communication links as rows: the operator's where given, else all robots within the communication range."""
    if world.link_start.shape[0] > 0:
        return world.link_start, world.link_to
    return within(position, gains.formation.communication_range)


@kernel
def _target(i: int, value: Floats, motion: Motion, gains: Gains) -> tuple[int, float]:
    """The target of robot i, and the largest value seen of it; a fire that went out is forgotten."""
    kept = motion.target[i]
    if kept != NOBODY and not motion.fire_burning[kept]:
        kept = NOBODY
    memory = motion.target_value[i] if kept != NOBODY else 0.0
    return choose_target(value[i], kept, memory, gains.perception.target_margin)


class FieldKind(IntEnum):
    """Which vector field is drawn."""

    PATH = 1
    COMPOSITE = 2
    BLENDED = 3


def field_at(kind: FieldKind, points: Floats, state: SimState, world: World, gains: Gains) -> Floats:
    """The vector field at ground points (G, 2) [m]: velocities (G, 2) [m/s].

    PATH is the guiding vector field [2] at cruise speed; COMPOSITE the same round the obstacles [8]; BLENDED what the
    influenced robot would want if it stood there, its neighbours being as they are. Without a path in force the first
    two are zero.
    """
    return _field(int(kind), points, state.motion, state.intent, world, packed(gains))


@kernel
def _field(kind: int, points: Floats, motion: Motion, intent: Intent, world: World, packed_gains: PackedGains) -> Floats:
    gains = packed_gains[0]
    robot = max(intent.influenced, 0)
    human = following(motion, intent)
    target = motion.target[robot]
    start, to = links(motion.position, world, gains)
    hidden = interval_room(world.circles, world.bars)
    table = ring_table(motion, world)
    own_ring = NOBODY if human else fire_ring(target, world)
    field = np.zeros(points.shape)
    for g in range(points.shape[0]):
        x, y = points[g]
        vx, vy, rx, ry = 0.0, 0.0, 0.0, 0.0
        if human:
            window = EVERYWHERE if kind != FieldKind.BLENDED or intent.path.closed else WINDOW
            vx, vy = guiding_vector(intent.path, motion.path_parameter, window, x, y, gains.path)
        if kind == FieldKind.BLENDED:
            if target != NOBODY:
                fx, fy = world.fire_position[target]
                value = fire_value(
                    x, y, fx, fy, motion.fire_radius[target], gains.perception.perception_range, world.circles,
                    world.bars, hidden,
                )  # fmt: skip
                seen = value if value > 0.0 else motion.target_value[robot]
                rx, ry = robot_intention(
                    x, y, seen, fx, fy, motion.fire_radius[target], gains.perception, gains.safety, gains.fires
                )
            sx, sy = shared_intention(
                robot, motion.intention[robot, 0], motion.intention[robot, 1], rx, ry, vx, vy, 1.0 if human else 0.0,
                motion.intention, start, to, gains.intention, math.inf,
            )  # fmt: skip
            fx, fy = formation_velocity(
                robot, x, y, motion.position, world.formation, start, to, gains.formation
            )
            vx, vy, _ = blended_velocity(sx, sy, fx, fy, gains.blending)
        else:
            vx, vy = gains.blending.cruise_speed * vx, gains.blending.cruise_speed * vy
        if kind != FieldKind.PATH:
            vx, vy = composite_velocity(vx, vy, x, y, robot, motion.side, own_ring, table, gains.rings)
        field[g, 0], field[g, 1] = vx, vy
    return field
