"""Desired paths, [1]: lines, circles and C2 splines (ellipses, sketches), parametrised by arc length w.

A path is the zero level set of a signed distance e, positive to the right of increasing w. Splines may intersect
themselves: the search for the nearest point is limited to a window around the last w, so that w never jumps between
branches.
"""
# SciPy's splines have no types.
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

import math
from collections.abc import Callable

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import PathError
from higvf_console.core.scale import USUAL_SCALE, Scale
from higvf_console.core.state import NO_PATH, Path, PathKind

SEGMENTS = 200  # of a spline path
SHORTEST_PATH = 5.0  # at the usual scale [m]
WINDOW = 5.0  # half width of the search for the nearest point [body radii]
EVERYWHERE = math.inf  # searches the whole path
_ENDS_PINNED = 1e3  # weight of both ends of a stroke, which a smoothing spline would miss otherwise


def line_path(x: float, y: float, angle: float, direction: float = 1.0) -> Path:
    """The line through (x, y) [m] at `angle` [rad]; w = 0 at (x, y)."""
    return _path(PathKind.LINE, math.inf, False, direction, shape=floats([x, y, math.cos(angle), math.sin(angle)]))


def circle_path(x: float, y: float, radius: float, direction: float = 1.0) -> Path:
    """The circle of `radius` [m] round (x, y), counter-clockwise for direction +1; w = 0 at angle 0.

    Raises:
        PathError: the radius is not positive.
    """
    if not radius > 0.0:
        raise PathError(f"a circle's radius must be positive, not {radius} m")
    return _path(PathKind.CIRCLE, 2.0 * math.pi * radius, True, direction, shape=floats([x, y, radius, 0.0]))


def ellipse_path(x: float, y: float, a: float, b: float, angle: float = 0.0, direction: float = 1.0) -> Path:
    """The ellipse with half axes a, b [m] round (x, y), its a-axis at `angle` [rad], counter-clockwise for +1.

    A periodic spline through 4 x 200 exact points represents it, to within 1e-5 of its size.

    Raises:
        PathError: a half axis is not positive.
    """
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 (slow to import)

    if not (a > 0.0 and b > 0.0):
        raise PathError(f"an ellipse's half axes must be positive, not {a} m and {b} m")
    turn = np.linspace(0.0, 2.0 * math.pi, 4 * SEGMENTS + 1)
    across, along = a * np.cos(turn), b * np.sin(turn)
    cos, sin = math.cos(angle), math.sin(angle)
    points = np.stack([x + cos * across - sin * along, y + sin * across + cos * along], axis=1)
    points[-1] = points[0]
    return _by_arc_length(CubicSpline(turn, points, bc_type="periodic"), turn[-1], closed=True, direction=direction)


def sketch_path(
    points: Floats, smoothing: float, closed: bool | None = None, direction: float = 1.0, scale: Scale = USUAL_SCALE
) -> Path:
    """The C2 path of a stroke: without duplicates, resampled by arc length, smoothed, with both ends kept.

    Args:
        points: (n, 2) stroke [m].
        smoothing: standard deviation by which the path may leave the points [m].
        closed: whether the path returns to its start; None closes it if the ends of the stroke are near.
        direction: +1 follows the stroke as drawn.
        scale: of the team.

    Raises:
        PathError: the stroke is not finite, has fewer than 3 distinct points, or is shorter than `SHORTEST_PATH` at the
            scale.
    """
    from scipy.interpolate import make_splprep  # noqa: PLC0415

    stroke = distinct(points)
    if len(stroke) < 3:
        raise PathError(f"a stroke needs at least 3 distinct points; this one has {len(stroke)}")
    length = float(np.hypot(*np.diff(stroke, axis=0).T).sum())
    shortest = SHORTEST_PATH * scale.length
    if length < shortest:
        raise PathError(f"a stroke must be at least {shortest:.3g} m long; this one is {length:.3g} m")
    if closed is None:
        closed = float(np.hypot(*(stroke[-1] - stroke[0]))) < 0.08 * length
    if closed:
        stroke = distinct(np.vstack([stroke, stroke[:1]]))
    even = resampled(stroke, SEGMENTS, scale.length)
    arc = np.linspace(0.0, 1.0, len(even))
    if closed:
        even[-1] = even[0]
    exact = smoothing == 0.0  # make_splprep then takes no weights
    weight = np.ones(len(even))
    weight[[0, -1]] = 1.0 if closed else _ENDS_PINNED
    spline, _ = make_splprep(
        even.T,
        u=arc,
        w=None if exact else weight,
        k=3,
        s=len(even) * smoothing**2,  # pyright: ignore[reportArgumentType] (scipy infers int from the default)
        bc_type="periodic" if closed else None,
    )
    return _by_arc_length(lambda u: floats(spline(u).T), 1.0, closed, direction)


def distinct(points: Floats) -> Floats:
    """The stroke (n, 2) without points that repeat their predecessor.

    Raises:
        PathError: a point is not finite.
    """
    stroke = floats(points, -1, 2)
    if not np.isfinite(stroke).all():
        raise PathError(f"point {int(np.argmin(np.isfinite(stroke).all(axis=1))) + 1} of the stroke is not finite")
    if len(stroke) < 2:
        return stroke
    moved = np.hypot(*np.diff(stroke, axis=0).T) > 1e-6
    return stroke[np.concatenate([[True], moved])]


def resampled(points: Floats, most: int, apart: float) -> Floats:
    """Resamples a polyline (n, 2) at equal arc length: at most `most` + 1 points, about so far `apart` [m] if short."""
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    count = int(min(most, max(8, round(arc[-1] / apart)))) + 1
    even = np.linspace(0.0, arc[-1], count)
    return np.stack([np.interp(even, arc, points[:, 0]), np.interp(even, arc, points[:, 1])], axis=1)


def smoothing_error(path: Path, points: Floats) -> float:
    """Largest distance of the stroke points (n, 2) from the path fitted to them [m]."""
    return max(math.dist(p, nearest(path, 0.0, EVERYWHERE, p[0], p[1])[1:3]) for p in floats(points, -1, 2))


def path_points(path: Path, arc: Floats) -> Floats:
    """Points (n, 2) [m] at arc lengths (n,) [m]."""
    return floats([point_at(path, w)[:2] for w in arc], -1, 2)


def _by_arc_length(curve: Callable[[Floats], Floats], end: float, closed: bool, direction: float) -> Path:
    """The C2 spline with segments of equal arc length through a curve (m,) -> (m, 2) over [0, end]."""
    from scipy.interpolate import CubicSpline  # noqa: PLC0415

    fine = np.linspace(0.0, end, 10 * SEGMENTS + 1)
    dense = np.asarray(curve(fine))
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(dense, axis=0).T))])
    length = float(arc[-1])
    knots = np.linspace(0.0, length, SEGMENTS + 1)
    through = np.asarray(curve(np.interp(knots, arc, fine)))
    if closed:
        through[-1] = through[0]
    cubic = CubicSpline(knots, through, bc_type="periodic" if closed else "natural")
    coefficients = floats(np.moveaxis(cubic.c[::-1], 0, 2).reshape(SEGMENTS, 8))
    return _path(PathKind.SPLINE, length, closed, direction, spline=coefficients, spacing=length / SEGMENTS)


def _path(
    kind: PathKind, length: float, closed: bool, direction: float, *, shape: Floats = NO_PATH.shape,
    spline: Floats = NO_PATH.spline, spacing: float = 1.0,
) -> Path:  # fmt: skip
    """A path with the types that kernels are compiled for, and default ending, pace and duration."""
    return NO_PATH._replace(
        kind=int(kind), shape=shape, spline=spline, spacing=spacing, length=length, closed=bool(closed),
        direction=float(direction),
    )  # fmt: skip


@kernel
def point_at(path: Path, w: float) -> tuple[float, float, float, float, float, float]:
    """Point, first and second derivative by arc length at w: (x, y, x', y', x'', y'')."""
    if path.kind == PathKind.LINE:
        x, y, cos, sin = path.shape
        return x + w * cos, y + w * sin, cos, sin, 0.0, 0.0
    if path.kind == PathKind.CIRCLE:
        x, y, radius, _ = path.shape
        cos, sin = math.cos(w / radius), math.sin(w / radius)
        return x + radius * cos, y + radius * sin, -sin, cos, -cos / radius, -sin / radius
    if path.closed:
        w = w % path.length
    segment = min(max(int(w / path.spacing), 0), path.spline.shape[0] - 1)
    s = w - segment * path.spacing
    a, b, c, d, e, f, g, h = path.spline[segment]
    return (
        a + s * (b + s * (c + s * d)),
        e + s * (f + s * (g + s * h)),
        b + s * (2.0 * c + s * 3.0 * d),
        f + s * (2.0 * g + s * 3.0 * h),
        2.0 * c + 6.0 * d * s,
        2.0 * g + 6.0 * h * s,
    )


@kernel
def nearest(path: Path, w: float, window: float, x: float, y: float) -> tuple[float, float, float, float, float]:
    """The path's point nearest to (x, y) within `window` of w: its arc length, position and unit tangent."""
    if path.kind == PathKind.LINE:
        w = (x - path.shape[0]) * path.shape[2] + (y - path.shape[1]) * path.shape[3]
    elif path.kind == PathKind.CIRCLE:
        w = (math.atan2(y - path.shape[1], x - path.shape[0]) % (2.0 * math.pi)) * path.shape[2]
    else:
        w = _nearest_on_spline(path, w, window, x, y)
    fx, fy, tx, ty, _, _ = point_at(path, w)
    speed = math.hypot(tx, ty)
    return w, fx, fy, tx / speed, ty / speed


@kernel
def _nearest_on_spline(path: Path, w: float, window: float, x: float, y: float) -> float:
    """Best knot in the window, then Newton steps on the squared distance, kept within one segment of that knot."""
    knots = path.spline.shape[0]
    reach = math.ceil(min(window, path.length) / path.spacing)
    centre = round(w / path.spacing)
    best, least = w, math.inf
    for knot in range(centre - reach, centre + reach + 1):
        if not path.closed and (knot < 0 or knot > knots):
            continue
        fx, fy, _, _, _, _ = point_at(path, knot * path.spacing)
        gap = (fx - x) ** 2 + (fy - y) ** 2
        if gap < least:
            best, least = knot * path.spacing, gap
    refined = best
    for _ in range(4):
        fx, fy, dx, dy, ddx, ddy = point_at(path, refined)
        slope = (fx - x) * dx + (fy - y) * dy
        curve = dx * dx + dy * dy + (fx - x) * ddx + (fy - y) * ddy
        if curve <= 0.0:
            break
        refined = min(max(refined - slope / curve, best - path.spacing), best + path.spacing)
        if not path.closed:
            refined = min(max(refined, 0.0), path.length)
    fx, fy, _, _, _, _ = point_at(path, refined)
    if (fx - x) ** 2 + (fy - y) ** 2 > least:
        refined = best
    return refined % path.length if path.closed else refined


@kernel
def start_parameter(path: Path, x: float, y: float) -> float:
    """Arc length [m] at which a robot at (x, y) joins: the start of an open sketch, else the nearest point."""
    if path.kind == PathKind.SPLINE and not path.closed:
        return 0.0 if path.direction > 0.0 else path.length
    return nearest(path, 0.0, math.inf, x, y)[0]


@kernel
def travel_left(path: Path, w: float, x: float, y: float) -> float:
    """Remaining travel from (x, y) to the end of an open path: the rest beyond w plus the gap [m]; inf if endless."""
    if path.kind != PathKind.SPLINE or path.closed:
        return math.inf
    fx, fy, _, _, _, _ = point_at(path, w)
    along = path.length - w if path.direction > 0.0 else w
    return along + math.hypot(x - fx, y - fy)
