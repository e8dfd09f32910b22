"""Square tags (ArUco, AprilTag) in a picture, by OpenCV: looked for at half size, their corners refined at full size.

A search takes time with the number of pixels, so it is done at half size wherever a tag remains large enough there.
"""

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError, closest
from higvf_console.core.optional import optional

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

Grey = NDArray[np.uint8]  # a picture (rows, columns)
_SMALLEST = 24.0  # side of a tag from which on it is found at half size [px]
_WIDE = 1280  # a picture of so many columns is searched at half size where nothing is known of the tags [px]
_WINDOW = 0.08  # of a tag's side: half the window in which a corner is refined


class Tag(NamedTuple):
    """A tag: its id, and its corners (4, 2) [px], clockwise from the top left one of the upright tag."""

    id: int
    corners: Floats

    @property
    def side(self) -> float:
        """Mean length of its sides [px]."""
        edges = np.roll(self.corners, -1, axis=0) - self.corners
        return float(np.hypot(edges[:, 0], edges[:, 1]).mean())


def dictionary_names() -> tuple[str, ...]:
    """The dictionaries that OpenCV has, as `4x4_50`."""
    known = (name.removeprefix("DICT_") for name in dir(cv2.aruco) if name.startswith("DICT_"))
    return tuple(sorted((name.lower() for name in known), key=_in_order))


def _in_order(name: str) -> tuple[Any, ...]:
    head, _, tail = name.partition("_")
    return head, int(tail) if tail.isdigit() else math.inf, tail


def dictionary(name: str, place: str) -> "cv2.aruco.Dictionary":
    """A dictionary of tags by its name.

    Raises:
        InputError: there is none of that name; the message starts with `place` and lists them.
    """
    names = dictionary_names()
    wanted = name.lower().removeprefix("dict_")
    if wanted not in names:
        raise InputError(f"{place}: tags={name} is no dictionary{closest(wanted, names)}; choose {', '.join(names)}")
    key = next(key for key in dir(cv2.aruco) if key.lower() == f"dict_{wanted}")
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, key))


class TagDetector:
    """Finds the tags of one dictionary."""

    def __init__(self, tags: "cv2.aruco.Dictionary") -> None:
        """Sets up the search."""
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_NONE  # done at full size below
        self._detector = cv2.aruco.ArucoDetector(tags, parameters)

    def find(self, grey: Grey, side: float = math.nan) -> list[Tag]:
        """The tags in a picture, each as often as it is seen.

        Args:
            grey: the picture.
            side: of the smallest tag [px]; NaN = unknown.
        """
        halves = grey.shape[1] >= _WIDE if math.isnan(side) else side >= _SMALLEST
        if not halves:
            return [self._refined(grey, tag) for tag in self._search(grey)]
        half = np.asarray(cv2.resize(grey, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA), np.uint8)
        return [self._refined(grey, Tag(tag.id, 2.0 * tag.corners + 0.5)) for tag in self._search(half)]

    def _search(self, grey: Grey) -> list[Tag]:
        found: Any = self._detector.detectMarkers(grey)
        corners, ids, _ = found
        if ids is None:
            return []
        return [
            Tag(int(number), floats(four, 4, 2)) for number, four in zip(np.ravel(ids).tolist(), corners, strict=True)
        ]

    @staticmethod
    def _refined(grey: Grey, tag: Tag) -> Tag:
        """A window below the width of a module, so that no corner is drawn to one of the tag's inside."""
        window = max(2, round(_WINDOW * tag.side))
        criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 20, 0.01)
        start = tag.corners.astype(np.float32).reshape(-1, 1, 2)
        found = cv2.cornerSubPix(grey, start.copy(), (window, window), (-1, -1), criteria)
        moved = np.abs(found - start).max(axis=(1, 2), keepdims=True)
        kept = np.where(moved <= window, found, start)  # one that has run away stays where it was found
        return Tag(tag.id, floats(kept, 4, 2))
