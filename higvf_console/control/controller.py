"""The HI-GVF controller: one control period of the team, from positions to nominal velocities. Start reading here.

    recover             deadlock recovery stages
    attend              links and components; fire values theta, targets, robot intentions v_t     [10]-[13]
                        path parameter w                                                           [2]
    guide               human intention v_h of the influenced robot                                [2], [9]
    keep_formation      formation velocities v_f                                                   [14]
    share               shared intentions v_s                                                      [15], [16]
    blend               blending weights lambda, blended velocity                                  [17]-[19]
    go_round            composite field: circulation round obstacles in one direction              [7], [8]

The safety filter turns the nominal velocities into commanded velocities. `printed.compute` is the same period with the
zero-in bumps of [9], [13] and [14] as printed.
"""

import math

import numpy as np

from higvf_console.control.guidance.boundaries import Boundaries, find_boundaries, fire_boundary
from higvf_console.control.guidance.following import broken_away, destination, following, progress
from higvf_console.control.guidance.guiding import agree_circulation, composite_velocity, guiding_vector, has_human
from higvf_console.control.guidance.paths import WINDOW
from higvf_console.control.guidance.recovery import forgotten, formation_grip, receptivity, recover
from higvf_console.control.intention.blending import blended_velocity
from higvf_console.control.intention.formation import formation_velocity
from higvf_console.control.intention.intention import shared_intention
from higvf_console.control.intention.neighbours import components, within
from higvf_console.control.intention.packet_loss import delivered
from higvf_console.control.intention.perception import (
    choose_target,
    fire_value,
    half_angle,
    interval_room,
    robot_intention,
)
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters
from higvf_console.control.plan import Plan, Sight, Situation, planned
from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.state import NOBODY, Intent, Motion, PathKind, PathStatus, World


@kernel
def compute(motion: Motion, intent: Intent, world: World, params: Parameters) -> Plan:
    """Computes one control period of HI-GVF for the whole team, up to the nominal velocities.

    Args:
        motion: state of the robots, fires and path progress.
        intent: active path, influenced robot, priorities, pause and emergency stop.
        world: obstacles, fires, links and formation.
        params: all tunable parameters.

    Returns:
        The nominal velocities, and all terms that led to them.
    """
    recovery_stage, flip = recover(motion, intent.influenced if following(motion, intent) else NOBODY, params)
    at = attend(motion, intent, recovery_stage, world, params)
    robot = at.sight.robot_intention
    human = guide(at.leader, at.path_parameter, motion, intent, params)
    grip = formation_grip(recovery_stage, at.component, at.leader, at.path_idle, params)
    formation = keep_formation(motion.position, grip, world, at.delivered_start, at.delivered_to, params)
    psi = receptivity(
        at.leader, recovery_stage, robot, human, motion.intention, at.delivered_start, at.delivered_to, params
    )
    intention = share(at, psi, robot, human, motion, intent, params)
    blended, blending = blend(intention, formation, at.steered, intent.path.pace, params)
    boundaries = find_boundaries(motion, world, params.safety.obstacle_clearance)
    circulation = agree_circulation(
        blended, motion.position, motion.circulation, at.component, at.leader, flip, boundaries, params.boundaries
    )
    velocity = go_round(blended, at, circulation, boundaries, motion, intent, world, params)
    nominal = limit_speed(velocity, intent, params)
    for i in range(nominal.shape[0]):
        if at.held[i]:
            nominal[i, 0], nominal[i, 1] = 0.0, 0.0
    stages = forgotten(recovery_stage, circulation, motion.stalled)
    return planned(at, robot, human, formation, intention, blended, blending, circulation, stages, nominal)


@kernel
def attend(motion: Motion, intent: Intent, recovery_stage: Ints, world: World, params: Parameters) -> Situation:
    """Perceives the fires, finds the connected components, and updates the progress on the path.

    Args:
        motion: state of the robots, fires and path progress.
        intent: active path, influenced robot, priorities.
        recovery_stage: (N,) deadlock recovery stages in this period.
        world: obstacles, fires and links.
        params: all tunable parameters.

    Returns:
        Links and components, what each robot sees and wants, progress on the path, and who is steered or held.
    """
    start, to = links(motion.position, world, params)
    component = components(start, to)
    sight = perceive(motion, intent.priority, world, params)
    status = broken_away(motion, intent, sight.fire_value, sight.target, component, params)
    stage = recovery_stage[intent.influenced] if recovery_stage.shape[0] > 0 else 0  # a team may have no robots
    w, status, idle, gap, left = progress(motion, intent, status, stage, world, params)
    human = intent.path.kind != PathKind.NONE and status == PathStatus.FOLLOWING
    delivered_start, delivered_to = delivered(start, to, motion.tick, params.robots)
    return Situation(
        link_start=start,
        link_to=to,
        delivered_start=delivered_start,
        delivered_to=delivered_to,
        component=component,
        sight=sight,
        path_parameter=w,
        path_status=status,
        path_idle=idle,
        path_gap=gap,
        path_left=left,
        leader=intent.influenced if human else NOBODY,
        steered=has_human(component, intent.influenced, human),
        held=has_human(component, intent.influenced, status == PathStatus.HOLDING),
    )


@kernel
def links(position: Floats, world: World, params: Parameters) -> tuple[Ints, Ints]:
    """Communication links: those of the world if it gives any, else all pairs within the communication range.

    Returns:
        start (N + 1,) and to (E,): robot i is linked to `to[start[i]:start[i + 1]]`.
    """
    if world.link_start.shape[0] > 0:
        return world.link_start, world.link_to
    return within(position, params.formation.communication_range)


@kernel
def perceive(motion: Motion, priority: Floats, world: World, params: Parameters) -> Sight:
    """Computes each robot's observed fire values (N, M) [rad], target and intention, [10]-[13].

    Robots have no target before the start delay is over.

    Args:
        motion: positions, fires, and the targets so far.
        priority: (P, 3) robot, fire and factor of each prioritised fire.
        world: obstacles and fire positions.
        params: perception, safety, fire and form parameters.
    """
    robots = motion.position.shape[0]
    value = fire_values(motion, priority, world, params)
    target = np.full(robots, NOBODY)
    target_value = np.zeros(robots)
    wanted = np.zeros((robots, 2))
    if motion.tick * params.safety.control_period < params.fires.start_delay:
        return Sight(value, target, target_value, wanted)
    for i in range(robots):
        kept = motion.target[i] if motion.target[i] != NOBODY and motion.fire_burning[motion.target[i]] else NOBODY
        memory = motion.target_value[i] if kept != NOBODY else 0.0
        target[i], target_value[i] = choose_target(value[i], kept, memory, params.perception.target_margin)
        j = target[i]
        if j != NOBODY:
            wanted[i, 0], wanted[i, 1] = robot_intention(
                motion.position[i, 0], motion.position[i, 1], value[i, j] if value[i, j] > 0.0 else target_value[i],
                world.fire_position[j, 0], world.fire_position[j, 1], float(motion.fire_radius[j]), params.perception,
                params.safety, params.fires, params.forms,
            )  # fmt: skip
    return Sight(value, target, target_value, wanted)


@kernel
def fire_values(motion: Motion, priority: Floats, world: World, params: Parameters) -> Floats:
    """Observed fire values theta (N, M) [rad], [10]; those of prioritised fires times their factor, ignoring occlusion.

    Args:
        motion: positions and fires.
        priority: (P, 3) robot, fire and factor of each prioritised fire.
        world: obstacles and fire positions.
        params: holds the perception range.
    """
    robots, fires = motion.position.shape[0], world.fire_position.shape[0]
    value = np.zeros((robots, fires))
    hidden = interval_room(world.capsules)
    for i in range(robots):
        x, y = motion.position[i, 0], motion.position[i, 1]
        for j in range(fires):
            if motion.fire_burning[j]:
                value[i, j] = fire_value(
                    x, y, world.fire_position[j, 0], world.fire_position[j, 1], float(motion.fire_radius[j]),
                    params.perception.perception_range, world.capsules, hidden,
                )  # fmt: skip
        for entry in range(priority.shape[0]):
            j = int(priority[entry, 1])
            if int(priority[entry, 0]) == i and motion.fire_burning[j]:
                distance = math.hypot(x - world.fire_position[j, 0], y - world.fire_position[j, 1])
                value[i, j] = priority[entry, 2] * 2.0 * half_angle(float(motion.fire_radius[j]), distance)
    return value


@kernel
def guide(leader: int, w: float, motion: Motion, intent: Intent, params: Parameters) -> Floats:
    """Human intention v_h (N, 2), [9]: the guiding vector of the `leader`; zero for all others.

    Args:
        leader: the influenced robot while it follows a path, or NOBODY.
        w: path parameter [m].
        motion: holds the positions.
        intent: holds the path.
        params: body radius and path parameters.
    """
    human = np.zeros(motion.position.shape)
    if leader != NOBODY:
        x, y = motion.position[leader, 0], motion.position[leader, 1]
        human[leader, 0], human[leader, 1] = guiding_vector(
            intent.path, w, WINDOW * params.scale.body_radius, x, y, params.path
        )
    return human


@kernel
def is_awake(target: Ints, steered: Bools, held: Bools, component: Ints) -> Bools:
    """(N,) whether each robot's component is active: it is not `held`, and a member has a target or it is `steered`."""
    someone = np.zeros(target.shape[0], np.bool_)  # by component
    for i in range(target.shape[0]):
        if (target[i] != NOBODY or steered[i]) and not held[i]:
            someone[component[i]] = True
    return someone[component]


@kernel
def share(
    at: Situation, psi: float, robot: Floats, human: Floats, motion: Motion, intent: Intent, params: Parameters
) -> Floats:
    """Shared intentions v_s (N, 2) after one control period, [15], [16]; unchanged while the team is paused.

    Args:
        at: neighbour lists, targets and components; v_s is zero in a component that is not awake, see `is_awake`.
        psi: receptivity of the leader to the human intention.
        robot: (N, 2) robot intentions v_t.
        human: (N, 2) human intentions v_h.
        motion: holds the present v_s.
        intent: whether the team is paused.
        params: weights, forms and control period.
    """
    if intent.paused:
        return motion.intention.copy()
    awake = is_awake(at.sight.target, at.steered, at.held, at.component)
    intention, before = np.zeros(robot.shape), motion.intention
    for i in range(robot.shape[0]):
        if awake[i]:
            intention[i, 0], intention[i, 1] = shared_intention(
                i, before[i, 0], before[i, 1], robot[i, 0], robot[i, 1], human[i, 0], human[i, 1],
                psi if i == at.leader else 0.0, before, at.delivered_start, at.delivered_to, params.intention,
                params.forms, params.safety.control_period,
            )  # fmt: skip
    return intention


@kernel
def keep_formation(position: Floats, grip: Floats, world: World, start: Ints, to: Ints, params: Parameters) -> Floats:
    """Formation velocities v_f (N, 2) [m/s], [14], scaled by the formation weight of each robot.

    Args:
        position: (N, 2) [m].
        grip: (N,) formation weights, from 0 to 1.
        world: holds the desired formation.
        start: (N + 1,) with `to`, the links whose messages arrive, in compressed rows.
        to: (F,) the neighbour at the other end of each.
        params: formation and form parameters.
    """
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
    """Blended velocities and their weights, [17]-[19].

    Args:
        intention: (N, 2) shared intentions v_s.
        formation: (N, 2) formation velocities v_f [m/s].
        steered: (N,) whether a human intention acts on the robot.
        pace: scales the velocities of the steered robots.
        params: blending and form parameters.

    Returns:
        Blended velocities (N, 2) [m/s], and lambda (N,).
    """
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
    blended: Floats, at: Situation, circulation: Ints, boundaries: Boundaries, motion: Motion, intent: Intent,
    world: World, params: Parameters,
) -> Floats:  # fmt: skip
    """Velocities (N, 2) [m/s] after the composite step, [7], [8].

    The fire that a robot targets is no obstacle to it, unless the human intention acts on its component: such a robot
    heads for the destination of the path, and the path may pass the fire.

    Args:
        blended: (N, 2) [m/s].
        at: targets, who is steered, and the path parameter.
        circulation: (N, K) see `Motion`.
        boundaries: reactive and repulsive boundaries of this period.
        motion: holds the positions.
        intent: holds the path.
        world: obstacles and fire positions.
        params: boundary and form parameters.
    """
    nominal = np.zeros(blended.shape)
    path_goal = destination(intent.path, at.path_parameter)
    for i in range(blended.shape[0]):
        own_boundary, (goal_x, goal_y) = NOBODY, path_goal
        if not at.steered[i]:
            fire = at.sight.target[i]
            own_boundary = fire_boundary(fire, world)
            goal_x, goal_y = math.nan, math.nan
            if fire != NOBODY:
                goal_x, goal_y = world.fire_position[fire, 0], world.fire_position[fire, 1]
        nominal[i, 0], nominal[i, 1] = composite_velocity(
            blended[i, 0], blended[i, 1], motion.position[i, 0], motion.position[i, 1], i, circulation, own_boundary,
            goal_x, goal_y, boundaries, world, params.boundaries, params.forms,
        )  # fmt: skip
    return nominal


@kernel
def limit_speed(velocity: Floats, intent: Intent, params: Parameters) -> Floats:
    """Scales velocities (N, 2) [m/s] down to the speed limit, and to zero while the team is paused or stopped."""
    nominal = np.zeros(velocity.shape)
    if intent.paused or intent.stopped:
        return nominal
    for i in range(velocity.shape[0]):
        vx, vy = velocity[i, 0], velocity[i, 1]
        speed = math.sqrt(vx * vx + vy * vy)
        share = params.safety.speed_limit / speed if speed > params.safety.speed_limit else 1.0
        nominal[i, 0], nominal[i, 1] = share * vx, share * vy
    return nominal
