"""Whom an edit crowds: who stood clear before, and who stands nearer than before."""

import numpy as np
import pytest

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import floats, ints
from higvf_console.core.state import Motion
from higvf_console.world.editing.safe_places import clear_of, crowded, newly_crowded, robot_fits
from higvf_console.world.layout import Layout
from higvf_console.world.obstacles import Obstacles
from tests.teams import team

R_O, R_R = Parameters().safety.obstacle_clearance, Parameters().safety.robot_clearance
NOISE = 0.5  # [m]
ALL = ints([0, 1])


def scene(gap: float, apart: float = 500.0, noise: float = 0.0) -> tuple[Layout, Motion]:
    """Two robots `apart` [m], the first of them in a `gap` [m] from a circle."""
    params = Parameters()
    params = params._replace(robots=params.robots._replace(position_noise=noise))
    setup = team(((200.0, 350.0), (900.0, 350.0)), params=params)
    circle = floats([[200.0, 350.0 + gap + 20.0, 20.0]])
    layout = setup.layout._replace(obstacles=Obstacles(circle, floats([], 0, 5), ()))
    return layout, setup.start.motion._replace(position=floats([[200.0, 350.0], [200.0 + apart, 350.0]]))


def test_who_stood_clear_and_does_not_any_more_is_crowded() -> None:
    assert newly_crowded(scene(R_O + 1.0), scene(R_O - 1.0), ALL) == [0]
    assert newly_crowded(scene(50.0, R_R + 1.0), scene(50.0, R_R - 1.0), ALL) == [0, 1]


def test_nobody_is_crowded_at_a_clearance_or_by_a_rounding() -> None:
    for short in (0.0, 1e-9):
        assert newly_crowded(scene(50.0), scene(R_O - short, R_R - short), ALL) == []


@pytest.mark.parametrize("closer", [0.0, -1.0])
def test_who_stood_too_near_and_stands_no_nearer_is_not_newly_crowded(closer: float) -> None:
    assert newly_crowded(scene(R_O - 3.0), scene(R_O - 3.0 - closer), ALL) == []
    assert newly_crowded(scene(50.0, R_R - 3.0), scene(50.0, R_R - 3.0 - closer), ALL) == []


def test_who_stood_too_near_and_is_brought_nearer_is_newly_crowded() -> None:
    assert newly_crowded(scene(R_O - 3.0), scene(R_O - 3.1), ALL) == [0]
    assert newly_crowded(scene(50.0, R_R - 3.0), scene(50.0, R_R - 3.1), ALL) == [0, 1]


def test_what_is_missed_to_one_thing_is_no_licence_beyond_it_to_another() -> None:
    assert newly_crowded(scene(R_O - 3.0), scene(50.0, R_R - 4.0), ALL) == [0, 1]
    assert newly_crowded(scene(R_O - 3.0), scene(50.0, R_R - 2.0), ALL) == [1]


def test_the_margin_for_errors_may_be_missed_by_who_missed_it_and_the_clearance_not() -> None:
    """Who has come nearer than the enlarged clearance may stay there, but nothing takes the bare one."""
    before = scene(R_O + 0.3, noise=NOISE)
    assert crowded(*before) == [0]
    assert newly_crowded(before, scene(R_O + 0.1, noise=NOISE), ALL) == []
    assert newly_crowded(before, scene(R_O - 0.1, noise=NOISE), ALL) == [0]
    pair = scene(50.0, R_R + 0.6, noise=NOISE)
    assert newly_crowded(pair, scene(50.0, R_R + 0.1, noise=NOISE), ALL) == []
    assert newly_crowded(pair, scene(50.0, R_R - 0.1, noise=NOISE), ALL) == [0, 1]


def test_a_robot_is_known_by_its_row_before_and_a_new_one_was_nowhere() -> None:
    near = scene(R_O - 3.0)
    layout, motion = near
    swapped = layout, motion._replace(position=floats(motion.position[::-1].copy(), -1, 2))
    assert newly_crowded(near, swapped, ints([1, 0])) == []
    assert newly_crowded(near, swapped, ALL) == [1]
    assert newly_crowded(near, near, ints([-1, 1])) == [0]


def test_a_lone_robot_has_nobody_near() -> None:
    def alone(gap: float) -> tuple[Layout, Motion]:
        layout, motion = scene(gap)
        return layout, motion._replace(position=floats(motion.position[:1], -1, 2))

    assert newly_crowded(alone(R_O - 1.0), alone(R_O - 1.0), ints([0])) == []
    assert newly_crowded(alone(R_O - 1.0), alone(R_O - 2.0), ints([0])) == [0]


def test_a_place_fits_at_the_clearances_and_not_nearer() -> None:
    layout, motion = scene(50.0)
    x, y = motion.position[1].tolist()
    rest = floats([[x - R_R - 1e-3, y], [x - R_R + 1e-3, y]])
    assert robot_fits(0, layout, motion)(rest).tolist() == [True, False]
    circle = layout.obstacles.circles[0, :2]
    beside = floats([circle - [20.0 + R_O + spare, 0.0] for spare in (1e-3, -1e-3)])
    assert clear_of(layout, motion, 0.0)(beside).tolist() == [True, False]
    assert not np.any(clear_of(layout, motion, 2e-3)(beside))
