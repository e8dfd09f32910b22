"""Fixations -> a path: the steps by which the eyes' rests become a curve, each to be seen.

Raw samples make no path (the radius of a spline through them goes to zero); the centroids of fixations do. A cubic
smoothing spline (Dierckx; `scipy.interpolate.make_splprep`) leaves them by half a degree on average; its ends are
pinned to the first and the last centroid, which it would miss by far otherwise. The console fits its own path from the
same centroids; this is the preview.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import make_splprep

from higvf_console.core.arrays import Floats, floats

FEWEST = 4  # distinct points of a cubic
_SAME = 1e-6  # points nearer to one another are one [m]
_PINNED = 1e3  # weight of the ends over the others
_SAMPLES = 400


class GazePath(NamedTuple):
    """A curve through centroids.

    Attributes:
        distinct: (m, 2) centroids without those that repeat the one before [m].
        curve: (n, 2) points along the path [m]; empty where there are too few centroids.
        length: of the curve [m].
        smallest_radius: of curvature [m]; inf for a straight line, NaN without a curve.
    """

    distinct: Floats
    curve: Floats
    length: float
    smallest_radius: float


def gaze_path(centroids: Floats, smoothing: float) -> GazePath:
    """The path through fixation centroids.

    Args:
        centroids: (k, 2) on the ground, in order of time [m]; NaN beyond the arena's horizon.
        smoothing: standard deviation by which the curve may leave them [m].
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
