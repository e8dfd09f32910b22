"""What every barrier shares: the class-K function, and the row that keeps a robot out of a disc.

A row (ax, ay, b) means a.v <= b with a unit vector a, so b is the fastest [m/s] that the robot may move along a. Rows
are made from h = d^2/R^2 - 1, dimensionless: zero at the clearance R, negative inside.
"""

import math

from higvf_console.control.kernel import kernel

COINCIDENT = 1e-9  # [m]; nearer than this there is no direction to move away in


@kernel
def class_k(h: float) -> float:
    """The paper's cube where the robot is safe; a line where it is not, since a cube leaves a violation too slowly."""
    return h * h * h if h >= 0.0 else h


@kernel
def keep_out(
    dx: float, dy: float, clearance: float, rate: float, growth: float, speed_limit: float
) -> tuple[float, float, float]:
    """The row -d.v <= rate R^2 k(h) - growth, divided by |d|.

    Args:
        dx: from the danger to the robot [m].
        dy: from the danger to the robot [m].
        clearance: R, the distance to keep [m].
        rate: how fast the robot may use up its margin [1/s].
        growth: half the rate at which R^2 grows [m^2/s].
        speed_limit: v_max; no row asks for more than -v_max, which the robot can always reach [m/s].

    Returns:
        ax, ay, b of the unit row a.v <= b; where d = 0 the robot leaves along +x.
    """
    distance = math.sqrt(dx * dx + dy * dy)
    if distance < COINCIDENT:
        return -1.0, 0.0, -speed_limit
    h = distance * distance / (clearance * clearance) - 1.0
    b = (rate * clearance * clearance * class_k(h) - growth) / distance
    return -dx / distance, -dy / distance, max(b, -speed_limit)


@kernel
def activation_distance(clearance: float, rate: float, growth: float, speed_limit: float) -> float:
    """Distance [m] from which on a row of `keep_out` allows more than `speed_limit`, so that it cannot matter.

    The root of rate R h^3 = v_max sqrt(1 + h) + growth / R, by Newton's method from above. The difference is convex, so
    that every iterate is on the safe side.
    """
    cubic = rate * clearance
    constant = max(growth, 0.0) / clearance
    h = max(1.0, math.sqrt((1.5 * speed_limit + constant) / cubic))
    for _ in range(10):
        root = math.sqrt(1.0 + h)
        excess = cubic * h * h * h - speed_limit * root - constant
        h -= excess / (3.0 * cubic * h * h - 0.5 * speed_limit / root)
    return clearance * math.sqrt(1.0 + h) * (1.0 + 1e-12)
