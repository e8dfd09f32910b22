"""How far the influenced robot has come along the desired path, and when the human intention ends by itself."""

import math

from higvf_console.control.gains import Gains
from higvf_console.control.kernel import kernel
from higvf_console.control.paths import WINDOW, nearest, travel_left
from higvf_console.state import Intent, Motion, PathKind, PathStatus

EN_ROUTE_PATIENCE = 10.0  # a robot that moves may go round obstacles this many times longer than one that stands


@kernel
def following(motion: Motion, intent: Intent) -> bool:
    """Whether a human intention acts on the team."""
    return intent.path.kind != PathKind.NONE and motion.path_status == PathStatus.FOLLOWING


@kernel
def progress(motion: Motion, intent: Intent, gains: Gains) -> tuple[float, int, float, float]:
    """Path parameter w [m], status, idle time [s] and least travel left [m] after one control period.

    An open path is finished when w is at its end and the robot within the end radius of it. Without progress (no new
    least travel left, or on an endless path no motion) for `patience` it is given up and flagged as BLOCKED; a robot
    that still moves is granted ten times that, since it may be on its way round an obstacle.
    """
    status, idle, gap = motion.path_status, motion.path_idle, motion.path_gap
    if not following(motion, intent):
        return motion.path_parameter, status, idle, gap
    path, robot = intent.path, intent.influenced
    x, y = motion.position[robot]
    w = nearest(path, motion.path_parameter, WINDOW, x, y)[0]
    left = travel_left(path, w, x, y)
    if left < math.inf:
        along = path.length - w if path.direction > 0.0 else w
        if along <= 1e-9 and left <= gains.path.end_radius:
            return w, PathStatus.FINISHED.value, 0.0, left
    if intent.paused or intent.stopped:
        return w, status, idle, gap
    moving = math.hypot(motion.velocity[robot, 0], motion.velocity[robot, 1]) > (
        gains.stall.stall_fraction * gains.blending.cruise_speed
    )
    if left < gap - 1e-6 or (left == math.inf and moving):
        idle, gap = 0.0, min(gap, left)
    else:
        idle += gains.safety.control_period / (EN_ROUTE_PATIENCE if moving else 1.0)
    if idle >= gains.path.patience:
        status = PathStatus.BLOCKED.value
    return w, status, idle, gap
