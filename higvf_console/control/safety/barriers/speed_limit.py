"""No robot is ever faster than v_max: a disc, the one limit on velocity that is not linear."""

import math

from higvf_console.control.kernel import kernel

_ROUNDING = 1e-12  # a clipped velocity is not clipped again for its last bits


@kernel
def clipped(vx: float, vy: float, speed_limit: float) -> tuple[float, float]:
    """The velocity itself, bit for bit, within the limit; else shortened to it [m/s]."""
    speed = math.sqrt(vx * vx + vy * vy)
    if speed <= speed_limit * (1.0 + _ROUNDING):
        return vx, vy
    return vx * (speed_limit / speed), vy * (speed_limit / speed)


@kernel
def half_chord(offset: float, speed_limit: float) -> float:
    """Half the length of the line a.v = offset inside the disc [m/s]; 0 where it only touches."""
    return math.sqrt(max(speed_limit * speed_limit - offset * offset, 0.0))
