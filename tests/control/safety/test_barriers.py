"""Barriers: derivatives by finite differences, activation distances by their definition, the certificate's numbers."""

import math

import numpy as np
import pytest

from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.arena import wall_constraint
from higvf_console.control.safety.barriers.capsule import (
    capsule_activation_distance,
    capsule_constraint,
    capsule_outruns,
)
from higvf_console.control.safety.barriers.linear_constraint import class_k
from higvf_console.control.safety.barriers.robot_pair import pair_constraint, sensing_radius
from higvf_console.control.safety.barriers.sampling import check_sampling, least_stand_off, sampling_conditions
from higvf_console.control.safety.barriers.speed_limit import clipped
from higvf_console.control.safety.hazards import VX, VY, hazards_of
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import FilterError
from higvf_console.world.polygons import segment_distance

SAFETY = SafetyParameters()
POINTS = np.random.default_rng(5).uniform(-90.0, 90.0, (200, 2))


def circle_constraint(
    x: float, y: float, ox: float, oy: float, radius: float, growth: float = 0.0, safety: SafetyParameters = SAFETY
) -> tuple[float, float, float]:
    """The constraint of a circle that stands still."""
    return capsule_constraint(x, y, ox, oy, ox, oy, radius, 0.0, 0.0, growth, safety)


def bar_constraint(
    x: float, y: float, a: tuple[float, float], b: tuple[float, float], half_width: float
) -> tuple[float, float, float]:
    """The constraint of a bar that stands still."""
    return capsule_constraint(x, y, *a, *b, half_width, 0.0, 0.0, 0.0, SAFETY)


@pytest.mark.parametrize(("x", "y"), POINTS[:60])
def test_a_velocity_on_the_constraint_of_a_circle_makes_h_fall_at_the_rate_of_the_barrier(x: float, y: float) -> None:
    ax, ay, b = circle_constraint(x, y, 5.0, -3.0, 20.0)
    clearance, step = 32.0, 1e-6

    def h(time: float) -> float:
        return math.dist((x + ax * b * time, y + ay * b * time), (5.0, -3.0)) ** 2 / clearance**2 - 1.0

    falling = (h(step) - h(-step)) / (2.0 * step)
    if b > -SAFETY.speed_limit:
        assert falling == pytest.approx(-SAFETY.obstacle_gain * class_k(h(0.0)), rel=1e-5, abs=1e-5)


@pytest.mark.parametrize(("x", "y"), POINTS[:60])
def test_two_robots_on_their_halves_make_h_fall_at_the_rate_of_the_pair(x: float, y: float) -> None:
    first, second = pair_constraint(x, y, 2.0, 3.0, True, SAFETY), pair_constraint(2.0, 3.0, x, y, False, SAFETY)
    assert first[2] == second[2]
    step = 1e-6

    def h(time: float) -> float:
        one = (x + first[0] * first[2] * time, y + first[1] * first[2] * time)
        two = (2.0 + second[0] * second[2] * time, 3.0 + second[1] * second[2] * time)
        return math.dist(one, two) ** 2 / SAFETY.robot_clearance**2 - 1.0

    falling = (h(step) - h(-step)) / (2.0 * step)
    if first[2] > -SAFETY.speed_limit:
        assert falling == pytest.approx(-SAFETY.pair_gain * class_k(h(0.0)), rel=1e-5, abs=1e-5)


def test_a_robot_at_the_edge_of_a_growing_fire_is_at_its_edge_one_period_later() -> None:
    x, y, rate = 32.0, 0.0, 1.0
    ax, ay, b = circle_constraint(x, y, 0.0, 0.0, 20.0, rate)
    later = math.hypot(x + SAFETY.control_period * b * ax, y + SAFETY.control_period * b * ay)
    edge = 32.0 + rate * SAFETY.control_period
    assert edge <= later <= edge + 1e-5
    assert b < -rate


@pytest.mark.parametrize(("vx", "vy"), [(30.0, 0.0), (-12.0, 25.0), (0.0, -60.0)])
@pytest.mark.parametrize(("x", "y"), POINTS[:40])
def test_a_velocity_on_the_constraint_of_a_moving_bar_makes_h_fall_at_the_rate_of_the_barrier(
    x: float, y: float, vx: float, vy: float
) -> None:
    spine, clearance, step = floats([-20.0, -5.0, 30.0, 10.0]), 32.0, 1e-6
    ax, ay, b = capsule_constraint(x, y, -20.0, -5.0, 30.0, 10.0, 20.0, vx, vy, 0.0, SAFETY)

    def h(time: float) -> float:
        moved = spine + time * floats([vx, vy, vx, vy])
        robot = floats([[x + ax * b * time, y + ay * b * time]])
        return float(segment_distance(robot, moved[:2], moved[2:])[0]) ** 2 / clearance**2 - 1.0

    falling = (h(step) - h(-step)) / (2.0 * step)
    assert falling == pytest.approx(-SAFETY.obstacle_gain * class_k(h(0.0)), rel=1e-4, abs=1e-4)


def test_a_robot_may_be_slower_away_from_what_leaves_and_must_be_faster_away_from_what_comes() -> None:
    still, comes, leaves = (
        capsule_constraint(40.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0, vx, 9.0, 0.0, SAFETY)[2] for vx in (0.0, 7.0, -7.0)
    )
    assert (comes - still, leaves - still) == pytest.approx((-7.0, 7.0))


@pytest.mark.parametrize("angle", np.linspace(0.0, 6.0, 13))
def test_a_robot_at_the_edge_of_what_comes_is_at_its_edge_or_farther_one_period_later(angle: float) -> None:
    x, y, velocity = 32.0 * math.cos(angle), 32.0 * math.sin(angle), (40.0, -15.0)
    ax, ay, b = capsule_constraint(x, y, 0.0, 0.0, 0.0, 0.0, 20.0, *velocity, 0.0, SAFETY)
    dt = SAFETY.control_period
    later = math.dist((x + dt * b * ax, y + dt * b * ay), (dt * velocity[0], dt * velocity[1]))
    assert 32.0 <= later <= 32.0 + 0.5 * (100.0 * dt) ** 2 / 32.0


def test_beyond_its_activation_distance_the_fastest_obstacle_does_not_matter() -> None:
    distance = capsule_activation_distance(20.0, 48.0, -36.0, 0.0, SAFETY)
    for angle in np.linspace(0.0, 6.3, 50):
        x, y = distance * math.cos(angle), distance * math.sin(angle)
        assert capsule_constraint(x, y, 0.0, 0.0, 0.0, 0.0, 20.0, 48.0, -36.0, 0.0, SAFETY)[2] >= SAFETY.speed_limit
    head_on = capsule_constraint(
        0.8 * 0.999 * distance, -0.6 * 0.999 * distance, 0.0, 0.0, 0.0, 0.0, 20.0, 48.0, -36.0, 0.0, SAFETY
    )
    assert head_on[2] < SAFETY.speed_limit


def test_an_obstacle_outruns_a_robot_where_the_retreat_that_it_asks_for_is_faster_than_the_robot() -> None:
    outrun: list[bool] = []
    for distance in np.linspace(32.5, 100.0, 60):
        circle = (distance, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0, 150.0, 0.0, 0.0, SAFETY)
        outrun.append(bool(capsule_outruns(*circle)))
        assert outrun[-1] is bool(capsule_constraint(*circle)[2] < -SAFETY.speed_limit)
    assert set(outrun) == {True, False}


def test_a_bar_is_a_circle_round_the_nearest_point_of_its_spine() -> None:
    ends = (0.0, 0.0), (50.0, 0.0)
    assert bar_constraint(-30.0, 40.0, *ends, 4.0) == circle_constraint(-30.0, 40.0, 0.0, 0.0, 4.0)
    assert bar_constraint(20.0, 40.0, *ends, 4.0) == circle_constraint(20.0, 40.0, 20.0, 0.0, 4.0)
    assert bar_constraint(80.0, 40.0, *ends, 4.0) == circle_constraint(80.0, 40.0, 50.0, 0.0, 4.0)
    assert bar_constraint(20.0, 40.0, (7.0, 7.0), (7.0, 7.0), 4.0) == circle_constraint(20.0, 40.0, 7.0, 7.0, 4.0)


def test_a_wall_lets_nobody_out() -> None:
    assert wall_constraint(52.0, 5.0, 1.0, 0.0, 40.0, SAFETY) == (-1.0, 0.0, 0.0)
    inside, outside = (
        wall_constraint(64.0, 5.0, 1.0, 0.0, 40.0, SAFETY),
        wall_constraint(46.0, 5.0, 1.0, 0.0, 40.0, SAFETY),
    )
    assert inside[2] == SAFETY.obstacle_gain * SAFETY.obstacle_clearance
    assert outside[2] == -0.5 * SAFETY.obstacle_gain * SAFETY.obstacle_clearance


def test_every_constraint_has_a_unit_normal() -> None:
    near = [*POINTS, (0.0, 0.0), (1e-8, 0.0), (1e-300, 1e-300), (1e-5, -1e-5)]
    for x, y in near:
        for ax, ay, b in (
            pair_constraint(x, y, 0.0, 0.0, True, SAFETY),
            circle_constraint(x, y, 0.0, 0.0, 5.0),
            bar_constraint(x, y, (0.0, 0.0), (9.0, 9.0), 5.0),
            circle_constraint(x, y, 0.0, 0.0, 5.0, 3.0),
        ):
            assert math.hypot(ax, ay) == pytest.approx(1.0, abs=1e-12)
            assert not math.isnan(b)


@pytest.mark.parametrize("apart", [0.0, 1e-12])
def test_robots_in_one_place_are_sent_apart(apart: float) -> None:
    first = pair_constraint(3.0, 4.0, 3.0, 4.0 + apart, True, SAFETY)
    second = pair_constraint(3.0, 4.0 + apart, 3.0, 4.0, False, SAFETY)
    assert first[:2] == (-second[0], second[1])
    assert first[2] == second[2] == -math.inf


def test_a_violation_is_left_along_a_line_and_a_margin_used_along_a_cube() -> None:
    assert [class_k(h) for h in (-0.5, 0.0, 0.5, 2.0)] == [-0.5, 0.0, 0.125, 8.0]


@pytest.mark.parametrize("limit", [0.5, 90.0, 282.0])
def test_a_constraint_matters_within_its_activation_distance_and_not_beyond(limit: float) -> None:
    safety = SAFETY._replace(speed_limit=limit)

    def bound_at(distance: float, kind: str) -> float:
        if kind == "pair":
            return pair_constraint(distance, 0.0, 0.0, 0.0, True, safety)[2]
        return circle_constraint(distance, 0.0, 0.0, 0.0, 20.0, 2.0 if kind == "fire" else 0.0, safety)[2]

    distances = {
        "pair": sensing_radius(safety),
        "circle": capsule_activation_distance(20.0, 0.0, 0.0, 0.0, safety),
        "fire": capsule_activation_distance(20.0, 0.0, 0.0, 2.0, safety),
    }
    for kind, activation_distance in distances.items():
        assert bound_at(activation_distance * 0.999, kind) < limit <= bound_at(activation_distance, kind)
        assert bound_at(activation_distance * 3.0, kind) > limit


def test_robots_sense_each_other_at_35_metres_with_the_default_gains() -> None:
    assert sensing_radius(SAFETY) == pytest.approx(35.0, abs=0.5)


def hazards(circles: Floats, walls: Floats, fires: int) -> Floats:
    return hazards_of(circles, np.zeros((0, 5)), walls, floats([[0.0, 0.0, 0.0, 1.0]] * fires, -1, 4))


def test_the_sampling_condition_has_the_numbers_of_the_derivation() -> None:
    small = hazards(floats([[0.0, 0.0, 0.0]]), floats([[1.0, 0.0, 0.0]]), 1)
    slow = {c.kind: c for c in sampling_conditions(small, SAFETY)}
    assert list(slow) == ["pair", "circle", "fire", "wall"]
    assert slow["pair"].value == pytest.approx(0.038, abs=0.001)
    assert slow["fire"].value == pytest.approx(0.043, abs=0.001)
    h_near = SAFETY.speed_limit * SAFETY.control_period / SAFETY.obstacle_clearance
    assert slow["wall"].value == pytest.approx(SAFETY.control_period * SAFETY.obstacle_gain * h_near**2)
    fast = sampling_conditions(small, SAFETY._replace(speed_limit=282.0))
    assert max(c.value for c in fast) == pytest.approx(0.54, abs=0.01)
    check_sampling(small, SAFETY._replace(speed_limit=360.0))


def test_the_sampling_condition_counts_how_fast_an_obstacle_moves() -> None:
    table = hazards(floats([[0.0, 0.0, 5.0]]), np.zeros((0, 3)), 0)
    still = sampling_conditions(table, SAFETY)[1]
    table[0, [VX, VY]] = 30.0, 40.0
    moving = sampling_conditions(table, SAFETY)[1]
    assert (still.closing_speed, moving.closing_speed) == (90.0, 140.0)
    assert moving.value > still.value


def test_a_world_whose_barriers_do_not_hold_between_two_steps_is_refused_with_numbers() -> None:
    nothing = hazards(np.zeros((0, 3)), np.zeros((0, 3)), 0)
    with pytest.raises(FilterError, match=r"pair barriers.*= 1\.\d+ exceeds 1 at clearance 25 m.*pair_gain"):
        check_sampling(nothing, SAFETY._replace(speed_limit=400.0))
    with pytest.raises(FilterError, match=r"fire barriers.*obstacle_gain"):
        check_sampling(hazards(np.zeros((0, 3)), np.zeros((0, 3)), 1), SAFETY._replace(speed_limit=370.0))


@pytest.mark.parametrize(("radius", "pushed_out"), [(20.0, 2.3), (138.0, 6.4)])
def test_the_least_stand_off_is_where_the_barrier_of_a_growing_fire_holds_a_robot(
    radius: float, pushed_out: float
) -> None:
    stand_off = least_stand_off(radius, 1.0, SAFETY)
    assert stand_off - SAFETY.obstacle_clearance == pytest.approx(pushed_out, abs=0.06)
    assert circle_constraint(radius + stand_off, 0.0, 0.0, 0.0, radius, 1.0)[2] == pytest.approx(0.0, abs=0.02)


def test_clipping_keeps_the_direction_and_leaves_slow_velocities_alone() -> None:
    assert clipped(300.0, 400.0, 90.0) == pytest.approx((54.0, 72.0))
    assert clipped(3.0, 4.0, 90.0) == (3.0, 4.0)
