"""What the operator looked at, and how busily: the target of each fixation, and a simple estimate of workload.

Workload follows the literature's simplest signs: under load fixations become longer or fewer, and gaze goes round
between areas less predictably. Krejtz et al., "Gaze transition entropy", ACM Trans. Appl. Percept. 13(1), 2015. They
compare one operator's runs with one another; there is no scale across people.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from higvf_console.arrays import Floats, Ints, floats, ints

ELSEWHERE = -1


class Workload(NamedTuple):
    """Signs of how busy the operator is.

    Attributes:
        fixation_rate: fixations a second [1/s].
        fixation_duration: their mean duration [s]; NaN without any.
        transition_entropy: of the next area given this one; 0 = always the same way, 1 = at random; NaN with fewer than
            two transitions.
    """

    fixation_rate: float
    fixation_duration: float
    transition_entropy: float


def looked_at(points: Floats, targets: Floats, reach: Floats) -> Ints:
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


def workload(lengths: Floats, areas: Sequence[int] | Ints, seen: float) -> Workload:
    """Estimates workload.

    Args:
        lengths: (k,) of the fixations, in order of time [s].
        areas: (k,) the area that each fixation lies in, by number, e.g. of `looked_at`.
        seen: for how long gaze was seen [s].
    """
    rate = len(lengths) / seen if seen > 0 else 0.0
    return Workload(rate, float(np.mean(lengths)) if len(lengths) else np.nan, transition_entropy(areas))


def transition_entropy(areas: Sequence[int] | Ints) -> float:
    """Entropy of the next area given this one, in [0, 1]; NaN with fewer than two transitions.

    H = -sum_i p(i) sum_j p(j | i) log2 p(j | i), weighted by how often gaze left each of the n areas that were looked
    at, over what chance among them would give, log2(n). Two fixations in a row on one area count as a transition too.
    """
    _, named = np.unique(ints(areas), return_inverse=True)
    if len(named) < 3:
        return float("nan")
    size = int(named.max()) + 1
    if size == 1:
        return 0.0
    counted = floats(np.bincount(named[:-1] * size + named[1:], minlength=size * size), size, size)
    left = counted.sum(axis=1, keepdims=True)
    chance = counted / np.where(left > 0, left, 1.0)
    surprise = chance * np.log2(np.where(chance > 0, chance, 1.0))
    return float(-(left[:, 0] / left.sum()) @ surprise.sum(axis=1)) / math.log2(size)
