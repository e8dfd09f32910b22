"""The vector field as it is drawn: the controller's own equations on a grid of points."""

import math
from enum import IntEnum

import numpy as np

from higvf_console.control.controller import links
from higvf_console.control.gains import Gains, PackedGains, packed
from higvf_console.control.guidance.following import destination, following
from higvf_console.control.guidance.guiding import composite_velocity, guiding_vector
from higvf_console.control.guidance.paths import EVERYWHERE, WINDOW
from higvf_console.control.guidance.rings import find_rings, fire_ring
from higvf_console.control.intention.blending import blended_velocity
from higvf_console.control.intention.formation import formation_velocity
from higvf_console.control.intention.intention import shared_intention
from higvf_console.control.intention.perception import fire_value, interval_room, robot_intention
from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Floats
from higvf_console.core.state import NOBODY, Intent, Motion, SimState, World


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
def _field(
    kind: int, points: Floats, motion: Motion, intent: Intent, world: World, packed_gains: PackedGains
) -> Floats:
    gains = packed_gains[0]
    robot = max(intent.influenced, 0)
    human = following(motion, intent)
    target = motion.target[robot]
    start, to = links(motion.position, world, gains)
    hidden = interval_room(world.circles, world.bars)
    rings = find_rings(motion, world, gains.safety.obstacle_clearance)
    own_ring = NOBODY if human else fire_ring(target, world)
    goal_x, goal_y = destination(intent.path, motion.path_parameter)
    if not human and target != NOBODY:
        goal_x, goal_y = world.fire_position[target, 0], world.fire_position[target, 1]
    window = EVERYWHERE if kind != FieldKind.BLENDED or intent.path.closed else WINDOW
    field = np.zeros(points.shape)
    for g in range(points.shape[0]):
        x, y = points[g, 0], points[g, 1]
        vx, vy = 0.0, 0.0
        if human:
            vx, vy = guiding_vector(intent.path, motion.path_parameter, window, x, y, gains.path)
        if kind == FieldKind.BLENDED:
            rx, ry = _wanted(robot, x, y, motion, world, gains, hidden)
            sx, sy = shared_intention(
                robot, motion.intention[robot, 0], motion.intention[robot, 1], rx, ry, vx, vy, 1.0 if human else 0.0,
                motion.intention, start, to, gains.intention, gains.forms, math.inf,
            )  # fmt: skip
            fx, fy = formation_velocity(
                robot, x, y, motion.position, world.formation, start, to, gains.formation, gains.forms
            )
            vx, vy, _ = blended_velocity(sx, sy, fx, fy, gains.blending, gains.forms)
        else:
            vx, vy = gains.blending.cruise_speed * vx, gains.blending.cruise_speed * vy
        if kind != FieldKind.PATH:
            vx, vy = composite_velocity(
                vx, vy, x, y, robot, motion.side, own_ring, goal_x, goal_y, rings, world, gains.rings, gains.forms
            )
        field[g, 0], field[g, 1] = vx, vy
    return field


@kernel
def _wanted(
    robot: int, x: float, y: float, motion: Motion, world: World, gains: Gains, hidden: Floats
) -> tuple[float, float]:
    """Robot intention v_t of a robot if it stood at (x, y), its target unchanged."""
    j = motion.target[robot]
    if j == NOBODY:
        return 0.0, 0.0
    fx, fy, radius = world.fire_position[j, 0], world.fire_position[j, 1], float(motion.fire_radius[j])
    value = fire_value(x, y, fx, fy, radius, gains.perception.perception_range, world.circles, world.bars, hidden)
    seen = value if value > 0.0 else motion.target_value[robot]
    return robot_intention(x, y, seen, fx, fy, radius, gains.perception, gains.safety, gains.fires, gains.forms)
