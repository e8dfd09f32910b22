"""The live picture of an overhead camera under the arena: dated when it is late, grey when it is lost."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.optional import optional
from higvf_console.core.team import Picture
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.scene.parts import Picture as ScenePicture
from higvf_console.ui.theme import hex_rgb

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "console")

EVERY = 0.1  # at least, between two pictures that are sent [s]: 15 kB each
LATE = 1.0  # age from which on a picture is grey and dated [s]
_OPACITY = 0.4  # over the floor's colour, so that what is drawn over it stays legible
_MARGIN, _HEIGHT = 8, 14  # of the words in the picture [px]


class CameraLayer:
    """Painted when a new picture has come, and once a second when none comes any more."""

    def __init__(self, canvas: Canvas) -> None:
        """Starts without a picture."""
        self._canvas = canvas
        self._floor = hex_rgb(canvas.palette.floor)
        self._node: ScenePicture | None = None
        self._painted: tuple[float, int] | None = None  # when it was taken, and its age in whole seconds if late
        self._painted_at = -np.inf

    def update(self, picture: Picture | None, now: float) -> None:
        """Shows the newest picture at `now` [s, on the clock of its stamp], or none."""
        if picture is None:
            if self._node is not None:
                self._node.show(False)
            return
        age = now - picture.taken_at
        key = (picture.taken_at, int(age) if age >= LATE else 0)
        if key != self._painted and now - self._painted_at >= EVERY:
            self._painted, self._painted_at = key, now
            if self._node is None:
                self._node = self._canvas.picture(Layer.IMAGE, "/ground/camera", picture.extent, opaque=True)
            self._node.paint(painted(picture.rgb, self._floor, age))
        if self._node is not None:
            self._node.show(True)


def painted(rgb: NDArray[np.uint8], floor: tuple[int, int, int], age: float) -> NDArray[np.uint8]:
    """A picture (rows, columns, 3) as it is sent: faint over the floor's colour; grey and dated when late."""
    late = age >= LATE
    if late:
        rgb = np.repeat(np.asarray(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY), np.uint8)[:, :, None], 3, axis=2)
    share = 0.5 * _OPACITY if late else _OPACITY
    ground = np.empty_like(rgb)
    ground[:] = floor
    mixed = np.asarray(cv2.addWeighted(np.ascontiguousarray(rgb), share, ground, 1.0 - share, 0.0), np.uint8)
    if late:
        words = f"Camera picture of {int(age)} s ago"
        font, thick = cv2.FONT_HERSHEY_SIMPLEX, 1
        scale = cv2.getFontScaleFromHeight(font, _HEIGHT, thick)
        place = (_MARGIN, _MARGIN + _HEIGHT)
        bright = sum(floor) < 3 * 128
        cv2.putText(mixed, words, place, font, scale, (255,) * 3 if bright else (0,) * 3, thick, cv2.LINE_AA)
    return mixed
