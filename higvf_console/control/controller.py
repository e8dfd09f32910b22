"""The controller, one control period: perceive, intend, keep formation, share, blend, go round. Start reading here.

    recover                      the way out of a deadlock, stage by stage
    attend                       who talks to whom, what each robot sees and wants        [10]-[13]
                                 how far the influenced one has come on its path          [2]
    guide                        what the human wants of one robot: v_h                   [2], [9]
    keep_formation               the formation: v_f                                       [14]
    share                        what the team makes of it together: v_s                  [15], [16]
    blend                        lambda, v                                                [17]-[19]
    go_round                     the way round obstacles, on one side                     [7], [8]

The result is a nominal velocity for each robot; only the safety filter turns it into motion. `printed.compute` is the
same period with the zero-in bumps of the paper as printed.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.guidance.boundaries import Boundaries, find_boundaries, fire_boundary
from higvf_console.control.guidance.following import broken_away, destination, following, progress
from higvf_console.control.guidance.guiding import agree_circulation, composite_velocity, guiding_vector, has_human
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


class Situation(NamedTuple):
    """Who talks to whom, sees what, leads and follows, before any velocity is computed; fields as in `Plan`."""

    link_start: Ints
    link_to: Ints
    delivered_start: Ints  # links whose messages arrive in this period
    delivered_to: Ints
    component: Ints
    sight: Sight
    path_parameter: float
    path_status: int
    path_idle: float
    path_gap: float
    path_left: float
    leader: int  # the influenced robot while it follows a path, or NOBODY
    steered: Bools
    held: Bools  # (N,) whether the robot's component waits at the end of a path


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
    recovery_stage, flip = recover(motion, intent.influenced if following(motion, intent) else NOBODY, params)
    at = attend(motion, intent, recovery_stage[intent.influenced], world, params)
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
def planned(
    at: Situation, robot: Floats, human: Floats, formation: Floats, intention: Floats, blended: Floats,
    blending: Floats, circulation: Ints, recovery_stage: Ints, nominal: Floats,
) -> Plan:  # fmt: skip
    """The plan that the steps of one control period add up to."""
    return Plan(
        nominal=nominal,
        intention=intention,
        target=at.sight.target,
        target_value=at.sight.target_value,
        circulation=circulation,
        recovery_stage=recovery_stage,
        path_parameter=at.path_parameter,
        path_status=at.path_status,
        path_idle=at.path_idle,
        path_gap=at.path_gap,
        path_left=at.path_left,
        steered=at.steered,
        fire_value=at.sight.fire_value,
        robot_intention=robot,
        human_intention=human,
        formation=formation,
        blending=blending,
        blended=blended,
        link_start=at.link_start,
        link_to=at.link_to,
        component=at.component,
    )


@kernel
def attend(motion: Motion, intent: Intent, recovery_stage: int, world: World, params: Parameters) -> Situation:
    """What the team knows at the start of a control period; `recovery_stage` is the influenced robot's."""
    start, to = links(motion.position, world, params)
    component = components(start, to)
    sight = perceive(motion, intent.priority, world, params)
    status = broken_away(motion, intent, sight.fire_value, sight.target, component, params)
    w, status, idle, gap, left = progress(motion, intent, status, recovery_stage, world, params)
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
    hidden = interval_room(world.circles, world.bars)
    for i in range(robots):
        x, y = motion.position[i, 0], motion.position[i, 1]
        for j in range(fires):
            if motion.fire_burning[j]:
                value[i, j] = fire_value(
                    x, y, world.fire_position[j, 0], world.fire_position[j, 1], float(motion.fire_radius[j]),
                    params.perception.perception_range, world.circles, world.bars, hidden,
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
    at: Situation, psi: float, robot: Floats, human: Floats, motion: Motion, intent: Intent, params: Parameters
) -> Floats:
    """Shared intention v_s (N, 2) after one period: as before while paused, zero for an idle component.

    The leader receives v_h with `psi`.
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
    blended: Floats, at: Situation, circulation: Ints, boundaries: Boundaries, motion: Motion, intent: Intent,
    world: World, params: Parameters,
) -> Floats:  # fmt: skip
    """Velocities (N, 2) [m/s] after the composite step.

    A robot's own fire is no obstacle to it unless the human leads: then the path, to its destination, may pass it.
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
    """Nominal velocities (N, 2) [m/s]: clipped to the speed limit; zero while the team is paused or stopped."""
    nominal = np.zeros(velocity.shape)
    if intent.paused or intent.stopped:
        return nominal
    for i in range(velocity.shape[0]):
        vx, vy = velocity[i, 0], velocity[i, 1]
        speed = math.sqrt(vx * vx + vy * vy)
        share = params.safety.speed_limit / speed if speed > params.safety.speed_limit else 1.0
        nominal[i, 0], nominal[i, 1] = share * vx, share * vy
    return nominal
