"""Repairs of a desired path: redraw a part, move a point, close or open it.

Each function returns a new path that keeps direction, ending, pace and duration.
"""

import math

import numpy as np

from higvf_console.control.guidance.paths import EVERYWHERE, SEGMENTS, nearest, path_points, sketch_path
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import PathError
from higvf_console.core.scale import USUAL_SCALE, Scale
from higvf_console.core.state import Path, PathKind

# A stroke joins a path within a share of its length, but at least and at most so far at the usual scale [m].
JOIN_SHARE, JOIN_LEAST, JOIN_MOST = 0.1, 15.0, 80.0
_BEND_SHARE = 1 / 6  # share of the length that a moved point deforms on each side; more for a long move
_BEND_REACH = 1.5


def redrawn(path: Path, stroke: Floats, smoothing: float, scale: Scale = USUAL_SCALE) -> Path:
    """Redraws the part of the path between the two ends of a stroke.

    A stroke that does not return to an open path replaces the rest of it. On a closed path, the stroke replaces the
    shorter of the two arcs.

    Args:
        path: path to repair.
        stroke: (n, 2) [m].
        smoothing: standard deviation by which the new path may leave the points [m].
        scale: of the team.

    Raises:
        PathError: there is no path, or the stroke is too short or does not start on the path.
    """
    points = floats(stroke, -1, 2)
    if len(points) < 2:
        raise PathError("redrawing a part needs a stroke of at least 2 points")
    kept = _knots(path)
    reach = min(max(JOIN_SHARE * path.length, JOIN_LEAST * scale.length), JOIN_MOST * scale.length)
    (start, off_start), (end, off_end) = (_foot(path, point) for point in (points[0], points[-1]))
    if off_start > reach:
        raise PathError(f"the stroke starts {off_start:.3g} m from the path; start it within {reach:.3g} m")
    arc = np.linspace(0.0, path.length, len(kept))
    if path.closed:
        if off_end > reach:
            raise PathError(f"the stroke ends {off_end:.3g} m from the closed path; end it within {reach:.3g} m")
        if (end - start) % path.length > 0.5 * path.length:
            start, end, points = end, start, points[::-1]
        beyond = (arc[:-1] - end) % path.length
        rest = kept[:-1][np.argsort(beyond, kind="stable")]
        rest = rest[np.sort(beyond) < (start - end) % path.length]
        return _like(path, np.concatenate([points, rest]), smoothing, scale, closed=True)
    if off_end > reach:
        ahead = path.direction > 0.0
        kept_part = kept[arc < start] if ahead else kept[arc > start][::-1]
        whole = np.concatenate([kept_part, points])
        return _like(path, whole if ahead else whole[::-1], smoothing, scale, closed=False)
    if start > end:
        start, end, points = end, start, points[::-1]
    return _like(path, np.concatenate([kept[arc < start], points, kept[arc > end]]), smoothing, scale, closed=False)


def bent(path: Path, grip: Floats, point: Floats, scale: Scale = USUAL_SCALE) -> Path:
    """Moves the point of the path nearest to `grip` (2,) [m] to `point` (2,) [m].

    The displacement decays to zero along the path on both sides, as the square of a cosine.

    Raises:
        PathError: there is no path, or it is an endless line.
    """
    kept = _knots(path)
    foot = _foot(path, grip)[0]
    shift = floats(point) - path_points(path, floats([foot]))[0]
    arc = np.linspace(0.0, path.length, len(kept))
    gap = np.abs(arc - foot)
    if path.closed:
        gap = np.minimum(gap, path.length - gap)
    width = min(max(_BEND_SHARE * path.length, _BEND_REACH * float(np.hypot(*shift))), 0.5 * path.length)
    give = np.cos(0.5 * math.pi * np.minimum(gap / width, 1.0)) ** 2
    return _like(path, kept + give[:, None] * shift, 0.0, scale, closed=path.closed)


def reclosed(path: Path, closed: bool, scale: Scale = USUAL_SCALE) -> Path:
    """Closes the path by joining its end to its start, or opens it at its start.

    Raises:
        PathError: there is no path, or it is an endless line.
    """
    return path if bool(path.closed) is closed else _like(path, _knots(path), 0.0, scale, closed=closed)


def _knots(path: Path) -> Floats:
    if path.kind == PathKind.NONE:
        raise PathError("there is no path to repair")
    if path.length == math.inf:
        raise PathError("an endless line cannot be repaired; draw a path")
    return path_points(path, np.linspace(0.0, path.length, SEGMENTS + 1))


def _foot(path: Path, point: Floats) -> tuple[float, float]:
    """Arc length of the path's point nearest to `point` (2,), and the distance between the two [m]."""
    x, y = float(point[0]), float(point[1])
    w, fx, fy, _, _ = nearest(path, 0.0, EVERYWHERE, x, y)
    return w, math.hypot(fx - x, fy - y)


def _like(path: Path, points: Floats, smoothing: float, scale: Scale, *, closed: bool) -> Path:
    new = sketch_path(points, smoothing, closed, path.direction, scale)
    return new._replace(ending=path.ending, pace=path.pace, duration=path.duration)
