"""What the operator looked at, and how unforeseeably: the target of each fixation, the entropy of going between them.

Workload follows the literature's simplest signs: under load fixations become longer or fewer, and gaze goes round
between areas less predictably. Krejtz et al., "Gaze transition entropy", ACM Trans. Appl. Percept. 13(1), 2015. They
compare one operator's runs with one another; there is no scale across people.
"""

import math
from collections import Counter

import numpy as np

from higvf_console.core.arrays import Floats, Ints, ints

ELSEWHERE = -1


def fixated_targets(points: Floats, targets: Floats, reach: Floats) -> Ints:
    """The target of each fixation (k,): the one whose border is nearest, within it; else ELSEWHERE.

    Args:
        points: (k, 2) centroids [m].
        targets: (k, t, 2) where the targets were during each fixation [m], or (t, 2) where they never move.
        reach: (t,) or (k, t) how far from its centre a target is still looked at: its radius and what gaze is off [m].
    """
    if not len(points) or not targets.shape[-2]:
        return ints(np.full(len(points), ELSEWHERE))
    offset = points[:, None, :] - np.broadcast_to(targets, (len(points), *targets.shape[-2:]))
    beyond = np.hypot(offset[..., 0], offset[..., 1]) - reach
    beyond[~np.isfinite(beyond)] = np.inf
    nearest = np.argmin(beyond, axis=1)
    return ints(np.where(beyond[np.arange(len(points)), nearest] <= 0, nearest, ELSEWHERE))


class Transitions:
    """How gaze goes from area to area, counted as it goes: what each step costs does not grow with their number."""

    def __init__(self) -> None:
        """Starts before the first area."""
        self._steps: Counter[tuple[int, int]] = Counter()
        self._left: Counter[int] = Counter()
        self._areas: set[int] = set()
        self._at: int | None = None
        self._count = 0
        self._surprise = 0.0  # sum of n log2 n over the areas that were left, minus that over the steps

    def add(self, area: int) -> None:
        """Gaze is on an area, by number; on the same one again counts as a step too."""
        if self._at is not None:
            step = (self._at, area)
            self._surprise += _growth(self._left[self._at]) - _growth(self._steps[step])
            self._left[self._at] += 1
            self._steps[step] += 1
            self._count += 1
        self._areas.add(area)
        self._at = area

    @property
    def entropy(self) -> float:
        """Entropy of the next area given this one, in [0, 1]; NaN with fewer than two steps.

        H = -sum_i p(i) sum_j p(j | i) log2 p(j | i), weighted by how often gaze left each of the n areas that were
        looked at, over what chance among them would give, log2(n); 0 where there is one area.
        """
        if self._count < 2:
            return math.nan
        if len(self._areas) < 2:
            return 0.0
        return max(0.0, self._surprise) / self._count / math.log2(len(self._areas))


def _growth(count: int) -> float:
    """By how much n log2 n grows when n = `count` becomes one more."""
    before = count * math.log2(count) if count else 0.0
    return (count + 1) * math.log2(count + 1) - before
