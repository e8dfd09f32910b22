"""An overhead image: read from its bytes, laid on the ground, and traced for obstacles."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats
from higvf_console.core.errors import ScenarioError
from higvf_console.core.optional import optional
from higvf_console.world.masks import MaskPlace, decoded, grey, trace
from higvf_console.world.polygons import MOST_EDGES, signed_area

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

Pixels = NDArray[np.uint8]
LEAST_PIXELS = 30.0  # area of a shape that counts as an obstacle [pixels]
_DOUBLINGS = 6  # of the tolerance, until there are few enough edges


def read_picture(content: bytes) -> Pixels:
    """Red, green and blue (rows, columns, 3) of an image file's content.

    Raises:
        ScenarioError: it is no image, or a huge one.
    """
    image = decoded(content, cv2.IMREAD_COLOR)
    return np.asarray(np.ascontiguousarray(image[:, :, ::-1]), np.uint8)


def outlines_in(picture: Pixels, place: MaskPlace, threshold: float, *, bright: bool) -> tuple[Floats, ...]:
    """Outlines (n, 2) [m] of the dark or bright shapes of a picture; free areas inside them are filled.

    Args:
        picture: red, green, blue.
        place: where it lies.
        threshold: brightness from 0 to 255 that parts dark from bright.
        bright: whether obstacles are bright; else dark.

    Raises:
        ScenarioError: there is no such shape, or they have too many edges.
    """
    light = grey(np.ascontiguousarray(picture[:, :, ::-1]))
    blocked = np.asarray((light >= threshold) if bright else (light < threshold), np.bool_)
    least, edges = LEAST_PIXELS * place.scale**2, 0
    outlines: tuple[Floats, ...] = ()
    for doubling in range(_DOUBLINGS + 1):
        found = trace(blocked, place, 1.5 * place.scale * 2.0**doubling, least)
        outlines = tuple(chain for chain in found if signed_area(chain) > 0.0)
        edges = sum(len(chain) for chain in outlines)
        if edges <= MOST_EDGES:
            break
    else:
        raise ScenarioError(f"its shapes have {edges} edges, at most {MOST_EDGES} are possible; change the threshold")
    if not outlines:
        raise ScenarioError(f"no {'bright' if bright else 'dark'} shape at threshold {threshold:g}; change it")
    return outlines
