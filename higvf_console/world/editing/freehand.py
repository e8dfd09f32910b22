"""The outline of an obstacle drawn freehand: closed, without its crossings, with few corners."""

from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.arrays import FARTHEST, Floats, floats
from higvf_console.core.errors import ScenarioError
from higvf_console.core.optional import optional
from higvf_console.world.masks import MaskPlace, trace
from higvf_console.world.polygons import signed_area

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

_PIXELS = 400  # of the drawing's longer side
_TOLERANCE = 1.5  # pixels by which the outline may leave the stroke
_MARGIN = 3  # pixels
_LEAST_SIDE = 1e-6  # of the rectangle round a stroke that encloses something [m]
_LINE, _OUTSIDE = 255, 128


def outline_of(stroke: Floats) -> Floats:
    """The outline (n, 2) [m] of what a stroke (m, 2) [m] encloses; of several parts, the largest.

    Raises:
        ScenarioError: it encloses nothing.
    """
    with np.errstate(over="ignore"):  # too large is refused below
        size = np.ptp(stroke, axis=0) if len(stroke) else np.zeros(2)
    if len(stroke) < 3 or not _LEAST_SIDE < size.min() <= size.max() <= 2.0 * FARTHEST:
        raise ScenarioError("the stroke encloses nothing: draw round the obstacle")
    scale, low = float(size.max()) / _PIXELS, stroke.min(axis=0)
    height, width = np.ceil(size[::-1] / scale).astype(int) + 2 * _MARGIN
    pixels = (stroke - low) / scale + _MARGIN
    mask = np.zeros((height, width), np.uint8)
    upright = np.stack([pixels[:, 0], height - pixels[:, 1]], axis=1)
    cv2.polylines(mask, [np.rint(upright).astype(np.int32)], isClosed=True, color=_LINE)
    cv2.floodFill(mask, None, (0, 0), _OUTSIDE)  # what no part of the stroke encloses; crossings leave no holes
    corner = low - _MARGIN * scale
    place = MaskPlace((float(corner[0]), float(corner[1])), scale)
    chains = [
        chain
        for chain in trace(np.asarray(mask != _OUTSIDE, np.bool_), place, _TOLERANCE * scale, 0.0)
        if signed_area(chain) > 0.0
    ]
    if not chains:
        raise ScenarioError("the stroke encloses nothing: draw round the obstacle")
    return floats(max(chains, key=signed_area))
