"""From the screen of a gaze recording to the arena: a homography through points whose places are known in both.

The operator looks at four corners, or at five points, whose places on the ground are known; `cv2.findHomography` fits
the map (Hartley and Zisserman, "Multiple View Geometry", 2nd ed., section 4.1). A map whose horizon crosses the screen
would throw gaze to infinity and is refused. With four points the residual is always 0 and says nothing; with five it
tells how well a plane explains them. Stored as YAML (or JSON, which YAML reads):

    screen_px: [1920, 1080]
    points_px: [[370, 108], [1550, 108], [1550, 972], [370, 972], [960, 540]]
    points_m: [[120, 630], [1080, 630], [1080, 70], [120, 70], [600, 350]]
    made: 2026-03-02T14:05:00+01:00      # optional; else the file's own time
"""

from datetime import datetime
from pathlib import Path
from typing import NamedTuple, cast

import cv2
import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.reading.document import read_text, read_yaml, yaml_text
from higvf_console.core.reports import CalibrationReport
from higvf_console.core.viewport import Arena
from higvf_interfaces.fields import Fields

MARGIN = 0.1  # of the arena's sides, between its border and the points to look at
KEYS = ("screen_px", "points_px", "points_m", "residual_m", "made")
_FEWEST = 4
_NEAREST_HORIZON = 0.1  # smallest weight on the screen, as a share of the largest


class Calibration(NamedTuple):
    """A map from the recording's screen to the arena.

    Attributes:
        homography: (3, 3): w (x, y, 1) on the ground [m] = homography (u, v, 1) on the screen [px].
        screen: width and height [px].
        points_px: (n, 2) where gaze was.
        points_m: (n, 2) what it looked at.
        residual: root mean square of the points' distances on the ground [m].
        file: where it is stored; empty where it is not.
        made: date and time, as ISO 8601.
    """

    homography: Floats
    screen: tuple[float, float]
    points_px: Floats
    points_m: Floats
    residual: float
    file: str = ""
    made: str = ""


def targets(arena: Arena, count: int, margin: float = MARGIN) -> Floats:
    """Ground points (count, 2) [m] to look at: four corners, clockwise from the top left, or these and the centre.

    Raises:
        InputError: `count` is neither 4 nor 5.
    """
    if count not in (4, 5):
        raise InputError(f"calibration: {count} points; choose 4 (corners) or 5 (corners and centre)")
    left, right = arena.x_min + margin * arena.width, arena.x_max - margin * arena.width
    low, high = arena.y_min + margin * arena.height, arena.y_max - margin * arena.height
    corners = [(left, high), (right, high), (right, low), (left, low)]
    return floats([*corners, ((left + right) / 2, (low + high) / 2)][:count])


def calibrate(
    points_px: Floats, points_m: Floats, screen: tuple[float, float], place: str = "calibration"
) -> Calibration:
    """Fits the map from screen to arena.

    Args:
        points_px: (n, 2), n >= 4: where gaze was, the centroid of a fixation each.
        points_m: (n, 2) what it looked at.
        screen: width and height [px].
        place: how an error message calls it.

    Raises:
        InputError: too few points, points on one line, or a map whose horizon crosses the screen.
    """
    if len(points_px) < _FEWEST or len(points_px) != len(points_m):
        raise InputError(f"{place}: {len(points_px)} points_px and {len(points_m)} points_m; give as many, 4 or more")
    centre, spread = points_px.mean(axis=0), points_px.std() or 1.0
    fitted = cast(object, cv2.findHomography((points_px - centre) / spread, points_m)[0])
    spanned = not _on_a_line(points_px) and not _on_a_line(points_m)
    if not isinstance(fitted, np.ndarray) or not np.isfinite(fitted).all() or not spanned:
        raise InputError(f"{place}: no map goes through these points; four of them must span an area")
    normal = np.array([[1 / spread, 0, -centre[0] / spread], [0, 1 / spread, -centre[1] / spread], [0, 0, 1]])
    homography = floats(floats(fitted) @ normal)
    weights = _weights(homography, floats([[0, 0], [screen[0], 0], [screen[0], screen[1]], [0, screen[1]]]))
    if weights.min() <= _NEAREST_HORIZON * weights.max():
        raise InputError(f"{place}: the horizon of this map lies on the screen or near it; look at the points again")
    calibration = Calibration(homography, screen, points_px, points_m, 0.0)
    missed = to_arena(calibration, points_px) - points_m
    return calibration._replace(residual=float(np.sqrt(np.mean(np.sum(missed**2, axis=1)))))


def to_arena(calibration: Calibration, pixels: Floats) -> Floats:
    """Ground points (n, 2) [m] under pixels (n, 2) of the screen; NaN beyond the horizon."""
    weights = _weights(calibration.homography, pixels)
    mapped = np.column_stack([pixels, np.ones(len(pixels))]) @ calibration.homography[:2].T
    return floats(np.where(weights[:, None] > 0, mapped / np.where(weights > 0, weights, 1.0)[:, None], np.nan))


def residual_px(calibration: Calibration) -> float:
    """Root mean square of the points' distances on the screen [px]."""
    back = np.linalg.inv(calibration.homography)
    mapped = np.column_stack([calibration.points_m, np.ones(len(calibration.points_m))]) @ back.T
    missed = mapped[:, :2] / mapped[:, 2:] - calibration.points_px
    return float(np.sqrt(np.mean(np.sum(missed**2, axis=1))))


def calibration_report(calibration: Calibration) -> CalibrationReport:
    """A calibration in plain values, as it is shown and written down with a run."""
    first, second, third = ((float(a), float(b), float(c)) for a, b, c in calibration.homography.tolist())
    return CalibrationReport(
        file=calibration.file,
        made=calibration.made,
        screen_px=calibration.screen,
        points_px=tuple((float(x), float(y)) for x, y in calibration.points_px.tolist()),
        points_m=tuple((float(x), float(y)) for x, y in calibration.points_m.tolist()),
        homography=(first, second, third),
        residual_px=residual_px(calibration),
        residual_m=calibration.residual,
    )


def read_calibration(path: Path) -> Calibration:
    """Reads a stored calibration and fits it again.

    Raises:
        InputError: the file cannot be used; the message gives place, value and known keys.
    """
    fields = Fields.of(read_yaml(read_text(path, InputError), str(path), InputError), KEYS)
    width, height = fields.numbers("screen_px", 2)
    if min(width, height) < 1:
        raise fields.required("screen_px").wrong("[width, height]")
    fitted = calibrate(fields.points("points_px"), fields.points("points_m"), (width, height), str(path))
    return fitted._replace(file=str(path), made=_made(path, fields))


def _made(path: Path, fields: Fields) -> str:
    """What the file says of when it was made, else when it was written."""
    if fields.has("made"):
        return fields.text("made")
    return datetime.fromtimestamp(path.stat().st_mtime).astimezone().isoformat(timespec="seconds")


def calibration_text(calibration: Calibration) -> str:
    """A calibration as YAML, with its residual for whoever reads it."""
    content = {
        "screen_px": list(calibration.screen),
        "points_px": calibration.points_px.tolist(),
        "points_m": calibration.points_m.tolist(),
        "residual_m": calibration.residual,
        **({"made": calibration.made} if calibration.made else {}),
    }
    return yaml_text(content)


def _weights(homography: Floats, pixels: Floats) -> Floats:
    """The third coordinate (n,) of mapped pixels, positive on this side of the horizon."""
    return floats(np.column_stack([pixels, np.ones(len(pixels))]) @ homography[2])


def _on_a_line(points: Floats) -> bool:
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[1] <= 1e-6 * spread[0])
