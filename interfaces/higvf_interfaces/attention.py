"""What the operator looked at, and how busily: shares of attention, and a simple estimate of workload.

Workload follows the literature's simplest signs: under load fixations become longer or fewer, and gaze goes round
between areas less predictably. Krejtz et al., "Gaze transition entropy", ACM Trans. Appl. Percept. 13(1), 2015. They
compare one operator's runs with one another; there is no scale across people.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from higvf_console.arrays import Floats, Ints, floats, ints
from higvf_interfaces.fixations import Classified, centroid

ELSEWHERE = -1


class Looks(NamedTuple):
    """Fixations: `start` (k,) and `end` (k,) [s], and their centroids `points` (k, 2) [px, or m once mapped]."""

    start: Floats
    end: Floats
    points: Floats


class Workload(NamedTuple):
    """Signs of how busy the operator is.

    Attributes:
        fixation_rate: fixations a second [1/s].
        fixation_duration: their mean duration [s]; NaN without any.
        transition_entropy: of the next area given this one [bit]; 0 = always the same way, log2(areas) = at random;
            NaN with fewer than two transitions.
    """

    fixation_rate: float
    fixation_duration: float
    transition_entropy: float


def looks(gaze: Classified) -> Looks:
    """The fixations of classified gaze, in pixels."""
    pairs = zip(gaze.first.tolist(), gaze.last.tolist(), strict=True)
    points = floats([centroid(gaze, first, last) for first, last in pairs], -1, 2)
    return Looks(floats(gaze.time[gaze.first]), floats(gaze.time[gaze.last]), points)


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


def attention(fixations: Looks, targets: Floats, reach: Floats) -> Floats:
    """Shares (t + 1,) of the time of all fixations on each of t targets, and elsewhere (the last); they add up to 1.

    Args:
        fixations: on the ground [m].
        targets: as `looked_at` takes them: fires or robots.
        reach: likewise.

    Returns:
        Zeros where there is no fixation.
    """
    at = looked_at(fixations.points, targets, reach)
    count = targets.shape[-2]
    spent = np.bincount(
        np.where(at == ELSEWHERE, count, at), weights=fixations.end - fixations.start, minlength=count + 1
    )
    return floats(spent / spent.sum()) if spent.sum() > 0 else np.zeros(count + 1)


def workload(fixations: Looks, areas: Sequence[int] | Ints, duration: float) -> Workload:
    """Estimates workload.

    Args:
        fixations: in order of time.
        areas: (k,) the area that each fixation lies in, by number, e.g. of `looked_at`.
        duration: of the time that is looked at [s].
    """
    lengths = fixations.end - fixations.start
    rate = len(lengths) / duration if duration > 0 else 0.0
    return Workload(rate, float(np.mean(lengths)) if len(lengths) else np.nan, transition_entropy(areas))


def transition_entropy(areas: Sequence[int] | Ints) -> float:
    """Entropy of the next area given this one, weighted by how often gaze left each [bit]; NaN below 2 transitions.

    H = -sum_i p(i) sum_j p(j | i) log2 p(j | i)
    """
    _, named = np.unique(ints(areas), return_inverse=True)
    if len(named) < 3:
        return float("nan")
    size = int(named.max()) + 1
    counted = floats(np.bincount(named[:-1] * size + named[1:], minlength=size * size), size, size)
    left = counted.sum(axis=1, keepdims=True)
    chance = counted / np.where(left > 0, left, 1.0)
    surprise = chance * np.log2(np.where(chance > 0, chance, 1.0))
    return float(-(left[:, 0] / left.sum()) @ surprise.sum(axis=1))
