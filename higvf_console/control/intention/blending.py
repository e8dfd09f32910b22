"""Speed [17] and policy blending [18], [19] of shared intention and formation."""

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
    """Blended velocity [18] of shared intention (sx, sy) and formation velocity (fx, fy) [m/s], and its lambda.

    The robot moves along the shared intention at cruise speed, slower below the floor: C v / max(|v|, delta), [17]. As
    printed, without the floor, the speed is 0/0 at rest.
    """
    a, b = math.hypot(sx, sy), math.hypot(fx, fy)
    weight = blending_weight(a, b, params, forms)
    floor = 0.0 if forms.speed == PRINTED else params.intention_floor
    drive = weight * params.cruise_speed / max(a, floor)
    return drive * sx + (1.0 - weight) * fx, drive * sy + (1.0 - weight) * fy, weight
