"""Robots keep clear of obstacles: circles and bars, [26], [27], each with its own clearance R_k = radius + R_o."""

from higvf_console.control.guidance.obstacles import spine_point
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.linear_constraint import activation_distance, keep_out


@kernel
def circle_constraint(
    x: float, y: float, centre_x: float, centre_y: float, radius: float, safety: SafetyParameters
) -> tuple[float, float, float]:
    """The row of a circle, [27] with a dimensionless h: -(p - o).v <= (beta/2) R_k^2 k(h).

    Args:
        x: the robot [m].
        y: the robot [m].
        centre_x: centre of the circle [m].
        centre_y: centre of the circle [m].
        radius: radius of the circle [m].
        safety: clearance and rate.

    Returns:
        ax, ay, b of the unit row a.v <= b.
    """
    clearance = radius + safety.obstacle_clearance
    return keep_out(x - centre_x, y - centre_y, clearance, 0.5 * safety.obstacle_gain, 0.0, safety.speed_limit)


@kernel
def capsule_constraint(
    x: float, y: float, ax: float, ay: float, bx: float, by: float, half_width: float, safety: SafetyParameters
) -> tuple[float, float, float]:
    """The row of a bar: that of a circle of its half width round the nearest point of its spine a-b.

    Args:
        x: the robot [m].
        y: the robot [m].
        ax: one end of the spine [m].
        ay: one end of the spine [m].
        bx: the other end [m].
        by: the other end [m].
        half_width: radius of the capsule [m].
        safety: clearance and rate.

    Returns:
        ax, ay, b of the unit row a.v <= b.
    """
    near_x, near_y = spine_point(x, y, ax, ay, bx, by)
    return circle_constraint(x, y, near_x, near_y, half_width, safety)


@kernel
def obstacle_activation_distance(radius: float, safety: SafetyParameters) -> float:
    """Distance [m] to a circle's centre or a bar's spine from which on its row cannot matter."""
    clearance = radius + safety.obstacle_clearance
    return activation_distance(clearance, 0.5 * safety.obstacle_gain, 0.0, safety.speed_limit)
