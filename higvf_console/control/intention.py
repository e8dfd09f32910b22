"""Shared intention, [15], [16]: each robot blends its own, its neighbours' and the human's intention."""

import math

from higvf_console.arrays import Floats, Ints
from higvf_console.control.gains import IntentionGains
from higvf_console.control.kernel import kernel


@kernel
def shared_intention(
    i: int, vx: float, vy: float, robot_x: float, robot_y: float, human_x: float, human_y: float, psi: float,
    intention: Floats, start: Ints, to: Ints, gains: IntentionGains, dt: float,
) -> tuple[float, float]:  # fmt: skip
    """v_s of robot i after dt [s]: the ODE of Appendix A, semi-implicit, so stable at every dt and degree.

    v <- (v + dt (w1 v_t + w2 sum g v_j + w3 psi v_h)) / (1 + dt (w0 + w1 + w2 sum g + w3 psi)), where the dead zone
    [16] gives g = max(0, n - epsilon) / n for n = |v_j - v|. An infinite dt gives the fixed point for the present g.

    Args:
        i: robot index.
        vx: v_s of the robot.
        vy: v_s of the robot.
        robot_x: robot intention v_t.
        robot_y: robot intention v_t.
        human_x: human intention v_h.
        human_y: human intention v_h.
        psi: 1 for the robot that receives the human intention, else 0.
        intention: (N, 2) v_s of all robots.
        start: (N + 1,) rows of `to`.
        to: neighbours.
        gains: weights.
        dt: control period [s].
    """
    pull_x = gains.robot_weight * robot_x + gains.human_weight * psi * human_x
    pull_y = gains.robot_weight * robot_y + gains.human_weight * psi * human_y
    weight = gains.decay + gains.robot_weight + gains.human_weight * psi
    for entry in range(start[i], start[i + 1]):
        j = to[entry]
        gap = math.hypot(intention[j, 0] - vx, intention[j, 1] - vy)
        if gap > gains.dead_zone:
            share = gains.neighbour_weight * (gap - gains.dead_zone) / gap
            pull_x += share * intention[j, 0]
            pull_y += share * intention[j, 1]
            weight += share
    if dt == math.inf:
        return pull_x / weight, pull_y / weight
    return (vx + dt * pull_x) / (1.0 + dt * weight), (vy + dt * pull_y) / (1.0 + dt * weight)
