"""Fixation detection by velocity (I-VT) or by dispersion (I-DT), as in eye-tracking software.

    fill short gaps -> cut around blinks -> angular speed -> threshold -> runs -> merge close runs -> drop short runs
                                        \\-> runs of small dispersion -------------/

Salvucci and Goldberg, "Identifying fixations and saccades in eye-tracking protocols", ETRA 2000; Olsen, "The Tobii I-VT
fixation filter", 2012. Points are in screen pixels; `px_per_deg` converts them to degrees of visual angle (about 38 on
a 24-inch screen of 1920 pixels at 60 cm). All functions are pure and take a whole recording.
"""

from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, Ints, bools, floats, ints
from higvf_interfaces.gaze.dispersion import covered, still_stretches

PX_PER_DEG = 38.0
IVT, IDT = "ivt", "idt"
METHODS = (IVT, IDT)


class Thresholds(NamedTuple):
    """Parameters of fixation detection."""

    longest_filled: float = 0.075  # longest gap that is interpolated [s]
    blink_margin: float = 0.05  # cut on both sides of a longer gap: the eyelid distorts gaze there [s]
    window: float = 0.033  # window over which speed is measured [s]
    speed: float = 30.0  # minimum speed of a saccade [deg/s]
    merge_time: float = 0.075  # fixations closer in time ... [s]
    merge_angle: float = 0.5  # ... and in angle are merged [deg]
    shortest: float = 0.06  # shorter fixations are dropped [s]
    dispersion: float = 1.0  # I-DT: largest width plus height of a fixation [deg]
    shortest_by_dispersion: float = 0.1  # I-DT: shortest fixation [s]


THRESHOLDS = Thresholds()


class Classified(NamedTuple):
    """A classified recording of n samples and m fixations.

    Attributes:
        time: (n,) [s].
        points: (n, 2) gaze with short gaps filled [px]; NaN where missing.
        seen: (n,) whether gaze is known, filled gaps included.
        steady: (n,) `seen` without the samples next to a blink.
        fixating: (n,) whether the sample meets the criterion of speed (I-VT) or dispersion (I-DT).
        first: (m,) index of the first sample of each fixation.
        last: (m,) index of the last sample of each fixation.
    """

    time: Floats
    points: Floats
    seen: Bools
    steady: Bools
    fixating: Bools
    first: Ints
    last: Ints


class Fixation(NamedTuple):
    """A fixation: its `start` and `end` [s] and its centroid `point` (2,) [px, or m after mapping to the ground]."""

    start: float
    end: float
    point: Floats


def classify(
    time: Floats,
    points: Floats,
    valid: Bools,
    px_per_deg: float = PX_PER_DEG,
    limits: Thresholds = THRESHOLDS,
    method: str = IVT,
    begin: int = 0,
) -> Classified:
    """Find the fixations of a recording.

    Args:
        time: (n,) strictly increasing [s].
        points: (n, 2) [px].
        valid: (n,) whether the sample is valid.
        px_per_deg: pixels per degree of visual angle.
        limits: parameters of the detection.
        method: one of `METHODS`.
        begin: first sample that a fixation may contain; earlier samples are only context for the filters.
    """
    filled, seen = fill_gaps(time, points, valid, limits.longest_filled)
    steady = cut_blinks(time, seen, limits.longest_filled, limits.blink_margin)
    free = steady & (np.arange(len(time)) >= begin)
    if method == IDT:
        within, shortest = limits.dispersion * px_per_deg, limits.shortest_by_dispersion
        first, last = still_stretches(time, filled, bools(free), within, shortest, limits.merge_time)
        fixating = covered(len(time), first, last)
    else:
        fixating = bools(free & (angular_speed(time, filled, steady, px_per_deg, limits.window) < limits.speed))
        first, last = runs(time, fixating, limits.merge_time)
    reach = limits.merge_angle * px_per_deg
    first, last = merge(time, filled, fixating, first, last, longest_gap=limits.merge_time, reach=reach)
    long_enough = time[last] - time[first] >= limits.shortest
    return Classified(time, filled, seen, steady, fixating, first[long_enough], last[long_enough])


def centroid(gaze: Classified, first: int, last: int) -> Floats:
    """Return the mean (2,) of the fixating samples from `first` to `last` inclusive [px]."""
    inside = slice(first, last + 1)
    return floats(gaze.points[inside][gaze.fixating[inside]].mean(axis=0))


def fixation(gaze: Classified, first: int, last: int) -> Fixation:
    """Return the fixation from sample `first` to `last` inclusive, in pixels."""
    return Fixation(float(gaze.time[first]), float(gaze.time[last]), centroid(gaze, first, last))


def fixations_of(gaze: Classified) -> list[Fixation]:
    """Return all fixations in order of time, in pixels."""
    return [fixation(gaze, *ends) for ends in zip(gaze.first.tolist(), gaze.last.tolist(), strict=True)]


def fill_gaps(time: Floats, points: Floats, valid: Bools, longest: float) -> tuple[Floats, Bools]:
    """Interpolate linearly across gaps of at most `longest` [s] between valid samples.

    Returns:
        The points (n, 2), NaN where unknown, and whether each point is known (n,).
    """
    known = np.flatnonzero(valid)
    if not len(known):
        return np.full_like(points, np.nan), valid
    following = np.minimum(np.searchsorted(known, np.arange(len(time))), len(known) - 1)
    after, before = known[following], known[np.maximum(following - 1, 0)]
    between = (before < np.arange(len(time))) & (after > np.arange(len(time)))
    seen = bools(valid | (between & (time[after] - time[before] <= longest)))
    filled = np.full_like(points, np.nan)
    for axis in range(2):
        filled[seen, axis] = np.interp(time[seen], time[known], points[known, axis])
    return filled, seen


def cut_blinks(time: Floats, seen: Bools, longest_filled: float, margin: float) -> Bools:
    """Return `seen` without the samples within `margin` [s] of a gap too long to fill.

    A gap is a run of unseen samples, or a gap in time longer than `longest_filled` [s].
    """
    lost = time[~seen]
    gap = np.flatnonzero(np.diff(time) > longest_filled)
    edges = np.sort(np.concatenate([lost, time[gap] + 1e-9, time[gap + 1] - 1e-9]))
    if not len(edges):
        return seen
    right = np.searchsorted(edges, time)
    distance = np.minimum(
        np.abs(edges[np.minimum(right, len(edges) - 1)] - time), np.abs(edges[np.maximum(right - 1, 0)] - time)
    )
    return bools(seen & (distance > margin))


def angular_speed(time: Floats, points: Floats, steady: Bools, px_per_deg: float, window: float) -> Floats:
    """Return the angular speed (n,) [deg/s] across a window around each sample; NaN where undefined.

    The window shrinks at the ends of a run of steady samples.
    """
    if len(time) < 2:
        return np.full(len(time), np.nan)
    index = np.arange(len(time))
    half = max(1, round(window / 2 / float(np.median(np.diff(time)))))
    lost_before = np.maximum.accumulate(np.where(steady, -1, index))
    lost_after = np.minimum.accumulate(np.where(steady, len(time), index)[::-1])[::-1]
    start = np.clip(np.maximum(index - half, lost_before + 1), 0, len(time) - 1)
    stop = np.clip(np.minimum(index + half, lost_after - 1), 0, len(time) - 1)
    duration = time[stop] - time[start]
    known = steady & (duration > 0)
    speed = np.full(len(time), np.nan)
    moved = points[stop[known]] - points[start[known]]
    speed[known] = np.hypot(moved[:, 0], moved[:, 1]) / px_per_deg / duration[known]
    return speed


def runs(time: Floats, fixating: Bools, longest_gap: float) -> tuple[Ints, Ints]:
    """Return the first and last sample of each run of fixating samples; a gap over `longest_gap` [s] ends a run."""
    padded = np.concatenate([[False], fixating, [False]])
    broken = np.concatenate([[False], np.diff(time) > longest_gap, [False]])
    starts = padded[1:] & (~padded[:-1] | broken)
    stops = padded[:-1] & (~padded[1:] | broken)
    return ints(np.flatnonzero(starts)), ints(np.flatnonzero(stops) - 1)


def merge(
    time: Floats, points: Floats, fixating: Bools, first: Ints, last: Ints, *, longest_gap: float, reach: float
) -> tuple[Ints, Ints]:
    """Merge neighbouring runs that are at most `longest_gap` [s] and `reach` [px] apart."""
    firsts: list[int] = []
    lasts: list[int] = []
    centres: list[Floats] = []
    for start, stop in zip(first.tolist(), last.tolist(), strict=True):
        centre = points[start : stop + 1].mean(axis=0)
        if firsts and time[start] - time[lasts[-1]] <= longest_gap and np.hypot(*(centre - centres[-1])) <= reach:
            lasts[-1] = stop
            inside = slice(firsts[-1], stop + 1)
            centres[-1] = points[inside][fixating[inside]].mean(axis=0)
        else:
            firsts.append(start)
            lasts.append(stop)
            centres.append(centre)
    return ints(firsts), ints(lasts)
