"""Desired paths: closed forms, splines of strokes, nearest points that stay on their branch."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.control.guidance.paths import (
    EVERYWHERE,
    WINDOW,
    circle_path,
    ellipse_path,
    line_path,
    nearest,
    path_points,
    point_at,
    sketch_path,
    smoothing_error,
    start_parameter,
    travel_left,
)
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import PathError

TURN = np.linspace(0.0, 2.0 * np.pi, 401)
EIGHT = floats(np.stack([300.0 + 200.0 * np.sin(TURN), 300.0 + 100.0 * np.sin(2.0 * TURN)], axis=1))
WAVE = floats(np.stack([np.linspace(0, 600, 200), 60 * np.sin(np.linspace(0, 6, 200))], axis=1))


@pytest.mark.parametrize("path", [line_path(10, 20, 0.7), circle_path(50, 60, 80), sketch_path(WAVE, 2.0)])
def test_derivatives_of_a_path_agree_with_finite_differences(path: object) -> None:
    step = 1e-4
    for w in (5.0, 37.3, 121.9):
        _, _, dx, dy, ddx, ddy = point_at(path, w)  # pyright: ignore[reportArgumentType]
        after, before = point_at(path, w + step), point_at(path, w - step)  # pyright: ignore[reportArgumentType]
        assert ((after[0] - before[0]) / (2 * step), (after[1] - before[1]) / (2 * step)) == pytest.approx((dx, dy))
        assert (after[2] - before[2]) / (2 * step) == pytest.approx(ddx, abs=1e-6)
        assert (after[3] - before[3]) / (2 * step) == pytest.approx(ddy, abs=1e-6)


def test_a_sketch_is_parametrised_by_arc_length() -> None:
    path = sketch_path(WAVE, 2.0)
    speeds = [math.hypot(*point_at(path, w)[2:4]) for w in np.linspace(0, path.length, 500)]
    assert max(abs(np.array(speeds) - 1.0)) < 2e-3


def test_a_sketch_has_continuous_curvature_across_its_knots() -> None:
    path = sketch_path(WAVE, 2.0)
    for knot in range(1, 200, 7):
        w = knot * path.spacing
        assert point_at(path, w - 1e-9)[4:] == pytest.approx(point_at(path, w + 1e-9)[4:], abs=1e-9)


def test_a_sketch_keeps_both_ends_of_its_stroke() -> None:
    ends = path_points(path := sketch_path(WAVE, 4.0), floats([0.0, path.length]))
    assert np.abs(ends - WAVE[[0, -1]]).max() < 0.05


def test_a_sketch_stays_near_a_noisy_stroke() -> None:
    noisy = WAVE + np.random.default_rng(1).normal(0.0, 2.0, WAVE.shape)
    assert smoothing_error(sketch_path(floats(noisy), 2.0), WAVE) < 4.0


def test_a_stroke_that_returns_to_its_start_is_closed_smoothly() -> None:
    path = sketch_path(EIGHT[:-5], 2.0)
    assert path.closed
    assert point_at(path, 1e-9) == pytest.approx(point_at(path, path.length - 1e-9), abs=1e-6)


def test_the_nearest_point_stays_on_its_branch_where_a_figure_eight_crosses_itself() -> None:
    path = sketch_path(EIGHT, 1.0, closed=True)
    w, crossing = 0.0, 0
    for goal in np.linspace(0.0, 2.0 * path.length, 4000):
        x, y = point_at(path, goal)[:2]
        was, w = w, nearest(path, w, WINDOW, x, y)[0]
        assert (w - was) % path.length < 5.0
        crossing += math.hypot(x - 300.0, y - 300.0) < 1.0
    assert crossing > 10


def test_a_search_over_the_whole_path_finds_the_global_nearest_point() -> None:
    path = sketch_path(WAVE, 1.0)
    dense = path_points(path, floats(np.linspace(0, path.length, 20001)))
    for x, y in np.random.default_rng(2).uniform([-50, -150], [650, 150], (100, 2)):
        _, fx, fy, _, _ = nearest(path, 0.0, EVERYWHERE, x, y)
        assert math.hypot(fx - x, fy - y) <= np.hypot(*(dense - (x, y)).T).min() + 1e-3


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_the_nearest_point_of_a_circle_lies_on_the_ray_from_its_centre(x: float, y: float) -> None:
    _, fx, fy, tx, ty = nearest(circle_path(0.0, 0.0, 100.0), 0.0, EVERYWHERE, x, y)
    assert math.hypot(fx, fy) == pytest.approx(100.0)
    assert abs(fx * y - fy * x) < 1e-6 * (1.0 + math.hypot(x, y) * 100)
    assert (tx, ty) == pytest.approx((-fy / 100.0, fx / 100.0))


def test_an_ellipse_is_its_equation() -> None:
    points = path_points(path := ellipse_path(10, 20, 200, 80, 0.5), floats(np.linspace(0, path.length, 333)))
    across = (points - (10, 20)) @ np.array([[math.cos(0.5), -math.sin(0.5)], [math.sin(0.5), math.cos(0.5)]])
    assert np.abs((across[:, 0] / 200) ** 2 + (across[:, 1] / 80) ** 2 - 1.0).max() < 1e-5


def test_open_sketches_start_at_their_start_and_closed_ones_where_the_robot_is() -> None:
    open_path, circle = sketch_path(WAVE, 1.0), circle_path(0, 0, 100)
    assert start_parameter(open_path, 600.0, 0.0) == 0.0
    assert start_parameter(open_path._replace(direction=-1.0), 0.0, 0.0) == open_path.length
    assert start_parameter(circle, 0.0, 50.0) == pytest.approx(50.0 * math.pi)


def test_the_travel_left_counts_the_gap_and_the_way() -> None:
    path = sketch_path(floats([(0, 0), (50, 0), (100, 0)]), 0.0)
    assert travel_left(path, 40.0, 40.0, 30.0) == pytest.approx(90.0, abs=1e-6)
    assert travel_left(path._replace(direction=-1.0), 40.0, 40.0, 30.0) == pytest.approx(70.0, abs=1e-6)
    assert travel_left(circle_path(0, 0, 10), 1.0, 10.0, 0.0) == math.inf


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        ([], "3 distinct points; this one has 0"),
        ([(1, 1)] * 9, "3 distinct points; this one has 1"),
        ([(0, 0), (0, 0), (50, 0)], "3 distinct points; this one has 2"),
        ([(0, 0), (1, 0), (2, 0)], "at least 5 m long; this one is 2 m"),
        ([(0, 0), (math.nan, 0), (50, 0)], "point 2 of the stroke is not finite"),
    ],
)
def test_a_stroke_that_makes_no_path_is_refused_with_the_reason(points: Floats, reason: str) -> None:
    with pytest.raises(PathError, match=reason):
        sketch_path(floats(points, -1, 2), 4.0)


@given(st.lists(st.tuples(st.floats(0, 1200), st.floats(0, 700)), min_size=3, max_size=40))
def test_any_stroke_makes_a_finite_path_or_is_refused(points: list[tuple[float, float]]) -> None:
    try:
        path = sketch_path(floats(points, -1, 2), 4.0)
    except PathError:
        return
    assert np.isfinite(path.spline).all()
    assert 0.0 < path.length < math.inf
