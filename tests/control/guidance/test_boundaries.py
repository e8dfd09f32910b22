"""Boundaries: hulls of groups, clusters with growing fires, pockets and the way out of them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from higvf_console.control.guidance.boundaries import (
    ALONE,
    TOGETHER,
    boundary_at,
    convex_hull,
    find_boundaries,
    has_hull,
    opened,
    row_of,
)
from higvf_console.control.guidance.guiding import smoothed_gap, way_out
from higvf_console.core.arrays import floats
from higvf_console.core.state import NOBODY
from higvf_console.world.setup import Setup
from tests.teams import team

R_O = 12.0
U = floats([(500, 250), (640, 250), (640, 450), (500, 450), (500, 430), (620, 430), (620, 270), (500, 270)])


def boundaries_of(setup: Setup):
    return find_boundaries(setup.start.motion, setup.world, R_O)


@given(st.lists(st.tuples(st.floats(-90, 90), st.floats(-90, 90)), min_size=3, max_size=40, unique=True))
def test_the_hull_is_that_of_an_independent_library(points: list[tuple[float, float]]) -> None:
    cloud = floats(points)
    try:
        expected = ConvexHull(cloud)
    except Exception:  # flat: no area, and no hull to compare
        return
    hull = convex_hull(cloud)
    x, y = hull.T
    area = 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    assert area == pytest.approx(expected.volume, rel=1e-6, abs=1e-6)


def test_parts_are_one_group_exactly_when_no_robot_fits_between_them() -> None:
    for gap, groups in ((2 * R_O - 0.1, 1), (2 * R_O + 0.1, 2)):
        setup = team(circles=[(300, 300, 20), (300 + 40 + gap, 300, 20)])
        assert len(setup.world.boundary) == groups


def test_a_bar_between_two_circles_makes_all_three_one_group() -> None:
    world = team(circles=[(300, 300, 20), (440, 300, 20)], bars=[(340, 300, 400, 300, 5)]).world
    assert world.boundary_start[1].tolist() == [0, 3]
    assert sorted(world.part.tolist()) == [0, 1, 2]


def test_an_obstacle_inside_a_pocket_joins_its_group_since_the_hulls_overlap() -> None:
    assert len(team(circles=[(530, 350, 8)], polygons=[U]).world.boundary) == 1


def test_the_gap_to_a_hull_is_a_distance_whose_gradient_is_the_normal() -> None:
    boundaries = boundaries_of(team(polygons=[U]))
    for x, y in ((480.0, 350.0), (652.0, 300.0), (660.0, 470.0), (655.0, 240.0), (570.0, 350.0)):
        gap, nx, ny = boundary_at(boundaries, ALONE, 0, x, y)
        step = 1e-5
        slope_x = (boundary_at(boundaries, ALONE, 0, x + step, y)[0] - gap) / step
        slope_y = (boundary_at(boundaries, ALONE, 0, x, y + step)[0] - gap) / step
        assert (slope_x, slope_y) == pytest.approx((nx, ny), abs=1e-3)
    assert boundary_at(boundaries, ALONE, 0, 570.0, 350.0)[0] == pytest.approx(-70.0)
    assert boundary_at(boundaries, ALONE, 0, 640.0 + 3.0, 450.0 + 4.0)[0] == pytest.approx(5.0)


def test_a_hull_is_opened_for_a_goal_inside_and_for_no_other() -> None:
    boundaries = boundaries_of(team(polygons=[U]))
    assert opened(boundaries, ALONE, 0, 560.0, 350.0)
    assert not opened(boundaries, ALONE, 0, 700.0, 350.0)
    assert not opened(boundaries, ALONE, 0, math.nan, math.nan)


def test_a_fire_that_reaches_an_obstacle_shares_a_hull_with_it_but_for_the_robots_that_want_it() -> None:
    apart = boundaries_of(team(circles=[(300, 300, 20)], fires=[(400, 300, 50)]))
    assert apart.cluster.tolist() == [0, 1]
    boundaries = boundaries_of(team(circles=[(300, 300, 20)], fires=[(400, 300, 60)]))
    assert boundaries.cluster.tolist() == [0, 0]
    assert has_hull(boundaries, TOGETHER, 0)
    assert [row_of(boundaries, k, NOBODY, 900.0, 300.0) for k in (0, 1)] == [TOGETHER, NOBODY]
    assert [row_of(boundaries, k, 1, 400.0, 300.0) for k in (0, 1)] == [ALONE, NOBODY]
    gap, nx, ny = boundary_at(boundaries, TOGETHER, 0, 330.0, 400.0)
    assert 0.0 < gap < 62.0
    assert nx < 0.0 < ny


def test_the_way_out_leads_from_everywhere_in_a_pocket_through_its_opening() -> None:
    setup = team(polygons=[U])
    boundaries = boundaries_of(setup)
    for start in ((600.0, 350.0), (560.0, 410.0), (600.0, 300.0)):
        x, y = start
        for _ in range(400):
            if boundary_at(boundaries, ALONE, 0, x, y)[0] >= 0.0:
                break
            out_x, out_y = way_out(boundaries, ALONE, 0, x, y, setup.world)
            assert math.hypot(out_x, out_y) == pytest.approx(1.0)
            x, y = x + 0.5 * out_x, y + 0.5 * out_y
        assert x == pytest.approx(500.0, abs=1.0)
        assert 270.0 + R_O - 4.0 < y < 430.0 - R_O + 4.0


def test_a_convex_group_has_no_pocket() -> None:
    square = floats([(0, 0), (50, 0), (50, 50), (0, 50)])
    world = team(polygons=[square]).world
    assert world.boundary[0, 8] == 0
    assert len(world.pocket) == 0


def test_every_part_lies_within_its_groups_hull() -> None:
    world = team(circles=[(300, 300, 20), (350, 330, 15)], bars=[(380, 300, 420, 260, 6)]).world
    hull = world.hull
    for angle in np.linspace(0, 2 * np.pi, 64):
        direction = np.array([np.cos(angle), np.sin(angle)])
        reach = [c[:2] @ direction + c[2] for c in world.circles]
        reach += [max(b[:2] @ direction, b[2:4] @ direction) + b[4] for b in world.bars]
        assert (hull @ direction).max() >= max(reach) - 1e-9


def test_inside_a_hull_the_smoothed_gap_is_near_the_distance_and_its_slope_is_the_normal() -> None:
    world = team(polygons=[U]).world
    for x, y, distance in ((560.0, 350.0, 60.0), (600.0, 350.0, 20.0), (560.0, 300.0, 30.0), (530.0, 410.0, 20.0)):
        gap, nx, ny = smoothed_gap(0, x, y, world)
        assert gap == pytest.approx(distance, abs=world.boundary[0, 7])
        step = 1e-4
        slope = np.array([smoothed_gap(0, x + step, y, world)[0] - gap, smoothed_gap(0, x, y + step, world)[0] - gap])
        assert slope / np.hypot(*slope) == pytest.approx([nx, ny], abs=1e-3)
