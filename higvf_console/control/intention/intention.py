"""Shared intention, [15], [16]: a consensus of robot intentions, neighbours' intentions and human intention."""

import math

import numpy as np

from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import IntentionParameters
from higvf_console.core.arrays import Floats, Ints


@kernel
def shared_intention(
    i: int, vx: float, vy: float, robot_x: float, robot_y: float, human_x: float, human_y: float, psi: float,
    intention: Floats, start: Ints, to: Ints, params: IntentionParameters, forms: Forms, dt: float,
) -> tuple[float, float]:  # fmt: skip
    """v_s of robot i after dt [s]: the ODE of Appendix A, semi-implicit, so stable at every dt and degree.

    v <- (v + dt (w1 v_t + w2 sum g v_j + w3 psi v_h)) / (1 + dt (w0 + w1 + w2 sum g + w3 psi)), where the dead zone
    [16] gives g = max(0, n - epsilon) / n for n = |v_j - v|. An infinite dt gives the fixed point for the present g.
    The printed form is a discrete map, v <- w1 v_t + w2 sum g v_j + w3 psi v_h - (w0 + w1 + w2 sum g + w3 psi) v, whose
    weights are not rates: it alternates in sign and converges only with a spectral radius below 1 (see `map_radius`).

    Args:
        i: robot index.
        vx: v_s of the robot.
        vy: v_s of the robot.
        robot_x: robot intention v_t.
        robot_y: robot intention v_t.
        human_x: human intention v_h.
        human_y: human intention v_h.
        psi: receptivity to the human intention: 0, 1 for the influenced robot, more in deadlock recovery.
        intention: (N, 2) v_s of all robots.
        start: (N + 1,) neighbour lists: those of robot i are `to[start[i]:start[i + 1]]`.
        to: (E,) neighbours.
        params: weights and dead zone.
        forms: corrected or printed form.
        dt: control period [s].
    """
    pull_x = params.robot_weight * robot_x + params.human_weight * psi * human_x
    pull_y = params.robot_weight * robot_y + params.human_weight * psi * human_y
    weight = params.decay + params.robot_weight + params.human_weight * psi
    for entry in range(start[i], start[i + 1]):
        j = to[entry]
        gap = math.hypot(intention[j, 0] - vx, intention[j, 1] - vy)
        if gap > params.dead_zone:
            share = params.neighbour_weight * (gap - params.dead_zone) / gap
            pull_x += share * intention[j, 0]
            pull_y += share * intention[j, 1]
            weight += share
    if dt == math.inf:
        return pull_x / weight, pull_y / weight
    if forms.intention == PRINTED:
        return pull_x - weight * vx, pull_y - weight * vy
    return (vx + dt * pull_x) / (1.0 + dt * weight), (vy + dt * pull_y) / (1.0 + dt * weight)


def map_radius(laplacian: Floats, influenced: int, params: IntentionParameters) -> float:
    """Spectral radius of the printed map [15], (w0 + w1) I + w2 L + w3 Psi; the map converges below 1.

    Args:
        laplacian: (N, N) graph Laplacian L of the communication links.
        influenced: the influenced robot, psi = 1.
        params: weights omega_0..3.
    """
    matrix = (params.decay + params.robot_weight) * np.eye(len(laplacian)) + params.neighbour_weight * laplacian
    matrix[influenced, influenced] += params.human_weight
    return float(np.abs(np.linalg.eigvalsh(matrix)).max())
