"""An overhead image under everything else, faint enough that what is drawn over it stays legible."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from higvf_console.core.optional import optional
from higvf_console.core.viewport import Arena
from higvf_console.ui.scene.parts import Canvas, Layer, Picture
from higvf_console.world.editing.overhead import Pixels
from higvf_console.world.masks import MaskPlace

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "console")

_OPACITY = 0.35
_MOST_SIDE = 1600  # pixels that are sent


class Background(NamedTuple):
    """An image on the ground.

    Attributes:
        picture: red, green and blue (rows, columns, 3); row 0 is the top.
        place: where it lies.
    """

    picture: Pixels
    place: MaskPlace

    @property
    def extent(self) -> Arena:
        """The ground that it covers."""
        (x, y), scale = self.place
        rows, columns = self.picture.shape[:2]
        return Arena(x, y, x + columns * scale, y + rows * scale)


class BackgroundLayer:
    """Hung anew when image or place change."""

    def __init__(self, canvas: Canvas) -> None:
        """Starts without an image."""
        self._canvas = canvas
        self._shown: Background | None = None
        self._picture: Picture | None = None

    def update(self, background: Background | None) -> None:
        """Shows an image, or none."""
        if background is self._shown:
            return
        self._shown = background
        if background is not None:
            self._picture = self._canvas.picture(Layer.IMAGE, "/ground/image", background.extent)
            self._picture.paint(painted(background.picture))
        if self._picture is not None:
            self._picture.show(background is not None)


def painted(picture: Pixels) -> Pixels:
    """The picture (rows, columns, 4) as it is sent: not too large, and faint."""
    side = max(picture.shape[:2])
    if side > _MOST_SIDE:
        size = (np.array(picture.shape[1::-1]) * _MOST_SIDE / side).astype(int)
        picture = np.asarray(cv2.resize(picture, size.tolist(), interpolation=cv2.INTER_AREA), np.uint8)
    opacity = np.full(picture.shape[:2], round(255 * _OPACITY), np.uint8)
    return np.dstack([picture, opacity])
