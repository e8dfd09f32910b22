"""Gaze path: fit a spline to the fixation centroids.

A spline through raw samples has a radius of curvature near zero, so the path is fitted to fixation centroids: a cubic
smoothing spline (Dierckx; `scipy.interpolate.make_splprep`) whose distance to them is half a degree on average. Large
weights pin its ends to the first and last centroid. This fit serves the inspection only; the console fits its own path
to the same centroids.
"""
# SciPy's splines have no types.
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import make_splprep

from higvf_console.core.arrays import Floats, floats

FEWEST = 4  # minimum number of distinct points of a cubic
_SAME = 1e-6  # closer points count as one [m]
_PINNED = 1e3  # weight of the end points; the others have weight 1
_SAMPLES = 400


class GazePath(NamedTuple):
    """A spline fitted to fixation centroids.

    Attributes:
        distinct: (m, 2) centroids without consecutive duplicates [m].
        curve: (n, 2) points along the spline [m]; empty if there are too few centroids.
        length: length of the curve [m].
        smallest_radius: smallest radius of curvature [m]; inf for a straight line, NaN without a curve.
    """

    distinct: Floats
    curve: Floats
    length: float
    smallest_radius: float


def gaze_path(centroids: Floats, smoothing: float) -> GazePath:
    """Fit the path to fixation centroids.

    Args:
        centroids: (k, 2) centroids on the ground in order of time [m]; NaN beyond the horizon is ignored.
        smoothing: standard deviation of the centroids from the curve [m].
    """
    known = centroids[np.isfinite(centroids).all(axis=1)]
    steps = np.hypot(*np.diff(known, axis=0).T) if len(known) > 1 else np.zeros(0)
    distinct = known[np.concatenate([[True], steps > _SAME])] if len(known) else known
    if len(distinct) < FEWEST:
        return GazePath(distinct, floats([], 0, 2), 0.0, np.nan)
    weights = np.ones(len(distinct))
    weights[[0, -1]] = _PINNED
    left: Any = len(distinct) * smoothing**2  # declared as an integer by the package
    spline, _ = make_splprep(list(distinct.T), w=weights, k=3, s=left)
    at = np.linspace(0.0, 1.0, _SAMPLES)
    curve = floats(np.asarray(spline(at)).T)
    (dx, dy), (ddx, ddy) = np.asarray(spline(at, nu=1)), np.asarray(spline(at, nu=2))
    turning = np.abs(dx * ddy - dy * ddx)
    speed = np.hypot(dx, dy)
    sharpest = float(np.max(turning / np.maximum(speed, 1e-12) ** 3))
    length = float(np.hypot(*np.diff(curve, axis=0).T).sum())
    return GazePath(distinct, curve, length, 1 / sharpest if sharpest > 0 else np.inf)
