"""What every barrier shares: the class-K function, and the linear constraint that keeps a robot out of a disc.

A constraint (ax, ay, b) means a.v <= b with a unit vector a, so b is the fastest [m/s] that the robot may move along a.
It is made from h = d^2/R^2 - 1, dimensionless: zero at the clearance R, negative inside.
"""

import math

from higvf_console.control.kernel import kernel

COINCIDENT = 1e-9  # [m]; nearer than this there is no direction to move away in


@kernel
def class_k(h: float) -> float:
    """The paper's cube where the robot is safe; a line where it is not, since a cube leaves a violation too slowly."""
    return h * h * h if h >= 0.0 else h


@kernel
def keep_out(dx: float, dy: float, clearance: float, rate: float, closing: float) -> tuple[float, float, float]:
    """The constraint -d.v <= rate R^2 k(h) - closing, divided by |d|.

    Args:
        dx: from the hazard to the robot [m].
        dy: from the hazard to the robot [m].
        clearance: R, the distance to keep [m].
        rate: how fast the robot may use up its margin [1/s].
        closing: half the rate at which |d|^2 - R^2 falls while the robot stands still [m^2/s].

    Returns:
        ax, ay, b of a.v <= b; where d = 0 the robot leaves along +x, as fast as it can: b = -inf.
    """
    distance = math.sqrt(dx * dx + dy * dy)
    if distance < COINCIDENT:
        return -1.0, 0.0, -math.inf
    h = distance * distance / (clearance * clearance) - 1.0
    b = (rate * clearance * clearance * class_k(h) - closing) / distance
    return -dx / distance, -dy / distance, b


@kernel
def attainable(b: float, speed_limit: float) -> float:
    """The bound of a constraint, but no lower than -v_max: that much retreat is always possible [m/s]."""
    return max(b, -speed_limit)


@kernel
def activation_distance(clearance: float, rate: float, closing: float, speed: float) -> float:
    """Distance [m] from which on `keep_out` allows more than `speed` [m/s], so that its constraint cannot matter.

    The root of rate R h^3 = speed sqrt(1 + h) + closing / R, by Newton's method from above. The difference is convex,
    so that every iterate is on the safe side.
    """
    cubic = rate * clearance
    constant = max(closing, 0.0) / clearance
    h = max(1.0, math.sqrt((1.5 * speed + constant) / cubic))
    for _ in range(10):
        root = math.sqrt(1.0 + h)
        excess = cubic * h * h * h - speed * root - constant
        h -= excess / (3.0 * cubic * h * h - 0.5 * speed / root)
    return clearance * math.sqrt(1.0 + h) * (1.0 + 1e-12)
