"""Robots keep clear of capsules: obstacles, [26], [27], and burning fires, each with its own R_k = radius + R_o.

A capsule may move and grow. The constraint holds at the end of the control period for the capsule as it is then.
"""

import math

from higvf_console.control.guidance.obstacles import spine_point
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.linear_constraint import activation_distance, class_k, keep_out

_ROUNDING = 1e-6  # share of v_max by which a hazard must be faster to count


@kernel
def capsule_constraint(
    x: float, y: float, ax: float, ay: float, bx: float, by: float, radius: float, vx: float, vy: float, growth: float,
    safety: SafetyParameters,
) -> tuple[float, float, float]:  # fmt: skip
    """The constraint of a capsule, [27] with a dimensionless h, o the point of its spine nearest to the robot p.

    -(p - o).v <= (beta/2) R_k^2 k(h) - (R_next^2 - R_k^2)/(2 dt) - (p - o).do/dt, R_next = R_k + growth dt

    Args:
        x: the robot [m].
        y: the robot [m].
        ax: one end of the spine [m].
        ay: one end of the spine [m].
        bx: the other end [m].
        by: the other end [m].
        radius: of the capsule [m].
        vx: do/dt, displacement of the capsule over the coming control period divided by that period [m/s].
        vy: do/dt [m/s].
        growth: growth of the radius over the coming control period [m/s].
        safety: clearance, rate and control period.

    Returns:
        ax, ay, b of a.v <= b with a unit vector a; b < 0 asks the robot to retreat.
    """
    near_x, near_y = spine_point(x, y, ax, ay, bx, by)
    dx, dy = x - near_x, y - near_y
    clearance = radius + safety.obstacle_clearance
    closing = _growth(clearance, growth, safety) + dx * vx + dy * vy
    return keep_out(dx, dy, clearance, 0.5 * safety.obstacle_gain, closing)


@kernel
def capsule_activation_distance(radius: float, vx: float, vy: float, growth: float, safety: SafetyParameters) -> float:
    """Distance [m] to a capsule's spine from which on its constraint cannot matter."""
    clearance = radius + safety.obstacle_clearance
    fastest = safety.speed_limit + math.sqrt(vx * vx + vy * vy)
    return activation_distance(clearance, 0.5 * safety.obstacle_gain, _growth(clearance, growth, safety), fastest)


@kernel
def capsule_outruns(
    x: float, y: float, ax: float, ay: float, bx: float, by: float, radius: float, vx: float, vy: float, growth: float,
    safety: SafetyParameters,
) -> bool:  # fmt: skip
    """Whether no velocity within v_max keeps h from falling below 0, or from falling further where it is below.

    A violation need not end at a certain rate: a robot always leaves a hazard that stands still.

    Args:
        x: the robot [m].
        y: the robot [m].
        ax: one end of the spine [m].
        ay: one end of the spine [m].
        bx: the other end [m].
        by: the other end [m].
        radius: of the capsule [m].
        vx: velocity of the capsule over the coming control period [m/s].
        vy: velocity of the capsule [m/s].
        growth: growth of the radius over it [m/s].
        safety: clearance, rate, speed limit and control period.
    """
    near_x, near_y = spine_point(x, y, ax, ay, bx, by)
    dx, dy = x - near_x, y - near_y
    distance = math.sqrt(dx * dx + dy * dy)
    clearance = radius + safety.obstacle_clearance
    closing = _growth(clearance, growth, safety) + dx * vx + dy * vy
    margin = class_k(max(distance * distance / (clearance * clearance) - 1.0, 0.0))
    left = 0.5 * safety.obstacle_gain * clearance * clearance * margin - closing
    return left < -safety.speed_limit * (1.0 + _ROUNDING) * distance


@kernel
def _growth(clearance: float, rate: float, safety: SafetyParameters) -> float:
    """(R_next^2 - R_k^2)/(2 dt) [m^2/s]."""
    return rate * (clearance + 0.5 * rate * safety.control_period)
