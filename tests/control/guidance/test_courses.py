"""Courses of moving obstacles: where they lead, and what of them a tick of the kernels sees."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.control.guidance.boundaries import ALONE, TOGETHER, boundary_at, find_boundaries, has_hull
from higvf_console.control.guidance.obstacles import world_at
from higvf_console.world.obstacles import course_along, course_straight
from tests.moving import mover_at, moving_circle

SQUARE = [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]
PERIOD = 0.02
R_O = 12.0


@given(st.floats(0.0, 1e4), st.booleans())
def test_a_course_is_travelled_at_its_speed(time: float, loop: bool) -> None:
    course = course_along(SQUARE, 7.0, loop)
    step = 1e-3
    way = np.hypot(*(course.offset(time + step) - course.offset(time)))
    assert way <= 7.0 * step + 1e-9
    if loop or time < 300.0 / 7.0 - step:
        assert way >= 7.0 * step / np.sqrt(2.0) - 1e-9  # less across a corner


def test_a_course_that_does_not_loop_stops_at_its_end() -> None:
    course = course_along(SQUARE, 10.0, loop=False)
    assert course.offset(0.0).tolist() == [0.0, 0.0]
    assert course.offset(15.0) == pytest.approx([100.0, 50.0])
    assert course.offset(1e6).tolist() == [0.0, 100.0]


def test_a_loop_goes_straight_back_to_its_start_and_on() -> None:
    course = course_along(SQUARE, 10.0, loop=True)
    assert course.offset(35.0) == pytest.approx([0.0, 50.0])
    assert course.offset(40.0 * 25 + 5.0) == pytest.approx([50.0, 0.0])


def test_a_velocity_leads_straight_on_for_ever() -> None:
    assert course_straight(-3.0, 4.0).offset(1000.0) == pytest.approx([-3000.0, 4000.0])


def test_a_path_that_stays_in_one_place_is_no_course() -> None:
    with pytest.raises(ValueError, match="one place"):
        course_along([(1.0, 2.0), (1.0, 2.0)], 5.0, loop=True)


@given(st.floats(0.0, 100.0), st.floats(0.0, 20.0), st.floats(0.0, 50.0))
def test_another_speed_leaves_a_moving_obstacle_where_it_is(time: float, speed: float, was: float) -> None:
    for course in (course_along(SQUARE, was, loop=False), course_along(SQUARE, was, loop=True)):
        assert course.paced(speed, time).offset(time) == pytest.approx(course.offset(time), abs=1e-6)
        assert course.paced(speed, time).speed == speed


def test_the_velocity_of_a_tick_is_the_displacement_over_its_period_across_corners_too() -> None:
    setup = moving_circle(course_along([(300.0, 300.0), (300.5, 300.0), (300.5, 400.0)], 40.0, loop=False))
    for tick in range(200):
        now, later = (world_at(setup.world, t, PERIOD) for t in (tick, tick + 1))
        step = (later.capsules[0, :2] - now.capsules[0, :2]) / PERIOD
        assert now.capsule_velocity[0] == pytest.approx(step, abs=1e-9)


def test_the_world_of_a_tick_does_not_depend_on_the_tick_that_it_is_made_from() -> None:
    world = moving_circle(course_along(SQUARE, 33.0, loop=True)).world
    for tick in (0, 1, 977):
        direct, round_about = world_at(world, tick, PERIOD), world_at(world_at(world, 55, PERIOD), tick, PERIOD)
        assert direct.capsules.tobytes() == round_about.capsules.tobytes()
        assert direct.capsule_velocity.tobytes() == round_about.capsule_velocity.tobytes()


def test_a_moving_obstacle_has_a_boundary_of_its_own_that_goes_with_it() -> None:
    setup = moving_circle(
        course_along([(300.0, 300.0), (700.0, 300.0)], 50.0, loop=False), still=[(500.0, 300.0, 30.0)]
    )
    assert len(setup.world.boundary) == 1
    for tick, x in ((0, 300.0), (100, 400.0)):
        found = find_boundaries(setup.start.motion, world_at(setup.world, tick, PERIOD), R_O)
        assert found.capsule.shape == (2, 5)
        assert boundary_at(found, ALONE, 1, x + 45.0, 300.0)[0] == pytest.approx(25.0)


@pytest.mark.parametrize("bar", [False, True])
def test_a_moving_obstacle_joins_the_boundary_that_it_leaves_no_way_beside(bar: bool) -> None:
    setup = mover_at((300.0, 300.0), (480.0, 300.0), bar=bar, still=[(520.0, 300.0, 20.0)])
    joined = []
    for tick in range(0, 500, 10):
        world = world_at(setup.world, tick, PERIOD)
        found = find_boundaries(setup.start.motion, world, R_O)
        x, radius = world.capsules[1, 0], world.capsules[1, 4]
        together = bool(has_hull(found, TOGETHER, 0))
        assert together == (abs(520.0 - x) - 20.0 - radius < 2.0 * R_O)
        joined.append(together)
    assert any(joined)
    assert not all(joined)
