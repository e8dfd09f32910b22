"""Evaluates the vector field at arbitrary points, with the equations of the controller, for drawing."""

import math
from enum import IntEnum

import numpy as np

from higvf_console.control.controller import links
from higvf_console.control.guidance.boundaries import find_boundaries, fire_boundary
from higvf_console.control.guidance.following import destination, following
from higvf_console.control.guidance.guiding import composite_velocity, guiding_vector
from higvf_console.control.guidance.obstacles import world_at
from higvf_console.control.guidance.paths import EVERYWHERE, WINDOW
from higvf_console.control.intention.blending import blended_velocity
from higvf_console.control.intention.formation import formation_velocity
from higvf_console.control.intention.intention import shared_intention
from higvf_console.control.intention.perception import fire_value, interval_room, robot_intention
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import PackedParameters, Parameters, packed
from higvf_console.core.arrays import Floats
from higvf_console.core.state import NOBODY, Intent, Motion, SimState, World


class FieldKind(IntEnum):
    """Which vector field is drawn."""

    PATH = 1
    COMPOSITE = 2
    BLENDED = 3


def field_at(kind: FieldKind, points: Floats, state: SimState, world: World, params: Parameters) -> Floats:
    """Evaluates a vector field at ground points.

    PATH is the guiding vector field [2] at cruise speed, and COMPOSITE its composition with the obstacles [8]; both are
    zero without an active path. BLENDED is the velocity [18] that the influenced robot would want at the point, with
    its neighbours at their present positions.

    Args:
        kind: which field.
        points: (G, 2) [m].
        state: present state.
        world: obstacles, fires, links and formation.
        params: all tunable parameters.

    Returns:
        Velocities (G, 2) [m/s].
    """
    return _field(int(kind), points, state.motion, state.intent, world, packed(params))


@kernel
def _field(
    kind: int, points: Floats, motion: Motion, intent: Intent, world: World, packed_params: PackedParameters
) -> Floats:
    params = packed_params[0]
    world = world_at(world, motion.tick, params.safety.control_period)
    robot = max(intent.influenced, 0)
    human = following(motion, intent)
    target = motion.target[robot]
    start, to = links(motion.position, world, params)
    hidden = interval_room(world.capsules)
    boundaries = find_boundaries(motion, world, params.safety.obstacle_clearance)
    own_boundary = NOBODY if human else fire_boundary(target, world)
    goal_x, goal_y = destination(intent.path, motion.path_parameter)
    if not human and target != NOBODY:
        goal_x, goal_y = world.fire_position[target, 0], world.fire_position[target, 1]
    window = EVERYWHERE if kind != FieldKind.BLENDED or intent.path.closed else WINDOW * params.scale.body_radius
    field = np.zeros(points.shape)
    for g in range(points.shape[0]):
        x, y = points[g, 0], points[g, 1]
        vx, vy = 0.0, 0.0
        if human:
            vx, vy = guiding_vector(intent.path, motion.path_parameter, window, x, y, params.path)
        if kind == FieldKind.BLENDED:
            rx, ry = _wanted(robot, x, y, motion, world, params, hidden)
            sx, sy = shared_intention(
                robot, motion.intention[robot, 0], motion.intention[robot, 1], rx, ry, vx, vy, 1.0 if human else 0.0,
                motion.intention, start, to, params.intention, params.forms, math.inf,
            )  # fmt: skip
            fx, fy = formation_velocity(
                robot, x, y, motion.position, world.formation, start, to, params.formation, params.forms
            )
            vx, vy, _ = blended_velocity(sx, sy, fx, fy, params.blending, params.forms)
        else:
            vx, vy = params.blending.cruise_speed * vx, params.blending.cruise_speed * vy
        if kind != FieldKind.PATH:
            vx, vy = composite_velocity(
                vx,
                vy,
                x,
                y,
                robot,
                motion.circulation,
                own_boundary,
                goal_x,
                goal_y,
                boundaries,
                world,
                params.boundaries,
                params.forms,
            )
        field[g, 0], field[g, 1] = vx, vy
    return field


@kernel
def _wanted(
    robot: int, x: float, y: float, motion: Motion, world: World, params: Parameters, hidden: Floats
) -> tuple[float, float]:
    """Robot intention v_t, [11], of a robot at (x, y) [m] with its present target."""
    j = motion.target[robot]
    if j == NOBODY:
        return 0.0, 0.0
    fx, fy, radius = world.fire_position[j, 0], world.fire_position[j, 1], float(motion.fire_radius[j])
    value = fire_value(x, y, fx, fy, radius, params.perception.perception_range, world.capsules, hidden)
    seen = value if value > 0.0 else motion.target_value[robot]
    return robot_intention(x, y, seen, fx, fy, radius, params.perception, params.safety, params.fires, params.forms)
