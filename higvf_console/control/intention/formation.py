"""Distance-based formation control, [12], [14]: robots attract each other when too far apart, else repel."""

import math

from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import FormationParameters
from higvf_console.core.arrays import Floats, Ints


@kernel
def formation_velocity(
    i: int, x: float, y: float, position: Floats, shape: Floats, start: Ints, to: Ints, params: FormationParameters,
    forms: Forms,
) -> tuple[float, float]:  # fmt: skip
    """Formation velocity v_f of robot i at (x, y) [m/s]: sum of -k_form (|r| - d) r/|r| over its links, capped.

    As printed, with | |r| - d | for |r| - d, robots that are too near attract each other too.

    Args:
        i: index of the robot.
        x: position of the robot [m].
        y: position of the robot [m].
        position: (N, 2) positions of all robots [m]; robots at the same point separate along x.
        shape: (N, 2) desired formation [m], which gives the desired length d of each link.
        start: (N + 1,) neighbour lists: those of robot i are `to[start[i]:start[i + 1]]`.
        to: (E,) neighbours.
        params: gain and speed cap.
        forms: corrected or printed form.
    """
    vx, vy = 0.0, 0.0
    for entry in range(start[i], start[i + 1]):
        j = to[entry]
        rx, ry = x - position[j, 0], y - position[j, 1]
        distance = math.hypot(rx, ry)
        wanted = math.hypot(shape[i, 0] - shape[j, 0], shape[i, 1] - shape[j, 1])
        pull = params.formation_rate * (wanted - distance)
        if forms.formation == PRINTED:
            pull = -abs(pull)
        if distance == 0.0:
            vx += pull if i > j else -pull
        else:
            vx += pull * rx / distance
            vy += pull * ry / distance
    speed = math.hypot(vx, vy)
    if speed > params.formation_speed:
        vx, vy = vx * params.formation_speed / speed, vy * params.formation_speed / speed
    return vx, vy
