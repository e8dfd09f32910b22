"""Robots keep their distance from each other: [20]-[24], each of a pair takes half."""

import math

from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.linear_constraint import COINCIDENT, activation_distance, keep_out


@kernel
def pair_constraint(
    x: float, y: float, other_x: float, other_y: float, first: bool, safety: SafetyParameters
) -> tuple[float, float, float]:
    """A robot's half of a pair, [24] with a dimensionless h: -r.v_i <= (alpha/4) R_r^2 k(h), r = p_i - p_j.

    The coupled constraint of the pair, [22], has the same direction and twice the bound: a.v_i - a.v_j <= 2 b.

    Args:
        x: the robot [m].
        y: the robot [m].
        other_x: the other robot [m].
        other_y: the other robot [m].
        first: whether the robot has the smaller index; robots in one place part by it.
        safety: clearance and rate.

    Returns:
        ax, ay, b of a.v <= b with a unit vector a.
    """
    dx, dy = x - other_x, y - other_y
    if abs(dx) < COINCIDENT and abs(dy) < COINCIDENT:
        return (1.0 if first else -1.0), 0.0, -math.inf
    return keep_out(dx, dy, safety.robot_clearance, 0.25 * safety.pair_gain, 0.0)


@kernel
def sensing_radius(safety: SafetyParameters) -> float:
    """r* [m]: robots farther apart cannot matter to each other in this tick."""
    return activation_distance(safety.robot_clearance, 0.25 * safety.pair_gain, 0.0, safety.speed_limit)
