"""Synthetic gaze of a person who draws with the eyes: fixations along a path, saccades, and one blink per stroke.

Fixations last 250 to 400 ms; saccades take 21 ms + 2.2 ms/deg (Carpenter, "Movements of the Eyes", 1988) with a
minimum-jerk profile; the tracker adds white noise of 0.2 degrees RMS. Between strokes the gaze scans the arena. The
same seed gives the same samples.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, bools, floats
from higvf_console.core.viewport import Viewport
from higvf_interfaces.gaze.fixations import PX_PER_DEG

DWELL = (0.25, 0.40)  # [s]
NOISE = 0.2  # RMS [deg]
BLINK = 0.15  # [s]
MARGIN = 0.15  # gaze reaches the first point this long before a stroke and leaves the last this long after it [s]
_STEP = 0.37  # mean dwell plus its saccade [s]


class DrawnByEye(NamedTuple):
    """A stroke to draw by gaze: from `start` to `end` [s] along the polyline `points` (n, 2) [m]."""

    start: float
    end: float
    points: Floats


class Samples(NamedTuple):
    """Gaze samples: `time` (n,) [s], `points` (n, 2) [px, NaN in a blink], `valid` (n,)."""

    time: Floats
    points: Floats
    valid: Bools


class _Fixation(NamedTuple):
    start: float
    end: float
    target: Floats  # (2,) [px]


def synthetic_gaze(
    strokes: Sequence[DrawnByEye],
    duration: float,
    screen: Viewport,
    *,
    seed: int,
    rate: float = 120.0,
    px_per_deg: float = PX_PER_DEG,
) -> Samples:
    """Generate the gaze samples of one session.

    Args:
        strokes: strokes in order of time, at least 2 * `MARGIN` apart.
        duration: duration of the session [s].
        screen: position of the arena on the screen.
        seed: seed of scan targets, dwell times and noise.
        rate: sampling rate [Hz].
        px_per_deg: pixels per degree of visual angle.
    """
    rng = np.random.default_rng(seed)
    fixations: list[_Fixation] = []
    free_from = 0.0
    for stroke in strokes:
        start, end = max(free_from, stroke.start - MARGIN), min(duration, stroke.end + MARGIN)
        fixations += _scan(free_from, start, screen, rng, px_per_deg)
        count = max(3, round((end - start) / _STEP))
        targets = screen.to_screen(along(stroke.points, np.linspace(0.0, 1.0, count)))
        fixations += _dwell(start, end, targets, rng, px_per_deg)
        free_from = end
    fixations += _scan(free_from, duration, screen, rng, px_per_deg)
    time = np.arange(0.0, duration, 1 / rate)
    points = _positions(time, fixations) + rng.normal(0.0, NOISE * px_per_deg / np.sqrt(2), (len(time), 2))
    valid = np.ones(len(time), dtype=np.bool_)
    for stroke in strokes:
        valid &= np.abs(time - (stroke.start + stroke.end) / 2) > BLINK / 2
    points[~valid] = np.nan
    return Samples(time, points, bools(valid))


def along(points: Floats, shares: Floats) -> Floats:
    """Return the points (k, 2) at the fractions `shares` (k,) of the arc length of the polyline `points` (n, 2)."""
    reached = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    return np.stack([np.interp(shares * reached[-1], reached, points[:, axis]) for axis in range(2)], axis=1)  # pyright: ignore[reportUnknownArgumentType]


def _scan(start: float, end: float, screen: Viewport, rng: np.random.Generator, px_per_deg: float) -> list[_Fixation]:
    """Return fixations at random places in the middle of the screen."""
    count = round((end - start) / _STEP)
    targets = (0.2 + 0.6 * rng.random((count, 2))) * np.array([screen.width_px, screen.height_px])
    return _dwell(start, end, targets, rng, px_per_deg)


def _dwell(start: float, end: float, targets: Floats, rng: np.random.Generator, px_per_deg: float) -> list[_Fixation]:
    """Return one fixation per target (k, 2) [px], each followed by a saccade, that together fill [start, end]."""
    leaps = np.append(np.hypot(*np.diff(targets, axis=0).T), 0.0) / px_per_deg
    saccades = 0.021 + 0.0022 * leaps
    dwells = rng.uniform(*DWELL, len(targets))
    dwells *= max(0.0, end - start - saccades.sum()) / max(dwells.sum(), 1e-9)
    starts = start + np.cumsum(dwells + saccades) - (dwells + saccades)
    return [_Fixation(float(s), float(s + d), floats(t)) for s, d, t in zip(starts, dwells, targets, strict=True)]


def _positions(time: Floats, fixations: Sequence[_Fixation]) -> Floats:
    """Return gaze (n, 2) [px]: constant in a fixation, a minimum-jerk profile between two."""
    starts = np.array([fixation.start for fixation in fixations])
    ends = np.array([fixation.end for fixation in fixations])
    targets = np.array([fixation.target for fixation in fixations])
    now = np.clip(np.searchsorted(starts, time, side="right") - 1, 0, None)
    following = np.minimum(now + 1, len(fixations) - 1)
    share = np.clip((time - ends[now]) / np.maximum(starts[following] - ends[now], 1e-9), 0.0, 1.0)[:, None]
    smooth = share**3 * (10 - 15 * share + 6 * share**2)
    return targets[now] + (targets[following] - targets[now]) * smooth
