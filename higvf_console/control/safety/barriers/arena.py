"""Robots stay inside the walls of the arena."""

from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.linear_constraint import class_k


@kernel
def wall_constraint(
    x: float, y: float, normal_x: float, normal_y: float, offset: float, safety: SafetyParameters
) -> tuple[float, float, float]:
    """The constraint of a wall: -n.v <= beta R_o k(h), h = (n.p - w)/R_o - 1.

    Args:
        x: the robot [m].
        y: the robot [m].
        normal_x: unit inward normal n.
        normal_y: unit inward normal n.
        offset: w; inside means n.p >= w [m].
        safety: clearance and rate.

    Returns:
        ax, ay, b of a.v <= b with a unit vector a.
    """
    clearance = safety.obstacle_clearance
    h = (normal_x * x + normal_y * y - offset) / clearance - 1.0
    return -normal_x, -normal_y, safety.obstacle_gain * clearance * class_k(h)
