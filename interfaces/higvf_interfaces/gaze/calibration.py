"""Gaze calibration: a homography from the recording's screen to the arena, fitted to point pairs.

The operator looks at four or five targets whose positions on the ground are known; `cv2.findHomography` fits the
homography (Hartley and Zisserman, "Multiple View Geometry", 2nd ed., section 4.1). A homography whose horizon crosses
the screen maps gaze to infinity and is rejected. With four points the residual is always 0; with five it measures the
quality of the fit. A calibration is stored as YAML or JSON:

    screen_px: [1920, 1080]
    points_px: [[370, 108], [1550, 108], [1550, 972], [370, 972], [960, 540]]
    points_m: [[120, 630], [1080, 630], [1080, 70], [120, 70], [600, 350]]
    made: 2026-03-02T14:05:00+01:00      # optional; default: the file's modification time
"""

from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.optional import optional
from higvf_console.core.reading.document import read_text, read_yaml, yaml_text
from higvf_console.core.reports import CalibrationReport
from higvf_console.core.viewport import Arena
from higvf_interfaces.fields import Fields

if TYPE_CHECKING:
    import cv2
else:
    cv2 = optional("cv2", "devices")

MARGIN = 0.1  # distance of the targets from the border, as a share of the arena's sides
KEYS = ("screen_px", "points_px", "points_m", "residual_m", "made")
_FEWEST = 4
_NEAREST_HORIZON = 0.1  # smallest homogeneous weight allowed on the screen, as a share of the largest


class Calibration(NamedTuple):
    """A mapping from the recording's screen to the arena.

    Attributes:
        homography: (3, 3) matrix H: w (x, y, 1) on the ground [m] = H (u, v, 1) on the screen [px].
        screen: width and height of the screen [px].
        points_px: (n, 2) measured gaze [px].
        points_m: (n, 2) targets on the ground [m].
        residual: root mean square error on the ground [m].
        file: path of the file; empty if not stored.
        made: date and time of the calibration, ISO 8601.
    """

    homography: Floats
    screen: tuple[float, float]
    points_px: Floats
    points_m: Floats
    residual: float
    file: str = ""
    made: str = ""


def targets(arena: Arena, count: int, margin: float = MARGIN) -> Floats:
    """Return the calibration targets (count, 2) [m]: four corners clockwise from the top left, then the centre.

    Raises:
        InputError: If `count` is neither 4 nor 5.
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
    """Fit the homography from screen to arena.

    Args:
        points_px: (n, 2) fixation centroids [px], n >= 4.
        points_m: (n, 2) targets on the ground [m].
        screen: width and height of the screen [px].
        place: prefix of error messages.

    Raises:
        InputError: If there are too few points, the points are collinear, or the horizon crosses the screen.
    """
    if len(points_px) < _FEWEST or len(points_px) != len(points_m):
        raise InputError(
            f"{place}: {len(points_px)} points_px and {len(points_m)} points_m; give the same number of each, 4 or more"
        )
    centre, spread = points_px.mean(axis=0), points_px.std() or 1.0
    fitted = cast(object, cv2.findHomography((points_px - centre) / spread, points_m)[0])
    spanned = not _on_a_line(points_px) and not _on_a_line(points_m)
    if not isinstance(fitted, np.ndarray) or not np.isfinite(fitted).all() or not spanned:  # pyright: ignore[reportUnknownArgumentType]
        raise InputError(f"{place}: no homography fits these points; at least four must not be collinear")
    normal = np.array([[1 / spread, 0, -centre[0] / spread], [0, 1 / spread, -centre[1] / spread], [0, 0, 1]])
    homography = floats(floats(fitted) @ normal)  # pyright: ignore[reportUnknownArgumentType]
    weights = _weights(homography, floats([[0, 0], [screen[0], 0], [screen[0], screen[1]], [0, screen[1]]]))
    if weights.min() <= _NEAREST_HORIZON * weights.max():
        raise InputError(f"{place}: the horizon of the fitted homography crosses the screen; repeat the calibration")
    calibration = Calibration(homography, screen, points_px, points_m, 0.0)
    missed = to_arena(calibration, points_px) - points_m
    return calibration._replace(residual=float(np.sqrt(np.mean(np.sum(missed**2, axis=1)))))  # pyright: ignore[reportUnknownArgumentType]


def to_arena(calibration: Calibration, pixels: Floats) -> Floats:
    """Map screen pixels (n, 2) to ground points (n, 2) [m]; NaN beyond the horizon."""
    weights = _weights(calibration.homography, pixels)
    mapped = np.column_stack([pixels, np.ones(len(pixels))]) @ calibration.homography[:2].T
    return floats(np.where(weights[:, None] > 0, mapped / np.where(weights > 0, weights, 1.0)[:, None], np.nan))


def residual_px(calibration: Calibration) -> float:
    """Return the root mean square error on the screen [px]."""
    back = np.linalg.inv(calibration.homography)
    mapped = np.column_stack([calibration.points_m, np.ones(len(calibration.points_m))]) @ back.T
    missed = mapped[:, :2] / mapped[:, 2:] - calibration.points_px
    return float(np.sqrt(np.mean(np.sum(missed**2, axis=1))))  # pyright: ignore[reportUnknownArgumentType]


def calibration_report(calibration: Calibration) -> CalibrationReport:
    """Return the report of a calibration, which the console shows and records."""
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
    """Read a calibration file and fit its homography.

    Raises:
        InputError: If the file is invalid; the message gives place, value and known keys.
    """
    fields = Fields.of(read_yaml(read_text(path, InputError), str(path), InputError), KEYS)
    width, height = fields.numbers("screen_px", 2)
    if min(width, height) < 1:
        raise fields.required("screen_px").wrong("[width, height]")
    fitted = calibrate(fields.points("points_px"), fields.points("points_m"), (width, height), str(path))
    return fitted._replace(file=str(path), made=_made(path, fields))


def _made(path: Path, fields: Fields) -> str:
    """Return the time stored in the file, or its modification time."""
    if fields.has("made"):
        return fields.text("made")
    return datetime.fromtimestamp(path.stat().st_mtime).astimezone().isoformat(timespec="seconds")


def calibration_text(calibration: Calibration) -> str:
    """Return a calibration as YAML; the residual is included for information."""
    content = {
        "screen_px": list(calibration.screen),
        "points_px": calibration.points_px.tolist(),
        "points_m": calibration.points_m.tolist(),
        "residual_m": calibration.residual,
        **({"made": calibration.made} if calibration.made else {}),
    }
    return yaml_text(content)


def _weights(homography: Floats, pixels: Floats) -> Floats:
    """Return the homogeneous weight (n,) of mapped pixels, positive on the near side of the horizon."""
    return floats(np.column_stack([pixels, np.ones(len(pixels))]) @ homography[2])


def _on_a_line(points: Floats) -> bool:
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[1] <= 1e-6 * spread[0])
