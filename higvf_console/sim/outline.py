"""Closed outlines in the plane."""

import numpy as np

from higvf_console.arrays import Bools, Floats


def enclosed(outline: Floats, points: Floats) -> Bools:
    """Which of points (N, 2) lie inside a closed outline (n, 2), by the even-odd rule [m]."""
    x, y = points.T
    inside = np.zeros(len(points), np.bool_)
    for (ax, ay), (bx, by) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
    return inside
