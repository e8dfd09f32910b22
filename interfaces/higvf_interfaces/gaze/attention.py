"""Attention measures: assignment of fixations to targets, and gaze transition entropy.

Under workload, fixations become longer or fewer, and transitions between areas become less predictable (Krejtz et al.,
"Gaze transition entropy", ACM Trans. Appl. Percept. 13(1), 2015). The measures compare runs of one operator; they are
not comparable between people.
"""

import math
from collections import Counter

import numpy as np

from higvf_console.core.arrays import Floats, Ints, ints

ELSEWHERE = -1


def fixated_targets(points: Floats, targets: Floats, reach: Floats) -> Ints:
    """Assign each fixation to the target with the nearest border, if the fixation lies inside that border.

    Args:
        points: (k, 2) fixation centroids [m].
        targets: (k, t, 2) positions of the targets during each fixation [m], or (t, 2) if they do not move.
        reach: (t,) or (k, t) radius of each target plus the gaze error [m].

        Returns:
            Index of the target of each fixation (k,), or `ELSEWHERE`.
    """
    if not len(points) or not targets.shape[-2]:
        return ints(np.full(len(points), ELSEWHERE))
    offset = points[:, None, :] - np.broadcast_to(targets, (len(points), *targets.shape[-2:]))
    beyond = np.hypot(offset[..., 0], offset[..., 1]) - reach
    beyond[~np.isfinite(beyond)] = np.inf
    nearest = np.argmin(beyond, axis=1)
    return ints(np.where(beyond[np.arange(len(points)), nearest] <= 0, nearest, ELSEWHERE))


class Transitions:
    """Gaze transitions between areas, counted incrementally: the cost of a transition is constant."""

    def __init__(self) -> None:
        """Start without transitions."""
        self._steps: Counter[tuple[int, int]] = Counter()
        self._left: Counter[int] = Counter()
        self._areas: set[int] = set()
        self._at: int | None = None
        self._count = 0
        self._surprise = 0.0  # sum of n log2 n over the areas left, minus the sum over the transitions

    def add(self, area: int) -> None:
        """Count a transition to `area`, an area number; a transition to the same area counts too."""
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
        """Normalised transition entropy in [0, 1]; NaN with fewer than two transitions, 0 with one area.

        H = -sum_i p(i) sum_j p(j | i) log2 p(j | i), divided by log2(n), the entropy of random transitions between
        the n areas seen; p(i) is the share of the transitions that leave area i.
        """
        if self._count < 2:
            return math.nan
        if len(self._areas) < 2:
            return 0.0
        return max(0.0, self._surprise) / self._count / math.log2(len(self._areas))


def _growth(count: int) -> float:
    """Return the increase of n log2 n from n = `count` to n = `count` + 1."""
    before = count * math.log2(count) if count else 0.0
    return (count + 1) * math.log2(count + 1) - before
