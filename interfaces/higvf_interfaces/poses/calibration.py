"""From the pixels of an overhead camera to metres on the floor: two files, in YAML.

The lens (optional), as `cv2.calibrateCamera` gives it:

    image_px: [1920, 1080]
    camera_matrix: [[1400, 0, 960], [0, 1400, 540], [0, 0, 1]]
    distortion: [-0.28, 0.07, 0, 0, 0]

The floor, by points whose pixels are known, or by tags that lie on it and are looked for in the picture:

    image_px: [1920, 1080]
    points_px: [[260, 110], [1660, 118], [1672, 985], [251, 990]]
    points_m: [[0, 2], [3.2, 2], [3.2, 0], [0, 0]]
    camera_m: [1.6, 1.0, 2.6]          # optional: where the camera hangs, for tags above the floor

    tags:
      - {id: 40, at_m: [0.1, 1.9]}
      - {id: 41, at_m: [3.1, 1.9]}
      - {id: 42, at_m: [3.1, 0.1]}
      - {id: 43, at_m: [0.1, 0.1]}

A floor is a homography (Hartley and Zisserman, "Multiple View Geometry", 2nd ed., section 4.1).
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.optional import optional
from higvf_console.core.quantity import Quantity
from higvf_console.core.reading.document import read_text, read_yaml
from higvf_console.core.reading.node import Node

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "images")

FEWEST = 4  # points that make a homography
MOST_TAGS = 1024  # ids of the largest dictionary
_LENS = ("image_px", "camera_matrix", "distortion")
_POINTS = ("image_px", "points_px", "points_m", "camera_m")
_TAGS = ("tags", "camera_m")
_NEAREST_HORIZON = 0.1  # smallest homogeneous weight allowed on the floor's points, as a share of the largest
_FLATTEST = 1e-3  # of three points: height of their triangle as a share of its longest side
_SIDE = Quantity("px", 16, 16384, "", "Side of a picture.")
_PIXEL = Quantity("px", -1e5, 1e5, "", "A place in a picture.")
_ANY = Quantity("", -1e6, 1e6, "", "A number.")


class Lens(NamedTuple):
    """A lens: size of the pictures (width, height) [px], camera matrix (3, 3) [px], distortion (4, 5 or 8,)."""

    image: tuple[int, int]
    matrix: Floats
    distortion: Floats

    def straightened(self, pixels: Floats) -> Floats:
        """Pixels (n, 2) as a lens without distortion would have them."""
        return floats(cv2.undistortPoints(pixels.reshape(-1, 1, 2), self.matrix, self.distortion, P=self.matrix), -1, 2)

    def bent(self, pixels: Floats) -> Floats:
        """The inverse of `straightened`."""
        rays = np.column_stack((pixels, np.ones(len(pixels)))) @ np.linalg.inv(self.matrix).T
        bent, _ = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), self.matrix, self.distortion)
        return floats(bent, -1, 2)


class Floor(NamedTuple):
    """What is known of the floor before the first picture.

    Attributes:
        file: for errors.
        image: size of the pictures (width, height) [px] that `pixels` belong to; None = those of tags are looked for.
        pixels: (n, 2) [px]; (0, 2) with tags.
        ground: (n, 2) where they are on the floor [m]; (0, 2) with tags.
        tags: where the centres of tags (2,) lie [m], by id; empty with points.
        camera: (3,) where the camera hangs [m]; None = unknown.
    """

    file: str
    image: tuple[int, int] | None
    pixels: Floats
    ground: Floats
    tags: Mapping[int, Floats]
    camera: Floats | None


def read_lens(file: Path) -> Lens:
    """The lens of a file.

    Raises:
        InputError: it cannot be read, or is no lens; the message gives file, place, value and known keys.
    """
    entries = _read(file).section(_LENS, required=_LENS)
    rows = entries["camera_matrix"].items(3)
    matrix = floats([row.numbers(3, _ANY) for row in rows])
    if matrix.shape != (3, 3) or not (matrix[0, 0] > 0 < matrix[1, 1]) or matrix[2].tolist() != [0, 0, 1]:
        raise entries["camera_matrix"].wrong("[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with fx and fy above 0")
    given = entries["distortion"]
    count = len(given.items(8))
    if count not in (4, 5, 8):
        raise given.wrong("a list of 4, 5 or 8 numbers, as cv2.calibrateCamera gives it")
    return Lens(_image(entries["image_px"]), matrix, floats(given.numbers(count, _ANY)))


def read_floor(file: Path) -> Floor:
    """The floor of a file.

    Raises:
        InputError: it cannot be read, or is no floor; the message gives file, place, value and known keys.
    """
    root = _read(file)
    value: Any = root.value
    by_tags = isinstance(value, Mapping) and "tags" in value
    known, required = (_TAGS, ("tags",)) if by_tags else (_POINTS, _POINTS[:3])
    entries = root.section(known, required=required)
    camera = None
    if "camera_m" in entries:
        camera = floats(entries["camera_m"].numbers(3))
        if camera[2] <= 0.0:
            raise entries["camera_m"].wrong("[x, y, height] with a height above 0")
    if by_tags:
        tags = _tags(entries["tags"])
        _check_spread(entries["tags"], floats(list(tags.values())))
        return Floor(str(file), None, floats([], 0, 2), floats([], 0, 2), tags, camera)
    pixels = floats([item.numbers(2, _PIXEL) for item in entries["points_px"].items()], -1, 2)
    ground = entries["points_m"].points(FEWEST)
    if len(pixels) != len(ground):
        raise root.error(f"{len(pixels)} points_px and {len(ground)} points_m; give the same number of each")
    for node, points in ((entries["points_px"], pixels), (entries["points_m"], ground)):
        _check_spread(node, points)
    return Floor(str(file), _image(entries["image_px"]), pixels, ground, {}, camera)


def fitted(pixels: Floats, ground: Floats, place: str) -> Floats:
    """The homography (3, 3) from pixels (n, 2) of a straight lens to the floor (n, 2) [m].

    Raises:
        InputError: none fits, or the horizon lies between the points; the message starts with `place`.
    """
    found: Any = cv2.findHomography(pixels, ground)[0]
    if found is None or not np.isfinite(found).all():
        raise InputError(f"{place}: no homography fits these points; four must be corners of a quadrangle")
    homography = floats(found)
    weights = np.column_stack((pixels, np.ones(len(pixels)))) @ homography[2]
    if weights.min() * weights.max() <= 0.0 or abs(weights).min() <= _NEAREST_HORIZON * abs(weights).max():
        raise InputError(f"{place}: the horizon lies between these points; are their pixels and metres in one order?")
    return homography


def inverse(homography: Floats) -> Floats:
    """From the floor to pixels."""
    return floats(np.linalg.inv(homography))


def mapped(homography: Floats, points: Floats) -> Floats:
    """Points (n, 2) through a homography (3, 3)."""
    whole = np.column_stack((points, np.ones(len(points)))) @ homography.T
    return whole[:, :2] / whole[:, 2:]


def lowered(points: Floats, height: float, camera: Floats) -> Floats:
    """Where points (n, 2) [m] really are that look as if they lay on the floor, and are `height` [m] above it."""
    return camera[:2] + (points - camera[:2]) * (1.0 - height / camera[2])


def _read(file: Path) -> Node:
    return read_yaml(read_text(file, InputError), str(file), InputError)


def _image(node: Node) -> tuple[int, int]:
    width, height = node.numbers(2, _SIDE)
    if not (width.is_integer() and height.is_integer()):
        raise node.wrong("[width, height] in whole pixels")
    return int(width), int(height)


def _tags(node: Node) -> dict[int, Floats]:
    items = node.items(MOST_TAGS)
    if len(items) < FEWEST:
        raise node.error(f"{len(items)} tags are too few; give at least {FEWEST}")
    tags: dict[int, Floats] = {}
    for item in items:
        entries = item.section(("id", "at_m"), required=("id", "at_m"))
        number = entries["id"].integer(0, MOST_TAGS - 1)
        if number in tags:
            raise entries["id"].error(f"tag {number} is given twice")
        tags[number] = floats(entries["at_m"].point())
    return tags


def _check_spread(node: Node, points: Floats) -> None:
    """Refuses fewer than four points, and four of which three lie on a line."""
    if len(points) < FEWEST:
        raise node.error(f"{len(points)} points are too few; give at least {FEWEST}")
    if len(points) == FEWEST and any(_flat(np.delete(points, left, axis=0)) for left in range(FEWEST)):
        raise node.error("three of the four points lie on a line; give corners of a quadrangle")


def _flat(three: Floats) -> bool:
    sides = np.roll(three, -1, axis=0) - three
    longest = float(np.hypot(sides[:, 0], sides[:, 1]).max())
    area = abs(float(sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0]))
    return area <= _FLATTEST * longest**2
