"""The distributed filter's core: the exact projection of one velocity on {a.u <= b for each constraint, |u| <= v_max}.

Seidel's incremental method: take the constraints one by one; where the nearest velocity so far breaks the next
constraint, the new one lies on that constraint's line, where the earlier constraints and the speed limit leave an
interval. Constraints that cannot matter are dropped before by a rule that never changes the result.

Constraints are (R, 3): ax, ay, b with unit (ax, ay); velocities and b in m/s.
"""

import math

from higvf_console.control.kernel import kernel
from higvf_console.control.safety.barriers.speed_limit import clipped, half_chord
from higvf_console.core.arrays import Floats, Ints

_ROUNDING = 1e-12  # share of v_max below which a difference is rounding
_EMPTY = 1e-9  # share of v_max by which an interval must be inverted to be empty
_PARALLEL = 1e-12  # sine of the angle below which two constraints are parallel


@kernel
def project(
    vx: float, vy: float, constraints: Floats, count: int, speed_limit: float, kept: Ints
) -> tuple[float, float, bool]:
    """The velocity nearest to (vx, vy) that meets the first `count` constraints and the speed limit.

    Args:
        vx: nominal velocity [m/s].
        vy: nominal velocity [m/s].
        constraints: (R, 3) unit constraints, R >= count.
        count: how many of them hold.
        speed_limit: v_max [m/s].
        kept: (R,) scratch, for the constraints that can matter.

    Returns:
        ux, uy and True; or, where nothing meets all constraints, the last try and False. A nominal velocity that meets
        them all comes back bit for bit.
    """
    vx, vy = clipped(vx, vy, speed_limit)
    slack = True
    for k in range(count):
        slack = slack and constraints[k, 0] * vx + constraints[k, 1] * vy <= constraints[k, 2]
    if slack:
        return vx, vy, True
    used = cull(vx, vy, constraints, count, speed_limit, kept)
    if used < 0:
        return vx, vy, False
    return _seidel(vx, vy, constraints, kept, used, speed_limit)


@kernel
def cull(vx: float, vy: float, constraints: Floats, count: int, speed_limit: float, kept: Ints) -> int:
    """Lists in `kept` the constraints that can shape the projection of (vx, vy); how many, or -1 if nothing meets all.

    If w meets all constraints, the projection lies in the disc with diameter [w, v], so a constraint with b >= the
    largest a.u on that disc, (a.(v + w) + |v - w|)/2, can be dropped. With all b >= 0, w = 0 does; else w is the
    projection of 0 on the constraints with b < 0, if that meets the others as well; if not, all constraints stay.
    """
    used = 0
    for k in range(count):
        if constraints[k, 2] < 0.0:
            kept[used] = k
            used += 1
    wx, wy = 0.0, 0.0
    if used > 0:
        wx, wy, feasible = _seidel(0.0, 0.0, constraints, kept, used, speed_limit)
        if not feasible:
            return -1
        for k in range(count):
            feasible = (
                feasible
                and constraints[k, 0] * wx + constraints[k, 1] * wy <= constraints[k, 2] + _ROUNDING * speed_limit
            )
        if not feasible:
            for k in range(count):
                kept[k] = k
            return count
    used = 0
    across = math.sqrt((vx - wx) ** 2 + (vy - wy) ** 2)
    for k in range(count):
        farthest = 0.5 * (constraints[k, 0] * (vx + wx) + constraints[k, 1] * (vy + wy) + across)
        if constraints[k, 2] < farthest + 1e3 * _ROUNDING * speed_limit:
            kept[used] = k
            used += 1
    return used


@kernel
def _seidel(
    vx: float, vy: float, constraints: Floats, kept: Ints, used: int, speed_limit: float
) -> tuple[float, float, bool]:
    """The projection of a velocity within the speed limit on the `used` constraints listed in `kept`."""
    ux, uy = vx, vy
    for k in range(used):
        ax, ay, b = constraints[kept[k], 0], constraints[kept[k], 1], constraints[kept[k], 2]
        if ax * ux + ay * uy > b + _ROUNDING * speed_limit:
            along, feasible = _on_line(ax * vy - ay * vx, constraints, kept, k, speed_limit)
            if not feasible:
                return ux, uy, False
            ux, uy = ax * b - ay * along, ay * b + ax * along
    return ux, uy, True


@kernel
def _on_line(wanted: float, constraints: Floats, kept: Ints, k: int, speed_limit: float) -> tuple[float, bool]:
    """Where on constraint k's line, counted from its point nearest to 0, the first k allow the nearest to `wanted`."""
    ax, ay, b = constraints[kept[k], 0], constraints[kept[k], 1], constraints[kept[k], 2]
    high = half_chord(b, speed_limit)
    low = -high
    feasible = abs(b) <= speed_limit * (1.0 + _ROUNDING)
    for j in range(k):
        cx, cy = constraints[kept[j], 0], constraints[kept[j], 1]
        room = constraints[kept[j], 2] - b * (ax * cx + ay * cy)
        slope = ax * cy - ay * cx
        if abs(slope) < _PARALLEL:
            feasible = feasible and room >= -_EMPTY * speed_limit
        elif slope > 0.0:
            high = min(high, room / slope)
        else:
            low = max(low, room / slope)
    if low > high:
        feasible = feasible and low - high <= _EMPTY * speed_limit
        return 0.5 * (low + high), feasible
    return min(max(wanted, low), high), feasible
