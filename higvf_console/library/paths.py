"""Desired paths, [1], and their guiding vectors, [2]: lines, circles, ellipses and strokes, from Python."""

import math

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.guidance import paths
from higvf_console.control.guidance.field import FieldKind, field_at
from higvf_console.control.parameters import Parameters, PathParameters, defaults_at
from higvf_console.core.arguments import instance, number, one_of, positive
from higvf_console.core.arrays import FARTHEST, Floats, floats, given_floats
from higvf_console.core.commands import ShapePath
from higvf_console.core.errors import ArgumentError
from higvf_console.core.quantity import quantities
from higvf_console.core.scale import BODY_RADIUS, Scale
from higvf_console.core.state import Path, PathKind
from higvf_console.library.records import given_parameters, given_path
from higvf_console.library.setups import make_setup
from higvf_console.operator.path_commands import ENDINGS, FASTEST, SLOWEST, shaped
from higvf_console.runtime.compiling import announce


def line_path(
    at: ArrayLike, angle: float = 0.0, *, direction: int = 1, pace: float = 1.0, duration: float = math.inf
) -> Path:
    """The endless line through a point.

    Args:
        at: (2,) a point of it [m]; arc length counts from there.
        angle: from the x axis [rad].
        direction: gamma, 1 along `angle`, -1 against it.
        pace: share of their velocity that the robots take, 0.2 to 1.5.
        duration: how long it is followed at most [s].

    Raises:
        ArgumentError: an argument has another shape or type, or is out of range.
    """
    x, y = given_floats("at", at, (2,), most=FARTHEST).tolist()
    made = paths.line_path(x, y, number("angle", angle, -1e6, 1e6), _direction(direction))
    return _followed(made, "release", pace, duration)


def circle_path(
    at: ArrayLike, radius: float, *, direction: int = 1, pace: float = 1.0, duration: float = math.inf
) -> Path:
    """A circle, followed without end.

    Args:
        at: (2,) centre [m].
        radius: [m], above 0.
        direction: 1 counter-clockwise, -1 clockwise.
        pace: share of their velocity that the robots take, 0.2 to 1.5.
        duration: how long it is followed at most [s].

    Raises:
        ArgumentError: an argument has another shape or type, or is out of range.
    """
    x, y = given_floats("at", at, (2,), most=FARTHEST).tolist()
    made = paths.circle_path(x, y, positive("radius", radius, FARTHEST), _direction(direction))
    return _followed(made, "release", pace, duration)


def ellipse_path(
    at: ArrayLike, half_axes: ArrayLike, angle: float = 0.0, *, direction: int = 1, pace: float = 1.0,
    duration: float = math.inf,
) -> Path:  # fmt: skip
    """An ellipse, followed without end.

    Args:
        at: (2,) centre [m].
        half_axes: (2,) half axes a and b [m], above 0.
        angle: of the axis a from the x axis [rad].
        direction: 1 counter-clockwise, -1 clockwise.
        pace: share of their velocity that the robots take, 0.2 to 1.5.
        duration: how long it is followed at most [s].

    Raises:
        ArgumentError: an argument has another shape or type, or is out of range.
    """
    x, y = given_floats("at", at, (2,), most=FARTHEST).tolist()
    a, b = (
        positive(f"half_axes[{k}]", axis)
        for k, axis in enumerate(given_floats("half_axes", half_axes, (2,), most=FARTHEST))
    )
    made = paths.ellipse_path(x, y, a, b, number("angle", angle, -1e6, 1e6), _direction(direction))
    return _followed(made, "release", pace, duration)


def sketch_path(
    points: ArrayLike, smoothing: float | None = None, *, closed: bool | None = None, direction: int = 1,
    ending: str = "release", pace: float = 1.0, duration: float = math.inf, body_radius: float = BODY_RADIUS,
) -> Path:  # fmt: skip
    """The C2 path of a stroke, which may cross itself: resampled by arc length and smoothed, both ends kept.

    Args:
        points: (n, 2) the stroke [m]: at least three distinct points, and 5 m for a body of 12 m.
        smoothing: standard deviation by which the path may leave the points [m]; None = 4 m for a body of 12 m.
        closed: whether the path returns to its start; None = if the stroke nearly does.
        direction: 1 as drawn, -1 the other way round.
        ending: what happens at the end of an open path: "release" ends the human intention, "hold" lets the team wait
            there, "loop" starts again.
        pace: share of their velocity that the robots take, 0.2 to 1.5.
        duration: how long it is followed at most [s].
        body_radius: of the robots, which sets the scale [m].

    Raises:
        ArgumentError: an argument has another shape or type, or is out of range.
        PathError: the stroke has too few points or is too short.
    """
    stroke = given_floats("points", points, ("N", 2), most=FARTHEST)
    if closed is not None:
        closed = bool(instance("closed", closed, bool, np.bool_))
    scale = Scale(body_radius=positive("body_radius", body_radius))
    allowed = quantities(PathParameters)["stroke_smoothing"].at(scale)
    if smoothing is None:
        smoothing = defaults_at(scale).path.stroke_smoothing
    smoothing = number("smoothing", smoothing, allowed.low, allowed.high)
    made = paths.sketch_path(stroke, smoothing, closed, _direction(direction), scale)
    return _followed(made, ending, pace, duration)


def path_points(path: Path, arc_lengths: ArrayLike | None = None) -> Floats:
    """Points of a path, to draw it.

    Args:
        path: made by one of the functions above.
        arc_lengths: (n,) where [m]; None = 201 points from its start to its end.

    Returns:
        (n, 2) [m].

    Raises:
        ArgumentError: no path, or a line without `arc_lengths`.
    """
    given = _given_path(path)
    if arc_lengths is None:
        if given.length == math.inf:
            raise ArgumentError("arc_lengths is None; expected arc lengths [m], for a line has no end")
        arc_lengths = np.linspace(0.0, given.length, paths.SEGMENTS + 1)
    announce()
    return paths.path_points(given, given_floats("arc_lengths", arc_lengths, ("N",), most=FARTHEST))


def guiding_vectors(path: Path, points: ArrayLike, parameters: Parameters | None = None) -> Floats:
    """Unit guiding vectors of a path, [2]: along it near by, towards it from far away.

    X_hat = (gamma t - k e n) / sqrt(1 + (k e)^2), with t and n the tangent and normal at the path's nearest point, e
    the signed distance from it and 1/k the capture distance. Past the end of an open path they point back to the end.

    Args:
        path: made by one of the functions above.
        points: (G, 2) where [m].
        parameters: with `path.capture_distance`; None = the defaults.

    Returns:
        (G, 2) vectors of length 1.

    Raises:
        ArgumentError: an argument has another shape or type, or holds NaN or infinite values.
    """
    params = Parameters() if parameters is None else given_parameters(parameters)
    where = given_floats("points", points, ("G", 2), most=FARTHEST)
    given = _given_path(path)
    if not len(where):
        return floats([], 0, 2)
    setup = make_setup(where[:1], parameters=params, path=given)
    announce()
    field = field_at(FieldKind.PATH, where, setup.start, setup.world, setup.params)
    return field / np.hypot(*field.T)[:, None]


def _given_path(path: object) -> Path:
    given = given_path(path)
    if given.kind == PathKind.NONE:
        raise ArgumentError("path is NO_PATH; expected a path")
    return given


def _direction(direction: object) -> float:
    found = number("direction", direction)
    if found not in (1.0, -1.0):
        raise ArgumentError(f"direction is {found:g}; expected 1 or -1")
    return found


def _followed(path: Path, ending: object, pace: object, duration: object) -> Path:
    """The path with its terms, each of them checked."""
    end = one_of("ending", ending, tuple(ENDINGS))
    share, seconds = number("pace", pace, SLOWEST, FASTEST), number("duration", duration)
    if not seconds > 0.0:
        raise ArgumentError(f"duration is {seconds:g} s; expected a time above 0 s")
    return shaped(path, ShapePath(ending=end, pace=share))._replace(duration=seconds)
