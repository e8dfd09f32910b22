"""Observed fire value [10], target choice [10] and robot intention [11], [13].

A robot sees a fire under the angular interval of its disc, minus the union of the intervals that nearer obstacles hide.
The union counts two occluders in line only once. Other fires hide nothing.
"""

import math

import numpy as np

from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.guidance.obstacles import spine_point
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import FireParameters, PerceptionParameters, SafetyParameters
from higvf_console.core.arrays import Floats
from higvf_console.core.state import NOBODY


@kernel
def half_angle(radius: float, distance: float) -> float:
    """Half the visual angle of a disc [rad]; pi/2 from inside it."""
    return math.asin(min(1.0, radius / distance)) if distance > 0.0 else math.pi / 2.0


@kernel
def fire_value(
    x: float, y: float, fx: float, fy: float, radius: float, perception_range: float, capsules: Floats, hidden: Floats
) -> float:
    """Observed fire value theta [rad], [10]: the visible angle of a burning fire, 0 beyond `perception_range`.

    Args:
        x: robot position [m].
        y: robot position [m].
        fx: fire position [m].
        fy: fire position [m].
        radius: fire radius [m].
        perception_range: to the fire's edge [m].
        capsules: (K, 5) occluders.
        hidden: work space for the hidden intervals, from `interval_room`.
    """
    count = 0
    dx, dy = fx - x, fy - y
    distance = math.sqrt(dx * dx + dy * dy)
    if distance - radius > perception_range:
        return 0.0
    beta = half_angle(radius, distance)
    if distance == 0.0:
        return 2.0 * beta
    ux, uy = dx / distance, dy / distance
    edge_sin = min(1.0, radius / distance)
    edge_cos = math.sqrt(1.0 - edge_sin * edge_sin)
    for k in range(capsules.shape[0]):
        ax, ay, bx, by, r = capsules[k, 0], capsules[k, 1], capsules[k, 2], capsules[k, 3], capsules[k, 4]
        px, py = spine_point(fx, fy, ax, ay, bx, by)
        to_fire = math.sqrt((fx - px) ** 2 + (fy - py) ** 2)
        depth = (
            (px - x) * ux + (py - y) * uy + (r * ((fx - px) * ux + (fy - py) * uy) / to_fire if to_fire > 0.0 else 0.0)
        )
        if depth >= distance:
            continue
        a_along, a_across = (ax - x) * ux + (ay - y) * uy, (ay - y) * ux - (ax - x) * uy
        if ax == bx and ay == by:
            if a_along > -r and abs(a_across) * edge_cos - a_along * edge_sin < r:
                bearing, half = math.atan2(a_across, a_along), half_angle(r, math.hypot(a_along, a_across))
                count = _hide(hidden, count, bearing - half, bearing + half, beta)
            continue
        b_along, b_across = (bx - x) * ux + (by - y) * uy, (by - y) * ux - (bx - x) * uy
        a_bearing, a_half = math.atan2(a_across, a_along), half_angle(r, math.hypot(a_along, a_across))
        b_bearing, b_half = math.atan2(b_across, b_along), half_angle(r, math.hypot(b_along, b_across))
        if a_bearing > b_bearing:
            a_bearing, a_half, b_bearing, b_half = b_bearing, b_half, a_bearing, a_half
        if b_bearing - a_bearing <= math.pi:
            low, high = min(a_bearing - a_half, b_bearing - b_half), max(a_bearing + a_half, b_bearing + b_half)
            count = _hide(hidden, count, low, high, beta)
        else:  # the capsule passes behind the robot
            count = _hide(hidden, count, -math.pi, a_bearing + a_half, beta)
            count = _hide(hidden, count, b_bearing - b_half, math.pi, beta)
    return max(0.0, 2.0 * beta - union_length(hidden, count))


@kernel
def interval_room(capsules: Floats) -> Floats:
    """Work space (2, n) for the starts and ends of hidden intervals, at most two per capsule."""
    return np.empty((2, 2 * capsules.shape[0]))


@kernel
def _hide(hidden: Floats, count: int, start: float, stop: float, beta: float) -> int:
    """Inserts [start, stop], clipped to the fire's interval [-beta, beta], sorted by start; returns the new count."""
    start, stop = max(start, -beta), min(stop, beta)
    if start >= stop:
        return count
    place = count
    while place > 0 and hidden[0, place - 1] > start:
        hidden[0, place], hidden[1, place] = hidden[0, place - 1], hidden[1, place - 1]
        place -= 1
    hidden[0, place], hidden[1, place] = start, stop
    return count + 1


@kernel
def union_length(intervals: Floats, count: int) -> float:
    """Length of the union of the first `count` intervals (2, n), sorted by their start."""
    total, reached = 0.0, -math.inf
    for i in range(count):
        start, stop = intervals[0, i], intervals[1, i]
        if stop > reached:
            total += stop - max(start, reached)
            reached = stop
    return total


@kernel
def choose_target(value: Floats, target: int, memory: float, margin: float) -> tuple[int, float]:
    """Target fire of a robot, [10], and the largest value observed of it since it was chosen [rad].

    Another fire becomes the target if its value is larger by the factor `margin`. A target that is out of sight is kept
    until another fire is visible; a target without value and memory is dropped.

    Args:
        value: (M,) observed fire values of this robot [rad].
        target: its present target if that burns, else NOBODY.
        memory: largest value observed of that target [rad].
        margin: factor by which the value of another fire must be larger.
    """
    best, most = NOBODY, 0.0
    for j in range(value.shape[0]):
        if value[j] > most:
            best, most = j, value[j]
    if target == NOBODY:
        return best, most
    if best in (NOBODY, target) or (value[target] > 0.0 and most <= margin * value[target]):
        return target, max(memory, value[target])
    return best, most


@kernel
def robot_intention(
    x: float, y: float, value: float, fx: float, fy: float, radius: float,
    perception: PerceptionParameters, safety: SafetyParameters, fires: FireParameters, forms: Forms,
) -> tuple[float, float]:  # fmt: skip
    """Robot intention v_t, [11] corrected: theta * sat(distance to the hold circle / band) * unit vector to the fire.

    The hold circle lies midway between the clearance and the stand-off: a robot on it reaches its fire, and keeps clear
    of it while the fire grows. As printed, -theta phi grad(phi) with phi = distance^2 - radius^2, v_t is 1e6 to 1e8
    where a human intention is at most 1.

    Args:
        x: robot position [m].
        y: robot position [m].
        value: observed value theta of the fire [rad].
        fx: fire position [m].
        fy: fire position [m].
        radius: fire radius [m].
        perception: holds the band [m].
        safety: holds the obstacle clearance [m].
        fires: holds the stand-off [m].
        forms: corrected or printed form.
    """
    dx, dy = fx - x, fy - y
    distance = math.sqrt(dx * dx + dy * dy)
    if distance == 0.0:
        return 0.0, 0.0
    if forms.target == PRINTED:
        slope = 2.0 * value * (distance * distance - radius * radius)
        return slope * dx, slope * dy
    gap = distance - radius - 0.5 * (safety.obstacle_clearance + fires.stand_off)
    pull = value * min(max(gap / perception.target_band, -1.0), 1.0) / distance
    return pull * dx, pull * dy
