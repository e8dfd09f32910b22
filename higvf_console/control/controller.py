"""The controller, one control period: perceive, intend, keep formation, share, blend, go round. Start reading here.

    links, components            who talks to whom
    perceive                     what each robot sees and wants: theta, target, v_t       [10]-[13]
    climb                        the way out of a deadlock, a rung at a time
    progress, guide              what the human wants of one robot: w, v_h                [2], [9]
    share                        what the team makes of it together: v_s                  [15], [16]
    keep_formation, blend        the formation, blended in: v_f, lambda, v                [14], [17]-[19]
    go_round                     the way round obstacles, on one side                     [7], [8]

The result is a nominal velocity for each robot; only the safety filter turns it into motion.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.forms import PRINTED
from higvf_console.control.guidance.boundaries import Boundaries, find_boundaries, fire_boundary
from higvf_console.control.guidance.following import broken_away, destination, following, progress
from higvf_console.control.guidance.guiding import (
    agree_circulation,
    composite_velocity,
    guiding_vector,
    has_human,
    zero_in_product,
)
from higvf_console.control.guidance.paths import WINDOW
from higvf_console.control.guidance.recovery import forgotten, formation_grip, receptivity, recover
from higvf_console.control.intention.blending import blended_velocity
from higvf_console.control.intention.formation import formation_velocity
from higvf_console.control.intention.intention import shared_intention
from higvf_console.control.intention.messages import delivered
from higvf_console.control.intention.neighbours import components, within
from higvf_console.control.intention.perception import (
    choose_target,
    fire_value,
    half_angle,
    interval_room,
    robot_intention,
)
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.state import NOBODY, Intent, Motion, PathKind, PathStatus, World


class Sight(NamedTuple):
    """What each robot sees and wants; fields as in `Motion` and `Trace`."""

    fire_value: Floats
    target: Ints
    target_value: Floats
    robot_intention: Floats


class Plan(NamedTuple):
    """What one control period decides before the safety filter; fields as in `Motion` and `Trace`."""

    nominal: Floats
    intention: Floats
    target: Ints
    target_value: Floats
    circulation: Ints
    recovery_stage: Ints
    path_parameter: float
    path_status: int
    path_idle: float
    path_gap: float
    path_left: float
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
def compute(motion: Motion, intent: Intent, world: World, params: Parameters) -> Plan:
    """One control period of HI-GVF for the whole team, up to the nominal velocities."""
    start, to = links(motion.position, world, params)
    component = components(start, to)
    sight = perceive(motion, intent.priority, world, params)
    recovery_stage, flip = recover(motion, intent.influenced if following(motion, intent) else NOBODY, params)
    status = broken_away(motion, intent, sight.fire_value, sight.target, component, params)
    w, status, idle, gap, left = progress(motion, intent, status, recovery_stage[intent.influenced], world, params)
    human = intent.path.kind != PathKind.NONE and status == PathStatus.FOLLOWING
    leader = intent.influenced if human else NOBODY
    steered = has_human(component, intent.influenced, human)
    held = has_human(component, intent.influenced, status == PathStatus.HOLDING)
    wanted, human_intention = sight.robot_intention, guide(leader, w, motion, intent, params)
    delivered_start, delivered_to = delivered(start, to, motion.tick, params.robots)
    grip = formation_grip(recovery_stage, component, leader, idle, params)
    formation = keep_formation(motion.position, grip, world, delivered_start, delivered_to, params)
    if params.forms.human == PRINTED:
        _fade(wanted, human_intention, formation, motion, world, params)
    if intent.paused:
        intention = motion.intention.copy()
    else:
        awake = is_awake(sight.target, steered, held, component)
        psi = receptivity(
            leader, recovery_stage, wanted, human_intention, motion.intention, delivered_start, delivered_to, params
        )
        intention = share(leader, psi, awake, wanted, human_intention, motion, delivered_start, delivered_to, params)
    blended, blending = blend(intention, formation, steered, intent.path.pace, params)
    boundaries = find_boundaries(motion, world, params.safety.obstacle_clearance)
    circulation = agree_circulation(
        blended, motion.position, motion.circulation, component, leader, flip, boundaries, params.boundaries
    )
    if intent.paused or intent.stopped:
        nominal = np.zeros(blended.shape)
    elif params.forms.human == PRINTED:
        nominal = limit_speed(blended, params)
    else:
        goal = destination(intent.path, w)
        nominal = limit_speed(
            go_round(blended, sight.target, steered, goal, circulation, boundaries, motion, world, params), params
        )
        for i in range(held.shape[0]):
            if held[i]:
                nominal[i, 0], nominal[i, 1] = 0.0, 0.0
    return Plan(
        nominal=nominal,
        intention=intention,
        target=sight.target,
        target_value=sight.target_value,
        circulation=circulation,
        recovery_stage=forgotten(recovery_stage, circulation, motion.stalled),
        path_parameter=w,
        path_status=status,
        path_idle=idle,
        path_gap=gap,
        path_left=left,
        steered=steered,
        fire_value=sight.fire_value,
        robot_intention=wanted,
        human_intention=human_intention,
        formation=formation,
        blending=blending,
        blended=blended,
        link_start=start,
        link_to=to,
        component=component,
    )


@kernel
def links(position: Floats, world: World, params: Parameters) -> tuple[Ints, Ints]:
    """Communication links as rows: the operator's where given, else all robots within the communication range."""
    if world.link_start.shape[0] > 0:
        return world.link_start, world.link_to
    return within(position, params.formation.communication_range)


@kernel
def perceive(motion: Motion, priority: Floats, world: World, params: Parameters) -> Sight:
    """Each robot's observed fire values (N, M), target and intention; no targets before the start delay is over.

    What the operator gave `priority` (P, 3) to, see `Intent`, a robot values as often more, as if nothing hid it.
    """
    robots, fires = motion.position.shape[0], world.fire_position.shape[0]
    value = np.zeros((robots, fires))
    target = np.full(robots, NOBODY)
    target_value = np.zeros(robots)
    wanted = np.zeros((robots, 2))
    waiting = motion.tick * params.safety.control_period < params.fires.start_delay
    hidden = interval_room(world.capsules)
    for i in range(robots):
        x, y = motion.position[i, 0], motion.position[i, 1]
        for j in range(fires):
            if motion.fire_burning[j]:
                value[i, j] = fire_value(
                    x, y, world.fire_position[j, 0], world.fire_position[j, 1], float(motion.fire_radius[j]),
                    params.perception.perception_range, world.capsules, hidden,
                )  # fmt: skip
        for row in range(priority.shape[0]):
            j = int(priority[row, 1])
            if int(priority[row, 0]) == i and motion.fire_burning[j]:
                distance = math.hypot(x - world.fire_position[j, 0], y - world.fire_position[j, 1])
                value[i, j] = priority[row, 2] * 2.0 * half_angle(float(motion.fire_radius[j]), distance)
        if waiting:
            continue
        kept = motion.target[i] if motion.target[i] != NOBODY and motion.fire_burning[motion.target[i]] else NOBODY
        memory = motion.target_value[i] if kept != NOBODY else 0.0
        target[i], target_value[i] = choose_target(value[i], kept, memory, params.perception.target_margin)
        j = target[i]
        if j != NOBODY:
            wanted[i, 0], wanted[i, 1] = robot_intention(
                x, y, value[i, j] if value[i, j] > 0.0 else target_value[i], world.fire_position[j, 0],
                world.fire_position[j, 1], float(motion.fire_radius[j]), params.perception, params.safety, params.fires,
                params.forms,
            )  # fmt: skip
    return Sight(value, target, target_value, wanted)


@kernel
def guide(leader: int, w: float, motion: Motion, intent: Intent, params: Parameters) -> Floats:
    """Human intention v_h (N, 2): the guiding vector for the influenced robot, zero for all others."""
    human = np.zeros(motion.position.shape)
    if leader != NOBODY:
        x, y = motion.position[leader, 0], motion.position[leader, 1]
        human[leader, 0], human[leader, 1] = guiding_vector(intent.path, w, WINDOW, x, y, params.path)
    return human


@kernel
def is_awake(target: Ints, steered: Bools, held: Bools, component: Ints) -> Bools:
    """(N,) whether anyone in each robot's component has a target or feels the human; else, or `held`, it is idle."""
    someone = np.zeros(target.shape[0], np.bool_)  # by component
    for i in range(target.shape[0]):
        if (target[i] != NOBODY or steered[i]) and not held[i]:
            someone[component[i]] = True
    return someone[component]


@kernel
def share(
    leader: int, psi: float, awake: Bools, robot: Floats, human: Floats, motion: Motion, start: Ints, to: Ints,
    params: Parameters,
) -> Floats:  # fmt: skip
    """Shared intention v_s (N, 2) after one period; zero for an idle component. The leader receives v_h with `psi`."""
    intention, before = np.zeros(robot.shape), motion.intention
    for i in range(robot.shape[0]):
        if awake[i]:
            intention[i, 0], intention[i, 1] = shared_intention(
                i, before[i, 0], before[i, 1], robot[i, 0], robot[i, 1], human[i, 0], human[i, 1],
                psi if i == leader else 0.0, before, start, to, params.intention, params.forms,
                params.safety.control_period,
            )  # fmt: skip
    return intention


@kernel
def keep_formation(position: Floats, grip: Floats, world: World, start: Ints, to: Ints, params: Parameters) -> Floats:
    """Formation velocities v_f (N, 2) [m/s], each times the robot's `grip` (N,)."""
    formation = np.zeros(position.shape)
    for i in range(position.shape[0]):
        formation[i, 0], formation[i, 1] = formation_velocity(
            i, position[i, 0], position[i, 1], position, world.formation, start, to, params.formation, params.forms
        )
        formation[i, 0], formation[i, 1] = grip[i] * formation[i, 0], grip[i] * formation[i, 1]
    return formation


@kernel
def blend(
    intention: Floats, formation: Floats, steered: Bools, pace: float, params: Parameters
) -> tuple[Floats, Floats]:
    """Blended velocities (N, 2) [m/s], those of robots that are steered times `pace`, and their weights lambda (N,)."""
    blended, weight = np.zeros(intention.shape), np.zeros(intention.shape[0])
    for i in range(intention.shape[0]):
        blended[i, 0], blended[i, 1], weight[i] = blended_velocity(
            intention[i, 0], intention[i, 1], formation[i, 0], formation[i, 1], params.blending, params.forms
        )
        if steered[i]:
            blended[i, 0], blended[i, 1] = pace * blended[i, 0], pace * blended[i, 1]
    return blended, weight


@kernel
def go_round(
    blended: Floats, target: Ints, steered: Bools, goal: tuple[float, float], circulation: Ints,
    boundaries: Boundaries, motion: Motion, world: World, params: Parameters,
) -> Floats:  # fmt: skip
    """Velocities (N, 2) [m/s] after the composite step.

    A robot's own fire is no obstacle to it unless the human leads: then the path, to its `goal` [m], may pass it.
    """
    nominal = np.zeros(blended.shape)
    for i in range(blended.shape[0]):
        own_boundary, (goal_x, goal_y) = NOBODY, goal
        if not steered[i]:
            own_boundary = fire_boundary(target[i], world)
            goal_x, goal_y = math.nan, math.nan
            if target[i] != NOBODY:
                goal_x, goal_y = world.fire_position[target[i], 0], world.fire_position[target[i], 1]
        nominal[i, 0], nominal[i, 1] = composite_velocity(
            blended[i, 0], blended[i, 1], motion.position[i, 0], motion.position[i, 1], i, circulation, own_boundary,
            goal_x, goal_y, boundaries, world, params.boundaries, params.forms,
        )  # fmt: skip
    return nominal


@kernel
def limit_speed(velocity: Floats, params: Parameters) -> Floats:
    """Nominal velocities (N, 2) [m/s]: clipped to the speed limit."""
    nominal = np.zeros(velocity.shape)
    for i in range(velocity.shape[0]):
        vx, vy = velocity[i, 0], velocity[i, 1]
        speed = math.sqrt(vx * vx + vy * vy)
        share = params.safety.speed_limit / speed if speed > params.safety.speed_limit else 1.0
        nominal[i, 0], nominal[i, 1] = share * vx, share * vy
    return nominal


@kernel
def _fade(robot: Floats, human: Floats, formation: Floats, motion: Motion, world: World, params: Parameters) -> None:
    """[9], [13], [14] as printed: each intention and velocity times the product of the zero-in bumps, in place."""
    for i in range(robot.shape[0]):
        x, y = motion.position[i, 0], motion.position[i, 1]
        product = zero_in_product(x, y, motion, world, params.boundaries, params.forms)
        for axis in range(2):
            robot[i, axis] *= product
            human[i, axis] *= product
            formation[i, axis] *= product
