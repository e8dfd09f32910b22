"""The ladder out of a deadlock: the other side, then more of the human, then a word to the operator.

A robot is deadlocked when its barrier rows hold it against its nominal velocity for `stall_time`. Scaling that velocity
frees nobody: the filtered speed is zero exactly when the nominal velocity lies in the cone of the active normals, and
with it every multiple. So each rung changes a direction, is climbed when the stall lasts or comes again, and is
forgotten once the robot has left all rings:

    1  the component goes round on the other side
    2  the human intention weighs more, where that turns the influenced robot's shared intention
    3  the operator is asked for a new stroke; after that both sides are tried in turn
"""

import math

import numpy as np

from higvf_console.arrays import Bools, Floats, Ints
from higvf_console.control.forms import PRINTED
from higvf_console.control.gains import Gains, StallGains
from higvf_console.control.intention import shared_intention
from higvf_console.control.kernel import kernel
from higvf_console.state import NOBODY, Motion

OTHER_SIDE, MORE_HUMAN, ASK = 1, 2, 3
_TURNED = 0.985  # cosine of ten degrees: a smaller turn is none


@kernel
def climb(motion: Motion, component: Ints, gains: Gains) -> tuple[Ints, Bools]:
    """Rungs (N,) after this tick, and the robots (N,) for which the other side is to be tried now.

    A stalled robot climbs each time that its stall has lasted another `stall_time`; its component climbs with it.
    """
    rung, flip = motion.rung.copy(), np.zeros(motion.rung.shape[0], np.bool_)
    if gains.forms.human == PRINTED:
        return rung, flip
    for i in range(rung.shape[0]):
        if climbs(float(motion.stalled[i]), gains.stall, gains.safety.control_period):
            highest = 0
            for j in range(rung.shape[0]):
                if component[j] == component[i]:
                    highest = max(highest, motion.rung[j])
            rung[i] = highest + 1
            flip[i] = rung[i] == OTHER_SIDE or (rung[i] > ASK and rung[i] % 2 == 0)
    return rung, flip


@kernel
def climbs(stalled: float, gains: StallGains, period: float) -> bool:
    """Whether a stall [s] has just lasted a whole number of `stall_time`."""
    return stalled >= gains.stall_time and stalled % gains.stall_time < period


@kernel
def receptivity(
    leader: int, rung: Ints, robot: Floats, human: Floats, intention: Floats, start: Ints, to: Ints, gains: Gains
) -> float:
    """Psi of the influenced robot: 1, or `human_boost` on the second rung if that turns its shared intention.

    Args:
        leader: the influenced robot, or NOBODY.
        rung: (N,) from `climb`.
        robot: (N, 2) v_t.
        human: (N, 2) v_h.
        intention: (N, 2) v_s.
        start: (N + 1,) rows of `to`.
        to: neighbours.
        gains: weights and boost.
    """
    if leader == NOBODY or rung[leader] < MORE_HUMAN:
        return 1.0
    plain_x, plain_y = _fixed_point(leader, 1.0, robot, human, intention, start, to, gains)
    more_x, more_y = _fixed_point(leader, gains.stall.human_boost, robot, human, intention, start, to, gains)
    along = plain_x * more_x + plain_y * more_y
    turned = along < _TURNED * math.hypot(plain_x, plain_y) * math.hypot(more_x, more_y)
    return gains.stall.human_boost if turned else 1.0


@kernel
def _fixed_point(
    i: int, psi: float, robot: Floats, human: Floats, intention: Floats, start: Ints, to: Ints, gains: Gains
) -> tuple[float, float]:
    return shared_intention(
        i, intention[i, 0], intention[i, 1], robot[i, 0], robot[i, 1], human[i, 0], human[i, 1], psi, intention,
        start, to, gains.intention, gains.forms, math.inf,
    )  # fmt: skip


@kernel
def forgotten(rung: Ints, side: Ints, stalled: Floats) -> Ints:
    """Rungs (N,) without those of robots whose component is in no ring (`side` (N, K) is then 0) and not stalled."""
    kept = rung.copy()
    for i in range(kept.shape[0]):
        inside = stalled[i] > 0.0
        for k in range(side.shape[1]):
            inside = inside or side[i, k] != 0
        if not inside:
            kept[i] = 0
    return kept
