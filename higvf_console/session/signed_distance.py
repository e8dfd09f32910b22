"""A smoothed signed distance on a grid, with its gradient: what a field follows inside a shape that is not convex.

The samples are exact; between them a uniform cubic B-spline blends the sixteen nearest (Unser, "Splines: a perfect fit
for signal and image processing", 1999). It is not an interpolation but a smoothing by half a cell: the ridges where
the nearest edge changes become round, so that the gradient is continuous everywhere, and so is its derivative.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from higvf_console.arrays import Floats, floats
from higvf_console.session.polygons import signed_distance

_LEAST_NODES = 4  # along each axis: what one B-spline blends


class SignedDistance(NamedTuple):
    """Samples of a signed distance, negative inside an obstacle.

    Attributes:
        origin: (2,) ground point of `values[0, 0]` [m].
        cell: distance between samples [m].
        values: (ny, nx) [m], y along the first axis.
    """

    origin: Floats
    cell: float
    values: Floats


def sampled_distance(chains: Sequence[Floats], cell: float, margin: float) -> SignedDistance:
    """Samples the signed distance of one obstacle.

    Args:
        chains: as in `polygons.signed_distance`.
        cell: distance between samples [m]; the smoothed distance is within 0.82 of it.
        margin: how far round the obstacle the grid reaches at least [m].
    """
    points = np.concatenate(chains)
    low = points.min(axis=0) - margin - cell  # one cell more: a B-spline reaches beyond the point that it is asked for
    spans = points.max(axis=0) + margin + cell - low
    nx, ny = (max(_LEAST_NODES, int(np.ceil(span / cell)) + 1) for span in spans)
    x, y = np.meshgrid(low[0] + cell * np.arange(nx), low[1] + cell * np.arange(ny))
    values = signed_distance(chains, np.stack([x.ravel(), y.ravel()], axis=1))
    return SignedDistance(floats(low), cell, floats(values, ny, nx))


def smoothed_distance(grid: SignedDistance, points: Floats) -> tuple[Floats, Floats]:
    """The smoothed signed distance (N,) [m] and its gradient (N, 2) at points (N, 2) [m].

    Beyond the grid it is that of the nearest point of the grid, and does not change outward.
    """
    ny, nx = grid.values.shape
    place = (points - grid.origin) / grid.cell
    last = np.array([nx - 2, ny - 2])
    held = np.clip(place, 1, last)
    first = np.minimum(held.astype(np.int64), last - 1) - 1
    weights, slopes = _basis(held - first - 1)
    slopes *= (held == place)[None] / grid.cell
    rows, columns = (first[:, axis, None] + np.arange(4) for axis in (1, 0))
    patch = grid.values[rows[:, :, None], columns[:, None, :]]
    (wx, wy), (sx, sy) = weights.transpose(2, 1, 0), slopes.transpose(2, 1, 0)
    value, *gradient = (np.einsum("nyx,ny,nx->n", patch, by, bx) for by, bx in ((wy, wx), (wy, sx), (sy, wx)))
    return value, np.stack(gradient, axis=1)


def _basis(t: Floats) -> tuple[Floats, Floats]:
    """The four cubic B-splines that are not zero at share t (N, 2) of a cell, and their slopes, each (4, N, 2)."""
    s = 1.0 - t
    weights = np.stack([s**3, 3 * t**3 - 6 * t**2 + 4, 3 * s**3 - 6 * s**2 + 4, t**3]) / 6
    slopes = np.stack([-(s**2), 3 * t**2 - 4 * t, 4 * s - 3 * s**2, t**2]) / 2
    return weights, slopes
