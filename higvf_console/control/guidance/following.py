"""Progress of the influenced robot along the desired path, and the conditions that end the human intention."""

import math

from higvf_console.control.guidance.obstacles import part_at
from higvf_console.control.guidance.paths import WINDOW, nearest, point_at, travel_left
from higvf_console.control.guidance.recovery import EN_ROUTE_TIMEOUTS, GIVE_UP
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats, Ints
from higvf_console.core.state import NOBODY, Intent, Motion, Path, PathEnding, PathKind, PathStatus, World

VAIN_TIMEOUTS = 10.0  # as EN_ROUTE_TIMEOUTS, for a path whose end no robot can reach


@kernel
def following(motion: Motion, intent: Intent) -> bool:
    """Whether the human intention acts on the team."""
    return intent.path.kind != PathKind.NONE and motion.path_status == PathStatus.FOLLOWING


@kernel
def broken_away(
    motion: Motion, intent: Intent, value: Floats, target: Ints, component: Ints, params: Parameters
) -> int:
    """Path status (a `PathStatus`) after perception: a fire of high observed value makes the team leave its path.

    The break-away starts when a robot in the component of the influenced robot observes its target with a value of at
    least `break_away`. It ends when no robot of the component has a target; the path parameter w is kept meanwhile.

    Args:
        motion: holds the present status.
        intent: path and influenced robot.
        value: (N, M) observed fire values [rad].
        target: (N,) target of each robot, or NOBODY.
        component: (N,) connected component of each robot.
        params: holds the threshold `break_away` [rad].
    """
    leaving = following(motion, intent) and params.perception.break_away < math.inf
    away = motion.path_status == PathStatus.BREAK_AWAY
    if not leaving and not away:
        return motion.path_status
    found = False
    for i in range(target.shape[0]):
        if component[i] == component[intent.influenced] and target[i] != NOBODY:
            found = found or away or value[i, target[i]] >= params.perception.break_away
    return PathStatus.BREAK_AWAY.value if found else PathStatus.FOLLOWING.value


@kernel
def progress(
    motion: Motion, intent: Intent, status: int, recovery_stage: int, world: World, params: Parameters
) -> tuple[float, int, float, float, float]:
    """Advances the progress along the path by one control period.

    An open path ends when w is at its end and the robot within the end radius; a looping path then restarts. Every path
    ends when its duration is over.

    A path is BLOCKED after `progress_timeout` without progress: without a new minimum of the remaining travel, or on an
    endless path without motion. A robot that moves or recovers from a deadlock has forty times that time, or ten times
    if no robot can reach the end of the path.

    Args:
        motion: present progress and velocities.
        intent: active path and influenced robot.
        status: present `PathStatus`.
        recovery_stage: of the influenced robot.
        world: obstacles and fires.
        params: end radius and timeouts.

    Returns:
        Path parameter w [m], status, idle time [s], minimum of the remaining travel [m], remaining duration [s].
    """
    idle, gap, time = motion.path_idle, motion.path_gap, motion.path_left
    if intent.path.kind == PathKind.NONE or status != PathStatus.FOLLOWING:
        return motion.path_parameter, status, idle, gap, time
    path, robot = intent.path, intent.influenced
    x, y = motion.position[robot]
    w = nearest(path, motion.path_parameter, WINDOW * params.scale.body_radius, x, y)[0]
    left = travel_left(path, w, x, y)
    if left < math.inf:
        along = path.length - w if path.direction > 0.0 else w
        if along <= 1e-9 and left <= params.path.end_radius:
            if path.ending == PathEnding.LOOP:
                return path.length - w, status, 0.0, math.inf, time
            return w, _ended(path), 0.0, left, time
    if intent.paused or intent.stopped:
        return w, status, idle, gap, time
    time -= params.safety.control_period
    if time <= 0.0:
        return w, _ended(path), 0.0, gap, 0.0
    moving = math.hypot(motion.velocity[robot, 0], motion.velocity[robot, 1]) > (
        params.stall.stall_fraction * params.blending.cruise_speed
    )
    if left < gap - 1e-6 or (left == math.inf and moving):
        idle, gap = 0.0, min(gap, left)
    else:
        hopeful = moving or 0 < recovery_stage < GIVE_UP
        timeouts = EN_ROUTE_TIMEOUTS if hopeful else 1.0
        if hopeful and idle > 0.05 * params.path.progress_timeout and beyond_reach(path, motion, world, params):
            timeouts = VAIN_TIMEOUTS
        idle += params.safety.control_period / timeouts
    if idle >= params.path.progress_timeout:
        status = PathStatus.BLOCKED.value
    return w, status, idle, gap, time


@kernel
def _ended(path: Path) -> int:
    """Status (a `PathStatus`) at the end of a path: HOLDING or FINISHED."""
    return PathStatus.HOLDING.value if path.ending == PathEnding.HOLD else PathStatus.FINISHED.value


@kernel
def beyond_reach(path: Path, motion: Motion, world: World, params: Parameters) -> bool:
    """Whether one obstacle or burning fire blocks every point within the end radius of the end of an open path."""
    x, y = destination(path, 0.0)
    room = params.safety.obstacle_clearance - params.path.end_radius
    if path.closed or math.isnan(x):
        return False
    for k in range(world.capsules.shape[0]):
        if part_at(k, x, y, world)[0] < room:
            return True
    for j in range(world.fire_position.shape[0]):
        distance = math.hypot(x - world.fire_position[j, 0], y - world.fire_position[j, 1])
        if motion.fire_burning[j] and distance - motion.fire_radius[j] < room:
            return True
    return False


@kernel
def destination(path: Path, w: float) -> tuple[float, float]:
    """Destination of a path [m]: the end of an open path, half a lap ahead of w on a closed one, NaN for a line."""
    if path.kind == PathKind.NONE or path.length == math.inf:
        return math.nan, math.nan
    if path.closed:
        x, y, _, _, _, _ = point_at(path, w + 0.5 * path.direction * path.length)
    else:
        x, y, _, _, _, _ = point_at(path, path.length if path.direction > 0.0 else 0.0)
    return x, y
