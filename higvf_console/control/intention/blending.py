"""Speed [17] and policy blending [18], [19]: the shared intention against the formation."""

import math

from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import BlendingParameters


@kernel
def blending_weight(a: float, b: float, params: BlendingParameters, forms: Forms) -> float:
    """Lambda, [19] made continuous at (0, 0): k_s a / (k_s a + k_f b + delta), a = |v_s|, b = |v_f|.

    As printed, delta is 0.
    """
    pull = params.intention_gain * a
    floor = 0.0 if forms.blending == PRINTED else params.intention_floor
    return pull / (pull + params.formation_gain * b + floor)


@kernel
def blended_velocity(
    sx: float, sy: float, fx: float, fy: float, params: BlendingParameters, forms: Forms
) -> tuple[float, float, float]:
    """Velocity [18] and its lambda, of the shared intention (sx, sy) and the formation velocity (fx, fy) [m/s].

    The shared intention's direction is driven at cruise speed, slower below the floor: C v / max(|v|, delta), [17];
    as printed, without the floor, it is 0/0 at rest.
    """
    a, b = math.hypot(sx, sy), math.hypot(fx, fy)
    weight = blending_weight(a, b, params, forms)
    floor = 0.0 if forms.speed == PRINTED else params.intention_floor
    drive = weight * params.cruise_speed / max(a, floor)
    return drive * sx + (1.0 - weight) * fx, drive * sy + (1.0 - weight) * fy, weight
