"""How far the influenced robot has come along the desired path, and when the human intention ends by itself."""

import math

from higvf_console.control.guidance.obstacles import part_at
from higvf_console.control.guidance.paths import WINDOW, nearest, point_at, travel_left
from higvf_console.control.guidance.recovery import EN_ROUTE_TIMEOUTS, GIVE_UP
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats, Ints
from higvf_console.core.state import NOBODY, Intent, Motion, Path, PathEnding, PathKind, PathStatus, World

VAIN_TIMEOUTS = 10.0  # as EN_ROUTE_TIMEOUTS, where no robot can come near enough to the path's end


@kernel
def following(motion: Motion, intent: Intent) -> bool:
    """Whether a human intention acts on the team."""
    return intent.path.kind != PathKind.NONE and motion.path_status == PathStatus.FOLLOWING


@kernel
def broken_away(
    motion: Motion, intent: Intent, value: Floats, target: Ints, component: Ints, params: Parameters
) -> int:
    """Path status (a `PathStatus`) after a look at the fires: a great one makes the team leave its path for the time.

    A fire that looks larger than `break_away` to a robot of the influenced one's component starts it; it ends, with w
    kept, when nobody there has a target any more.

    Args:
        motion: with the status so far.
        intent: path and influenced robot.
        value: (N, M) observed fire values [rad].
        target: (N,) the fires that the robots want.
        component: (N,) names of connected components.
        params: with the threshold.
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
    """Path parameter w [m], status, idle time [s], least travel [m] and time [s] left, one control period on.

    An open path is finished when w is at its end and the robot within the end radius of it; a looping one then starts
    again. When its time is over, any path is finished. Without progress (no new
    least travel left, or on an endless path no motion) for `progress_timeout` it is given up and flagged as BLOCKED.
    A robot that still moves, or is in a stage of deadlock recovery (`recovery_stage` is its own), is granted forty
    times that; ten times where no robot can come near enough to the end.
    """
    idle, gap, time = motion.path_idle, motion.path_gap, motion.path_left
    if intent.path.kind == PathKind.NONE or status != PathStatus.FOLLOWING:
        return motion.path_parameter, status, idle, gap, time
    path, robot = intent.path, intent.influenced
    x, y = motion.position[robot]
    w = nearest(path, motion.path_parameter, WINDOW, x, y)[0]
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
    """Status (a `PathStatus`) of a path that is over."""
    return PathStatus.HOLDING.value if path.ending == PathEnding.HOLD else PathStatus.FINISHED.value


@kernel
def beyond_reach(path: Path, motion: Motion, world: World, params: Parameters) -> bool:
    """Whether every point within the end radius of an open path's end is too near to one obstacle or burning fire."""
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
    """Where a path leads [m]: an open one to its end, a closed one half a lap ahead of w; a line nowhere, NaN."""
    if path.kind == PathKind.NONE or path.length == math.inf:
        return math.nan, math.nan
    if path.closed:
        x, y, _, _, _, _ = point_at(path, w + 0.5 * path.direction * path.length)
    else:
        x, y, _, _, _, _ = point_at(path, path.length if path.direction > 0.0 else 0.0)
    return x, y
