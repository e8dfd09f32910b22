"""Obstacles from a picture seen from above: what is dark, or bright, becomes chains of points."""

import io
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Bools, Floats, floats
from higvf_console.core.errors import ScenarioError
from higvf_console.core.optional import optional
from higvf_console.core.quantity import shown
from higvf_console.world.polygons import MOST_EDGES, crossing, oriented, signed_area

if TYPE_CHECKING:
    import cv2
    from cv2.typing import MatLike
    from PIL import Image
else:
    cv2, MatLike = optional("cv2", "images"), np.ndarray
    Image = optional("PIL.Image", "images")

Grey: TypeAlias = NDArray[np.uint8]

MOST_PIXELS = 16_000_000
# A pixel becomes so many by so many: given a margin of one, two shapes then overlap or keep apart, but never touch.
_FINE = 3
_PARENT = 3  # column of findContours' tree: the shape that a free area is in, -1 for a shape
_HALVINGS = 12  # of the tolerance; the outline is then that of the pixels


class MaskPlace(NamedTuple):
    """Where a picture lies on the ground.

    Attributes:
        corner: (x, y) of its lower left corner [m].
        scale: side of a pixel [m].
    """

    corner: tuple[float, float]
    scale: float


def read_grey(name: str, folders: Sequence[Path]) -> Grey:
    """Brightness (rows, columns) of an image, 0 black to 255 white; what is transparent is white.

    Args:
        name: path of the file, in one of the folders.
        folders: where to look, in this order.

    Raises:
        ScenarioError: no such file, or not an image; the message says where it was looked for.
    """
    file: Path | None = None
    try:
        file = next((folder / name for folder in folders if (folder / name).is_file()), None)
        coded = None if file is None else np.fromfile(file, np.uint8)
    except OSError as error:
        raise ScenarioError(f"{file or shown(name)}: {error.strerror}") from error
    if file is None or coded is None:
        raise ScenarioError(f"no image '{name}' in {' or '.join(str(folder.resolve()) for folder in folders)}")
    try:
        return grey(decoded(coded.tobytes(), cv2.IMREAD_UNCHANGED))
    except ScenarioError as error:
        raise ScenarioError(f"{file}: {error}") from error


def decoded(content: bytes, colours: int) -> MatLike:
    """An image file's content, decoded; its header is asked for its size first, for a small file can hold a huge image.

    Args:
        content: of the file.
        colours: as OpenCV's `imdecode` takes them.

    Raises:
        ScenarioError: it is no image, or has too many pixels.
    """
    with suppress(OSError), warnings.catch_warnings():  # what Pillow does not know, OpenCV may
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
        try:
            with Image.open(io.BytesIO(content)) as header:
                _check_size(*header.size)
        except Image.DecompressionBombError as error:
            raise ScenarioError(f"over 100 million pixels; give at most {MOST_PIXELS / 1e6:g} million") from error
    image = cv2.imdecode(np.frombuffer(content, np.uint8), colours) if content else None
    if image is None:
        raise ScenarioError("not an image that OpenCV can read, such as PNG, JPEG or TIFF")
    _check_size(image.shape[1], image.shape[0])
    return image


def _check_size(width: int, height: int) -> None:
    if width * height > MOST_PIXELS:
        raise ScenarioError(f"{width} x {height} pixels; give at most {MOST_PIXELS / 1e6:g} million")


def grey(image: MatLike) -> Grey:
    """Brightness (rows, columns) of an image as OpenCV decodes it, 0 black to 255 white; transparent is white."""
    white = {"uint8": 255.0, "uint16": 65535.0}.get(image.dtype.name, 1.0)
    light = (image if image.ndim == 3 else image[:, :, None]).astype(np.float32) * (255.0 / white)
    if light.shape[2] in (2, 4):
        opaque = light[:, :, -1:] / 255.0
        light = light[:, :, :-1] * opaque + 255.0 * (1.0 - opaque)
    if light.shape[2] == 3:
        light = light @ np.array([0.114, 0.587, 0.299], np.float32)[:, None]  # blue, green, red of ITU-R BT.601
    return np.rint(np.clip(light[:, :, 0], 0.0, 255.0)).astype(np.uint8)


def trace(blocked: Bools, place: MaskPlace, tolerance: float, least_area: float) -> tuple[Floats, ...]:
    """The outlines of the blocked pixels, simplified, as in `polygons`.

    Outlines run a sixth of a pixel outside the pixels, so that none touches itself where a shape is one pixel thin.
    A free area that a shape encloses keeps an outline of its own.

    Args:
        blocked: (rows, columns) the first row is the upper edge of the picture.
        place: where it lies.
        tolerance: how far a simplified outline may be off [m]; less where it would cross itself or another one.
        least_area: shapes are left out, and free areas filled, when smaller [m^2].
    """
    fine = np.pad(blocked, 1).astype(np.uint8).repeat(_FINE, axis=0).repeat(_FINE, axis=1)
    fine = cv2.dilate(fine, np.ones((3, 3), np.uint8))
    contours, tree = cv2.findContours(fine, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE)
    large = [k for k, contour in enumerate(contours) if _area(contour, place) >= least_area]
    shapes: dict[int, list[MatLike]] = {k: [contours[k]] for k in large if tree[0][k][_PARENT] == -1}
    for k in large:
        if tree[0][k][_PARENT] in shapes:
            shapes[tree[0][k][_PARENT]].append(contours[k])
    return tuple(
        chain for outlines in shapes.values() for chain in _simplified(outlines, place, len(blocked), tolerance)
    )


def _area(contour: MatLike, place: MaskPlace) -> float:
    return cv2.contourArea(contour) * (place.scale / _FINE) ** 2


def _simplified(outlines: list[MatLike], place: MaskPlace, rows: int, tolerance: float) -> list[Floats]:
    """A shape and its free areas with as few points as the tolerance allows."""
    chains: list[Floats] = []
    for halving in range(_HALVINGS + 1):
        epsilon = 0.5**halving * tolerance * _FINE / place.scale if halving < _HALVINGS else 0.0
        chains = [_on_ground(cv2.approxPolyDP(outline, epsilon, True), place, rows) for outline in outlines]
        if sum(len(chain) for chain in chains) > MOST_EDGES:
            break  # will be refused
        if all(len(chain) > 2 and signed_area(chain) != 0.0 for chain in chains) and not crossing(chains):
            break
    return [oriented(chain, clockwise=k > 0) for k, chain in enumerate(chains)]


def _on_ground(contour: MatLike, place: MaskPlace, rows: int) -> Floats:
    """Centres of fine pixels as ground points (n, 2) [m]; rows count downward, y upward."""
    pixel = (contour.reshape(-1, 2) + 0.5) / _FINE - 1.0  # less the margin
    return floats([place.corner] + place.scale * np.stack([pixel[:, 0], rows - pixel[:, 1]], axis=1))
