"""Heat map of gaze: counts on a coarse grid over the arena, blurred, in the turbo colour map."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.optional import optional
from higvf_console.core.viewport import Arena

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "devices")

_COARSE = 4  # pixels of the picture in one cell of the grid
_FAINT = 0.02  # share of the peak below which the picture is transparent


def heat_map(points: Floats, arena: Arena, width_px: int, sigma: float) -> NDArray[np.uint8]:
    """Draw a heat map of gaze over the arena.

    Args:
        points: (n, 2) gaze samples on the ground [m]; NaN and points outside the arena are ignored.
        arena: ground that the picture covers.
        width_px: width of the picture [px]; the height follows from the arena.
        sigma: standard deviation of the blur [m], about one degree of visual angle.

    Returns:
        Picture (height, width, 4) of red, green, blue, opacity; row 0 is the top.
    """
    return paint(counts(points, arena, width_px), arena, width_px, sigma)


def counts(points: Floats, arena: Arena, width_px: int, weights: Floats | None = None) -> Floats:
    """Count samples per grid cell, shape (rows, columns), at a quarter of the picture's resolution.

    Row 0 is the top. `weights` (n,) are the weights of the samples, by default 1. The counts of the parts of a
    recording sum to the counts of the whole.
    """
    columns, rows = (max(1, side // _COARSE) for side in _size(arena, width_px))
    share = (points - np.array([arena.x_min, arena.y_max])) / np.array([arena.width, -arena.height])
    inside = ((share >= 0) & (share <= 1)).all(axis=1)  # NaN is not
    column, row = (np.minimum(share[inside] * [columns, rows], [columns - 1, rows - 1])).astype(np.int64).T
    each = None if weights is None else weights[inside]
    return floats(np.bincount(row * columns + column, each, minlength=rows * columns), rows, columns)


def paint(grid: Floats, arena: Arena, width_px: int, sigma: float) -> NDArray[np.uint8]:
    """Draw the picture (height, width, 4) of a grid of counts; see `heat_map`."""
    blurred = cv2.GaussianBlur(grid, (0, 0), max(0.5, sigma / arena.width * grid.shape[1]))
    share = floats(blurred) / max(float(np.max(blurred)), 1e-12)
    fine = cv2.resize(share, _size(arena, width_px), interpolation=cv2.INTER_LINEAR)
    share = np.clip(floats(fine), 0.0, 1.0)
    colours = cv2.applyColorMap(np.round(255 * share).astype(np.uint8), cv2.COLORMAP_TURBO)
    opacity = np.where(share > _FAINT, np.round(255 * np.sqrt(share)), 0.0)
    return np.dstack([colours[:, :, ::-1], opacity]).astype(np.uint8)


def _size(arena: Arena, width_px: int) -> tuple[int, int]:
    """Return width and height of the picture [px]."""
    return width_px, max(1, round(width_px * arena.height / arena.width))
