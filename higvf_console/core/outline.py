"""Closed outlines in the plane."""

import numpy as np

from higvf_console.core.arrays import Bools, Floats


def enclosed(outline: Floats, points: Floats) -> Bools:
    """Which of points (N, 2) lie inside a closed outline (n, 2), by the even-odd rule [m]."""
    (ax, ay), (bx, by) = outline.T, np.roll(outline, -1, axis=0).T
    x, y = points[:, :1], points[:, 1:]
    rise = np.where(ay == by, 1.0, by - ay)  # a level edge is crossed by none
    crossed = ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / rise)
    return np.asarray(crossed.sum(axis=1) % 2 == 1, np.bool_)
