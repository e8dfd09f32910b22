"""The guiding and the composite vector field: limits, level sets, circulation in one direction."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.control.forms import Forms
from higvf_console.control.guidance.boundaries import find_boundaries
from higvf_console.control.guidance.bump import zero_in
from higvf_console.control.guidance.guiding import agree_circulation, composite_velocity, guiding_vector
from higvf_console.control.guidance.paths import EVERYWHERE, circle_path, line_path, sketch_path
from higvf_console.control.parameters import BoundaryParameters, PathParameters
from higvf_console.core.arrays import Ints, bools, floats, ints
from higvf_console.core.state import NOBODY
from tests.teams import team

PATH_PARAMETERS, BOUNDARIES = PathParameters(), BoundaryParameters()
SETUP = team(circles=[(0.0, 0.0, 50.0)])
WORLD, DISC = SETUP.world, find_boundaries(SETUP.start.motion, SETUP.world, 12.0)  # one boundary round the origin
NOWHERE = (math.nan, math.nan)  # bound for nowhere


def test_on_the_path_the_field_is_its_tangent_and_far_away_it_points_at_the_path() -> None:
    line = line_path(0.0, 0.0, 0.0)
    assert guiding_vector(line, 0.0, EVERYWHERE, 7.0, 0.0, PATH_PARAMETERS) == pytest.approx((1.0, 0.0))
    assert guiding_vector(line, 0.0, EVERYWHERE, 0.0, 1e6, PATH_PARAMETERS) == pytest.approx((0.0, -1.0), abs=1e-4)


def test_at_the_capture_distance_the_field_turns_45_degrees() -> None:
    vx, vy = guiding_vector(
        line_path(0, 0, 0.0), 0.0, EVERYWHERE, 0.0, PATH_PARAMETERS.capture_distance, PATH_PARAMETERS
    )
    assert math.degrees(math.atan2(vy, vx)) == pytest.approx(-45.0)


def test_a_reversed_path_is_followed_against_its_tangent() -> None:
    circle = circle_path(0, 0, 100, direction=-1.0)
    assert guiding_vector(circle, 0.0, EVERYWHERE, 100.0, 0.0, PATH_PARAMETERS) == pytest.approx((0.0, -1.0))


def test_past_its_end_an_open_path_calls_back() -> None:
    path = sketch_path(floats([(0, 0), (50, 0), (100, 0)]), 0.0)
    assert guiding_vector(path, 100.0, EVERYWHERE, 130.0, 0.0, PATH_PARAMETERS) == pytest.approx((-1.0, 0.0), abs=1e-6)


@given(st.floats(-400, 400), st.floats(-400, 400))
def test_the_field_is_a_unit_vector_everywhere_the_centre_included(x: float, y: float) -> None:
    for px, py in ((x, y), (0.0, 0.0)):
        assert math.hypot(
            *guiding_vector(circle_path(0, 0, 100), 0.0, EVERYWHERE, px, py, PATH_PARAMETERS)
        ) == pytest.approx(1.0)


def test_following_the_field_leads_to_the_circle() -> None:
    x, y = 5.0, 1.0
    for _ in range(4000):
        vx, vy = guiding_vector(circle_path(0, 0, 100), 0.0, EVERYWHERE, x, y, PATH_PARAMETERS)
        x, y = x + 0.2 * vx, y + 0.2 * vy
    assert math.hypot(x, y) == pytest.approx(100.0, abs=0.05)


def test_the_bump_is_zero_inside_q_one_outside_r_and_rises_between() -> None:
    radii = np.linspace(50.0, 80.0, 301)
    bump = np.array([zero_in(d, 50.0, BOUNDARIES, Forms()) for d in radii])
    assert (bump[radii <= 64.0] == 0.0).all()
    assert (bump[radii >= 75.0] == 1.0).all()
    assert (np.diff(bump) >= 0.0).all()
    assert 0.05 < zero_in(69.5, 50.0, BOUNDARIES, Forms()) < 0.95


def test_the_bump_has_no_overflow_next_to_its_boundaries() -> None:
    edges = [64.0, 75.0]
    bumps = [zero_in(math.nextafter(e, to), 50.0, BOUNDARIES, Forms()) for e in edges for to in (0.0, 100.0)]
    assert all(0.0 <= b <= 1.0 for b in bumps)


def composite(vx: float, vy: float, x: float, y: float, circulation: int, own: int = NOBODY) -> tuple[float, float]:
    return composite_velocity(vx, vy, x, y, 0, ints([[circulation]]), own, *NOWHERE, DISC, WORLD, BOUNDARIES, Forms())


def test_outside_every_boundary_the_velocity_passes_bit_for_bit() -> None:
    assert composite(3.1, -0.7, 200.0, 10.0, 1) == (3.1, -0.7)


def test_a_robot_that_heads_out_of_a_boundary_is_left_alone() -> None:
    assert composite(5.0, 1.0, 66.0, 0.0, 1) == (5.0, 1.0)


@pytest.mark.parametrize("circulation", [1, -1, 2, -2])
def test_at_the_repulsive_boundary_the_robot_circulates_in_the_agreed_direction_at_full_speed(circulation: int) -> None:
    vx, vy = composite(-9.0, 0.5, 64.0, 0.0, circulation)
    assert vx == pytest.approx(0.0)
    assert vy == pytest.approx(math.copysign(math.hypot(9.0, 0.5), circulation))


@pytest.mark.parametrize("bearing", [0.3, 1.7, 3.0, -2.0])
def test_the_circulation_is_counter_clockwise_for_plus_from_every_bearing(bearing: float) -> None:
    cos, sin = math.cos(bearing), math.sin(bearing)
    assert composite(-9.0 * cos, -9.0 * sin, 64.0 * cos, 64.0 * sin, 1) == pytest.approx((-9.0 * sin, 9.0 * cos))


def test_a_robots_own_fire_is_no_obstacle_to_it() -> None:
    assert composite(-9.0, 0.5, 64.0, 0.0, 1, own=0) == (-9.0, 0.5)


def agreed_directions(
    positions: list[tuple[float, float]], velocities: list[tuple[float, float]], influenced: int, before: Ints
) -> Ints:
    one, nobody = np.zeros(len(positions), np.int64), np.zeros(len(positions), np.bool_)
    return agree_circulation(floats(velocities), floats(positions), before, one, influenced, nobody, DISC, BOUNDARIES)


def test_the_first_robot_that_heads_inward_sets_the_direction_for_its_whole_component() -> None:
    agreed = agreed_directions([(70, 0), (70, 10)], [(-5, 1), (-5, -9)], NOBODY, ints([[0], [0]]))
    assert agreed.tolist() == [[1], [1]]


def test_the_influenced_robot_sets_the_direction_anew_once() -> None:
    agreed = agreed_directions([(70, 0), (70, 10)], [(-5, 1), (-5, -9)], 1, ints([[1], [1]]))
    assert agreed.tolist() == [[-2], [-2]]
    assert agreed_directions([(70, 0), (70, 10)], [(-5, 1), (-5, 9)], 1, agreed).tolist() == [[-2], [-2]]


def test_the_direction_is_cleared_when_nobody_is_inside_the_boundary() -> None:
    assert agreed_directions([(90, 0), (90, 10)], [(-5, 1), (-5, 1)], 1, ints([[2], [2]])).tolist() == [[0], [0]]


def test_components_agree_apart() -> None:
    position, velocity = floats([(70, 0), (-70, 0)]), floats([(-5, 1), (5, 1)])
    agreed = agree_circulation(
        velocity, position, ints([[0], [0]]), ints([0, 1]), NOBODY, bools([False, False]), DISC, BOUNDARIES
    )
    assert agreed.tolist() == [[1], [-1]]
