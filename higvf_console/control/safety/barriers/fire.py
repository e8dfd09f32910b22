"""Robots keep clear of burning fires, whose clearance R_k = radius + R_o grows while they move."""

from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.linear_constraint import activation_distance, keep_out


@kernel
def fire_constraint(
    x: float, y: float, fire_x: float, fire_y: float, radius: float, rate: float, safety: SafetyParameters
) -> tuple[float, float, float]:
    """The row of a fire, so that a robot is as safe of the fire at the end of the control period as of it now.

    -(p - o).v <= (beta/2) R_k^2 k(h) - (R_next^2 - R_k^2)/(2 dt), R_next = R_k + rate dt

    Args:
        x: the robot [m].
        y: the robot [m].
        fire_x: centre of the fire [m].
        fire_y: centre of the fire [m].
        radius: radius of the fire [m].
        rate: growth of the radius over the coming control period [m/s].
        safety: clearance, rate and control period.

    Returns:
        ax, ay, b of the unit row a.v <= b; b < 0 asks the robot to retreat.
    """
    clearance = radius + safety.obstacle_clearance
    growth = _growth(clearance, rate, safety)
    return keep_out(x - fire_x, y - fire_y, clearance, 0.5 * safety.obstacle_gain, growth, safety.speed_limit)


@kernel
def fire_activation_distance(radius: float, rate: float, safety: SafetyParameters) -> float:
    """Distance [m] to a fire's centre from which on its row cannot matter."""
    clearance = radius + safety.obstacle_clearance
    return activation_distance(
        clearance, 0.5 * safety.obstacle_gain, _growth(clearance, rate, safety), safety.speed_limit
    )


@kernel
def _growth(clearance: float, rate: float, safety: SafetyParameters) -> float:
    """(R_next^2 - R_k^2)/(2 dt) [m^2/s]."""
    return rate * (clearance + 0.5 * rate * safety.control_period)
