"""Observed fire values against ray casting, target choice, robot intention."""

import math

import numpy as np
import pytest

from higvf_console.control.forms import Forms
from higvf_console.control.guidance.obstacles import capsule_table
from higvf_console.control.intention.perception import choose_target, fire_value, interval_room, robot_intention
from higvf_console.control.parameters import FireParameters, PerceptionParameters, SafetyParameters
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import NOBODY

NO_CIRCLES, NO_BARS = np.zeros((0, 3)), np.zeros((0, 5))
PERCEPTION, SAFETY, FIRES = PerceptionParameters(), SafetyParameters(), FireParameters()


def theta(
    robot: tuple[float, float], fire: tuple[float, float, float], circles: Floats = NO_CIRCLES, bars: Floats = NO_BARS,
    reach: float = math.inf,
) -> float:  # fmt: skip
    capsules = capsule_table(circles, bars)
    return fire_value(*robot, *fire, reach, capsules, interval_room(capsules))


def by_rays(robot: tuple[float, float], fire: tuple[float, float, float], circles: Floats, bars: Floats) -> float:
    """The visible angle by casting rays: a ray counts if it meets the fire and no occluder."""
    distance = math.hypot(fire[0] - robot[0], fire[1] - robot[1])
    half, bearing = math.asin(fire[2] / distance), math.atan2(fire[1] - robot[1], fire[0] - robot[0])
    rays = bearing + np.linspace(-half, half, 20001)
    direction = np.stack([np.cos(rays), np.sin(rays)], axis=1)
    discs = [tuple(c) for c in circles]
    for ax, ay, bx, by, r in bars:  # a capsule as many discs
        discs += [(ax + s * (bx - ax), ay + s * (by - ay), r) for s in np.linspace(0, 1, 2001)]
    seen = np.ones(len(rays), bool)
    for cx, cy, r in discs:
        offset = np.array([cx, cy]) - robot
        across = direction[:, 0] * offset[1] - direction[:, 1] * offset[0]
        seen &= ~((np.abs(across) <= r) & (direction @ offset > 0.0))
    return float(seen.mean() * 2.0 * half)


def test_an_unhidden_fire_is_seen_under_its_whole_angle() -> None:
    assert theta((0, 0), (100, 0, 50)) == pytest.approx(2.0 * math.asin(0.5))


def test_from_inside_a_fire_the_angle_is_half_a_turn() -> None:
    assert theta((90, 0), (100, 0, 50)) == pytest.approx(math.pi)
    assert theta((100, 0), (100, 0, 50)) == pytest.approx(math.pi)


def test_the_value_after_fire_1_is_that_of_table_1() -> None:
    obstacles = floats([(300, 200, 20), (670, 450, 20), (480, 400, 20), (150, 450, 20), (650, 140, 20)])
    hidden = math.degrees(theta((553, 250), (170, 120, 70), obstacles))
    assert hidden == pytest.approx(math.degrees(by_rays((553, 250), (170, 120, 70), obstacles, NO_BARS)), abs=0.02)
    assert hidden < math.degrees(theta((553, 250), (170, 120, 70)))


@pytest.mark.parametrize("seed", range(40))
def test_the_visible_angle_agrees_with_ray_casting_in_random_scenes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot, fire = (0.0, 0.0), (300.0, 20.0, 60.0)
    circles = np.column_stack([rng.uniform(40, 220, 3), rng.uniform(-60, 60, 3), rng.uniform(4, 25, 3)])
    ends = np.column_stack([rng.uniform(40, 220, 2), rng.uniform(-80, 80, 2)])
    bars = floats([[*ends[0], *ends[1], 5.0]])
    value = theta(robot, fire, floats(circles), bars)
    assert value == pytest.approx(by_rays(robot, fire, circles, bars), abs=2e-3)


def test_two_occluders_behind_each_other_hide_no_more_than_their_union() -> None:
    one, two = floats([(50, 0, 5)]), floats([(50, 0, 5), (100, 0, 10)])
    assert theta((0, 0), (200, 0, 60), two) == pytest.approx(theta((0, 0), (200, 0, 60), one), abs=1e-12)


def test_what_stands_behind_the_fire_or_the_robot_hides_nothing() -> None:
    behind = floats([(400, 0, 50), (-60, 0, 30)])
    assert theta((0, 0), (200, 0, 40), behind) == theta((0, 0), (200, 0, 40))


def test_a_bar_that_spans_the_fire_hides_it_whole() -> None:
    assert theta((0, 0), (200, 0, 30), bars=floats([(100, -60, 100, 60, 4)])) == 0.0


def test_a_bar_that_passes_behind_the_robot_hides_nothing_ahead() -> None:
    assert theta((0, 0), (200, 0, 30), bars=floats([(-30, -200, -30, 200, 4)])) == theta((0, 0), (200, 0, 30))


def test_beyond_the_perception_range_nothing_is_seen() -> None:
    assert theta((0, 0), (200, 0, 30), reach=169.0) == 0.0
    assert theta((0, 0), (200, 0, 30), reach=171.0) > 0.0


def test_another_fire_wins_only_by_the_margin() -> None:
    assert choose_target(floats([0.50, 0.52]), 0, 0.5, 1.05) == (0, 0.5)
    assert choose_target(floats([0.50, 0.53]), 0, 0.5, 1.05) == (1, 0.53)


def test_a_hidden_target_is_kept_with_its_largest_value_until_another_fire_is_visible() -> None:
    assert choose_target(floats([0.0, 0.0]), 1, 0.4, 1.05) == (1, 0.4)
    assert choose_target(floats([0.1, 0.0]), 1, 0.4, 1.05) == (0, 0.1)


def test_without_a_target_the_largest_visible_fire_is_chosen_or_none() -> None:
    assert choose_target(floats([0.1, 0.3]), NOBODY, 0.0, 1.05) == (1, 0.3)
    assert choose_target(floats([0.0, 0.0]), NOBODY, 0.0, 1.05) == (NOBODY, 0.0)


def test_the_robot_intention_points_at_the_fire_and_fades_at_the_hold_distance() -> None:
    hold = 30.0 + 0.5 * (SAFETY.obstacle_clearance + FIRES.stand_off)
    far = robot_intention(0, 0, 0.4, 300, 400, 30, PERCEPTION, SAFETY, FIRES, Forms())
    assert far == pytest.approx((0.24, 0.32))
    assert robot_intention(300 + hold, 400, 0.4, 300, 400, 30, PERCEPTION, SAFETY, FIRES, Forms()) == pytest.approx(
        (0.0, 0.0)
    )
    inside = robot_intention(300 + hold - 5, 400, 0.4, 300, 400, 30, PERCEPTION, SAFETY, FIRES, Forms())
    assert inside == pytest.approx((0.04, 0.0))
