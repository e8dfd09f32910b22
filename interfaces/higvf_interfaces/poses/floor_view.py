"""The floor as the camera has it now: where pixels lie on it, and the picture of it from straight above.

Points of the floor file stay. Tags that lie on the floor are looked for in each picture: their mean places make the
homography, and a camera that was moved begins anew.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.optional import optional
from higvf_console.core.viewport import Arena
from higvf_interfaces.poses.calibration import FEWEST, Floor, Lens, fitted, inverse, lowered, mapped
from higvf_interfaces.poses.tags import Tag

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

MOVED_PX = 4.0  # by which a tag of the floor may leave its mean place
_MEAN_OVER = 50  # pictures
_WIDEST = 640  # of the picture of the floor [px]


class FloorView:
    """Maps pixels to the floor; without a homography as long as its tags have not been seen."""

    def __init__(self, floor: Floor, lens: Lens | None, size: tuple[int, int], arena: Arena, place: str) -> None:
        """Fits what can be fitted before the first picture.

        Args:
            floor: of the file.
            lens: of the camera; None = without distortion.
            size: of the pictures [px].
            arena: what is shown.
            place: how errors call the source.

        Raises:
            InputError: pictures of another size than the files are for, or points that no homography fits.
        """
        for what, image in (("lens", None if lens is None else lens.image), ("floor", floor.image)):
            if image is not None and image != size:
                sides = f"{image[0]} x {image[1]} px, and the pictures are {size[0]} x {size[1]} px"
                raise InputError(f"{place}: the {what} was measured in pictures of {sides}; measure it again")
        self._floor, self._lens, self._size, self._arena = floor, lens, size, arena
        self._seen: dict[int, tuple[Floats, int]] = {}  # mean place [px] of each tag, and over how many pictures
        self._maps: tuple[NDArray[np.int16], NDArray[np.uint16]] | None = None
        self.homography: Floats | None = None
        if not floor.tags:
            self._fit(floor.pixels, floor.ground)

    def look(self, tags: Iterable[Tag]) -> bool:
        """Takes in the tags of a picture; returns whether the camera was moved since the last ones."""
        if not self._floor.tags:
            return False
        moved = False
        for tag in tags:
            if tag.id not in self._floor.tags:
                continue
            centre = _centre(tag.corners)
            mean, count = self._seen.get(tag.id, (centre, 0))
            if float(np.hypot(*(centre - mean))) > MOVED_PX:
                moved = True
                break
            count = min(count + 1, _MEAN_OVER)
            self._seen[tag.id] = (mean + (centre - mean) / count, count)
        if moved:
            self._seen.clear()
            self.homography, self._maps = None, None
        elif len(self._seen) >= FEWEST and (self.homography is None or self._settling()):
            pixels = floats([self._seen[number][0] for number in self._seen])
            self._fit(pixels, floats([self._floor.tags[number] for number in self._seen]))
        return moved

    def on_floor(self, pixels: Floats, height: float) -> Floats:
        """Where points (n, 2) [px], `height` [m] above the floor, are [m]."""
        assert self.homography is not None
        straight = pixels if self._lens is None else self._lens.straightened(pixels)
        points = mapped(self.homography, straight)
        if height == 0.0 or self._floor.camera is None:
            return points
        return lowered(points, height, self._floor.camera)

    def pixels_per_metre(self) -> float:
        """In the middle of the arena."""
        if self.homography is None:
            return np.nan
        x, y = (self._arena.x_min + self._arena.x_max) / 2, (self._arena.y_min + self._arena.y_max) / 2
        back = mapped(inverse(self.homography), floats([[x, y], [x + 0.01, y]]))
        return float(np.hypot(*(back[1] - back[0]))) / 0.01

    def from_above(self, image: NDArray[np.uint8]) -> NDArray[np.uint8] | None:
        """The arena (rows, columns, 3) as seen from straight above, in the colours of `image`; None = not known yet."""
        if self.homography is None:
            return None
        if self._maps is None:
            self._maps = self._places()
        return np.asarray(cv2.remap(image, *self._maps, cv2.INTER_LINEAR), np.uint8)

    def _settling(self) -> bool:
        return any(count < _MEAN_OVER for _, count in self._seen.values())

    def _fit(self, pixels: Floats, ground: Floats) -> None:
        straight = pixels if self._lens is None else self._lens.straightened(pixels)
        self.homography = fitted(straight, ground, self._floor.file)
        self._maps = None

    def _places(self) -> tuple[NDArray[np.int16], NDArray[np.uint16]]:
        """For each pixel of the picture from above, where it is in the camera's."""
        assert self.homography is not None
        arena = self._arena
        columns = _WIDEST if arena.width >= arena.height else max(round(_WIDEST * arena.width / arena.height), 1)
        rows = max(round(columns * arena.height / arena.width), 1)
        x = arena.x_min + (np.arange(columns) + 0.5) * arena.width / columns
        y = arena.y_max - (np.arange(rows) + 0.5) * arena.height / rows
        ground = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        pixels = mapped(inverse(self.homography), ground)
        if self._lens is not None:
            pixels = self._lens.bent(pixels)
        places = pixels.astype(np.float32).reshape(rows, columns, 2)
        whole, parts = cv2.convertMaps(places[:, :, 0], places[:, :, 1], cv2.CV_16SC2)
        return np.asarray(whole, np.int16), np.asarray(parts, np.uint16)


def _centre(corners: Floats) -> Floats:
    """Where the diagonals of a tag (4, 2) cross: its centre in any perspective."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = corners
    across, along = np.array([cx - ax, cy - ay]), np.array([dx - bx, dy - by])
    share = ((bx - ax) * along[1] - (by - ay) * along[0]) / (across[0] * along[1] - across[1] * along[0])
    return floats([ax, ay]) + share * across
