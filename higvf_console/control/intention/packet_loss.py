"""Packet loss between robots, drawn by a stateless counter-based random generator.

The finaliser of SplitMix64 (Steele et al. 2014) hashes the seed, the tick, the purpose and the robots concerned. Live
runs, rollouts, replays and previews therefore lose the same messages.
"""

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import RobotParameters
from higvf_console.core.arrays import Ints

MEASURING, SENDING = 1, 2  # purposes of a draw

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_SHIFT_1, _SHIFT_2, _SHIFT_3, _EXCESS = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)


@kernel
def chance(seed: float, tick: int, purpose: int, i: int, j: int) -> float:
    """A pseudo-random number in [0, 1), determined by the arguments, which are integers from 0."""
    z = _mixed(np.uint64(seed))
    for word in (tick, purpose, i, j):
        z = _mixed(z ^ np.uint64(word))
    return float(z >> _EXCESS) * 2.0**-53


@kernel
def _mixed(z: np.uint64) -> np.uint64:
    z = z + _STEP
    z = (z ^ (z >> _SHIFT_1)) * _FIRST
    z = (z ^ (z >> _SHIFT_2)) * _SECOND
    return z ^ (z >> _SHIFT_3)


@kernel
def delivered(start: Ints, to: Ints, tick: int, robots: RobotParameters) -> tuple[Ints, Ints]:
    """The neighbour lists of the links that deliver in this tick; each link fails with probability `packet_loss`."""
    if robots.packet_loss == 0.0:
        return start, to
    delivered_start, delivered_to = np.zeros(start.shape[0], np.int64), np.empty(to.shape[0], np.int64)
    used = 0
    for i in range(start.shape[0] - 1):
        for entry in range(start[i], start[i + 1]):
            j = to[entry]
            if chance(robots.seed, tick, SENDING, min(i, j), max(i, j)) >= robots.packet_loss:
                delivered_to[used] = j
                used += 1
        delivered_start[i + 1] = used
    return delivered_start, delivered_to[:used].copy()
