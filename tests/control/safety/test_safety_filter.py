"""The distributed safety filter: exact, safe in closed loop, and least in violation where it must violate."""

import math

import numpy as np
import pytest

from higvf_console.control.safety.coupled_filter import CoupledFilter
from higvf_console.control.safety.hazards import VX, VY, hazard_table, hazards_of
from higvf_console.control.safety.safety_filter import blocked, filter_velocities
from higvf_console.core.arrays import Floats, bools, floats
from tests.control.safety.barrier_reference import (
    SAFETY,
    clearance,
    coupled_constraints,
    filtered,
    half_constraints,
    least_violation,
    projection_by_enumeration,
    random_scene,
    scene,
    speeds,
)

LIMIT = SAFETY.speed_limit


def own_rows(matrix: Floats, bound: Floats, robot: int) -> Floats:
    mine = np.abs(matrix[:, 2 * robot : 2 * robot + 2]).sum(axis=1) > 0.0
    return np.c_[matrix[mine, 2 * robot : 2 * robot + 2], bound[mine]]


def test_each_robot_gets_the_projection_on_all_its_rows_wherever_all_robots_have_one() -> None:
    rng = np.random.default_rng(6)
    compared = 0
    for _ in range(400):
        given = random_scene(rng, int(rng.integers(1, 6)))
        matrix, bound = half_constraints(given)
        expected = [
            projection_by_enumeration(given.nominal[i], own_rows(matrix, bound, i), LIMIT)
            for i in range(len(given.position))
        ]
        if all(one is not None for one in expected):
            velocity, _, infeasible = filtered(given)
            assert np.abs(velocity - np.array(expected)).max() <= 1e-11 * LIMIT
            assert not infeasible.any()
            compared += 1
    assert compared > 100


def test_nothing_is_violated_where_the_coupled_rows_have_a_solution_and_else_the_least() -> None:
    rng = np.random.default_rng(7)
    rescued = violated = 0
    for _ in range(500):
        given = random_scene(rng, int(rng.integers(1, 9)))
        velocity, _, infeasible = filtered(given)
        matrix, bound = coupled_constraints(given)
        if not len(matrix):
            continue
        worst = float((matrix @ velocity.ravel() - bound).max())
        assert speeds(velocity).max() <= LIMIT * (1.0 + 1e-9)
        if infeasible.any():
            violated += 1
            least = least_violation(matrix, bound, LIMIT)
            assert least > 0.0
            assert worst <= least + 1e-6 * LIMIT
        else:
            assert worst <= 1e-6 * LIMIT
            halves, half_bound = half_constraints(given)
            rescued += bool((halves @ velocity.ravel() > half_bound + 1e-6 * LIMIT).any())
    assert rescued > 20
    assert violated > 50


def test_a_needless_violation_is_never_flagged() -> None:
    rng = np.random.default_rng(8)
    tight = 0
    for _ in range(300):
        given = random_scene(rng, int(rng.integers(2, 7)))
        matrix, bound = coupled_constraints(given)
        if len(matrix) and least_violation(matrix, bound, LIMIT) < -1e-6 * LIMIT:
            tight += least_violation(*half_constraints(given), LIMIT) > 0.0
            assert not filtered(given)[2].any()
    assert tight > 5


def test_free_robots_keep_their_velocity_bit_for_bit() -> None:
    given = scene([[0.0, 0.0], [200.0, 0.0]], [[31.7, -2.3], [0.1, 0.2]], circles=[[100.0, 0.0, 5.0]])
    velocity, active, infeasible = filtered(given)
    assert velocity.tobytes() == given.nominal.tobytes()
    assert active.tolist() == [0, 0]
    assert not infeasible.any()


def test_a_robot_between_a_fire_and_one_that_can_yield_violates_nothing() -> None:
    given = scene([[32.0, 0.0], [57.0, 0.0]], [[0.0, 0.0], [-20.0, 0.0]], fires=[[0.0, 0.0, 20.0, 1.0]])
    velocity, active, infeasible = filtered(given)
    assert not infeasible.any()
    assert velocity[:, 0] == pytest.approx([1.0003125, 1.0003125], abs=1e-7)
    assert active.tolist() == [2, 1]


def test_robots_far_from_the_squeeze_do_not_feel_the_rescue() -> None:
    pair = scene([[32.0, 0.0], [57.0, 0.0]], [[0.0, 0.0], [-20.0, 0.0]], fires=[[0.0, 0.0, 20.0, 1.0]])
    more = scene(
        [*pair.position, [57.0, 33.0], [300.0, 0.0]],
        [*pair.nominal, [0.0, -40.0], [7.0, 7.0]],
        fires=[[0.0, 0.0, 20.0, 1.0]],
    )
    alone = filtered(pair)[0]
    together = filtered(more)[0]
    assert together[:2] == pytest.approx(alone, abs=1e-9)
    assert together[3].tobytes() == more.nominal[3].tobytes()


def test_the_whole_chain_yields_when_it_must() -> None:
    chain = [[32.0 + 25.0 * k, 0.0] for k in range(6)]
    velocity, _, infeasible = filtered(scene(chain, np.zeros((6, 2)), fires=[[0.0, 0.0, 20.0, 1.0]]))
    assert not infeasible.any()
    assert velocity[:, 0] == pytest.approx([1.0003125] * 6, abs=1e-7)


def test_a_robot_trapped_between_a_fire_and_a_wall_takes_the_least_violation_and_says_so() -> None:
    given = scene([[32.0, 0.0]], [[5.0, 5.0]], walls=[[-1.0, 0.0, -44.0]], fires=[[0.0, 0.0, 20.0, 1.0]])
    velocity, active, infeasible = filtered(given)
    assert infeasible.tolist() == [True]
    assert velocity[0] == pytest.approx([0.5 * 1.0003125, 5.0], abs=1e-5)
    assert active.tolist() == [2]


def test_trapped_robots_leave_the_others_alone() -> None:
    trapped = scene([[32.0, 0.0]], [[5.0, 5.0]], walls=[[-1.0, 0.0, -44.0]], fires=[[0.0, 0.0, 20.0, 1.0]])
    given = trapped._replace(
        position=np.array([[32.0, 0.0], [-60.0, 0.0]]), nominal=np.array([[5.0, 5.0], [-3.0, 4.0]])
    )
    velocity, _, infeasible = filtered(given)
    assert infeasible.tolist() == [True, False]
    assert velocity[1].tolist() == [-3.0, 4.0]


@pytest.mark.parametrize("broken", ["position", "nominal"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_data_that_are_not_numbers_stop_that_robot_only(broken: str, value: float) -> None:
    given = scene([[0.0, 0.0], [26.0, 0.0], [52.0, 0.0]], [[40.0, 0.0], [5.0, 1.0], [-40.0, 0.0]])
    (given.position if broken == "position" else given.nominal)[1, 1] = value
    velocity, _, infeasible = filtered(given)
    assert velocity[1].tolist() == [0.0, 0.0]
    assert infeasible.tolist() == [False, True, False]
    assert np.isfinite(velocity).all()
    if broken == "position":
        assert velocity[[0, 2]].tobytes() == given.nominal[[0, 2]].tobytes()
    else:
        assert 0.0 < velocity[0, 0] < 1.0
    assert velocity.any()


@pytest.mark.parametrize("coupled", [False, True])
def test_a_robot_that_a_fire_outruns_is_flagged_in_the_same_tick_and_flees(coupled: bool) -> None:
    slow = SAFETY._replace(speed_limit=5.0)
    for growth, outrun in ((4.0, False), (6.0, True)):
        given = scene(
            [[32.5, 0.0], [300.0, 0.0]], [[-5.0, 0.0], [1.0, 0.0]], fires=[[0.0, 0.0, 20.0, growth]], safety=slow
        )
        flt = CoupledFilter().filter_velocities if coupled else filter_velocities
        velocity, active, infeasible = flt(*given.arguments())
        assert infeasible.tolist() == [outrun, False]
        assert active[0] == 1
        assert velocity[1].tolist() == [1.0, 0.0]
        if outrun:
            assert velocity[0] == pytest.approx([5.0, 0.0])


@pytest.mark.parametrize("coupled", [False, True])
def test_a_robot_inside_what_stands_still_leaves_as_fast_as_it_can_and_is_not_flagged(coupled: bool) -> None:
    given = scene([[10.0, 0.0]], [[-5.0, 0.0]], circles=[[0.0, 0.0, 20.0]])
    velocity, _, infeasible = (CoupledFilter().filter_velocities if coupled else filter_velocities)(*given.arguments())
    assert velocity[0] == pytest.approx([LIMIT, 0.0])
    assert infeasible.tolist() == [False]


def test_both_filters_give_a_lone_robot_the_same_velocity_among_moving_obstacles() -> None:
    rng = np.random.default_rng(21)
    shaped = 0
    for _ in range(200):
        given = scene(
            rng.uniform(-60.0, 60.0, (1, 2)),
            rng.normal(size=(1, 2)) * 40.0,
            circles=np.c_[rng.uniform(-90.0, 90.0, (2, 2)), rng.uniform(5.0, 25.0, 2)],
            bars=np.c_[rng.uniform(-90.0, 90.0, (1, 4)), [4.0]],
        )
        position, nominal, table, safety = given.arguments()
        table[:, [VX, VY]] = rng.normal(size=(3, 2)) * 40.0
        alone = filter_velocities(position, nominal, table, safety)
        together = CoupledFilter().filter_velocities(position, nominal, table, safety)
        assert alone[0] == pytest.approx(together[0], abs=1e-4 * LIMIT)
        assert alone[2].tolist() == together[2].tolist()
        shaped += int(alone[1][0] > 0)
    assert shaped > 60


@pytest.mark.parametrize("coupled", [False, True])
def test_robots_yield_to_obstacles_that_cross_them_at_every_speed_below_their_own(coupled: bool) -> None:
    flt = CoupledFilter().filter_velocities if coupled else filter_velocities
    given = scene(
        [[0.0, 0.0], [26.0, 0.0], [0.0, 26.0]],
        np.zeros((3, 2)),
        circles=[[-300.0, 3.0, 15.0]],
        bars=[[-60.0, 260.0, 40.0, 260.0, 5.0]],
    )
    velocity = floats([[70.0, 0.0], [0.0, -30.0]])
    dt = SAFETY.control_period
    for _ in range(400):
        position, nominal, table, safety = given.arguments()
        table[:2, [VX, VY]] = velocity
        answer, _, infeasible = flt(position, nominal, table, safety)
        assert not infeasible.any()
        given = given._replace(
            position=given.position + dt * answer,
            circles=given.circles + dt * np.c_[velocity[:1], [0.0]],
            bars=given.bars + dt * np.c_[velocity[1:], velocity[1:], [0.0]],
        )
        assert clearance(given) >= -1e-7


def test_extinguished_fires_are_no_hazards() -> None:
    position, radius, growth = floats([[30.0, 0.0], [0.0, 0.0]]), floats([20.0, 20.0]), floats([1.0, 1.0])
    nothing = np.zeros((0, 5)), np.zeros((0, 2)), np.zeros((0, 3))
    burning = bools([False, True])
    table = hazard_table(*nothing, position, radius, growth, burning)
    assert table.tolist() == hazards_of([], [], [], [[0.0, 0.0, 20.0, 1.0]]).tolist()


def test_an_empty_team_is_filtered_to_nothing() -> None:
    velocity, active, infeasible = filtered(scene([], [], fires=[[0.0, 0.0, 20.0, 1.0]]))
    assert velocity.shape == (0, 2)
    assert len(active) == len(infeasible) == 0


def test_robots_in_one_place_part() -> None:
    velocity, _, infeasible = filtered(scene([[0.0, 0.0], [0.0, 0.0]], [[1.0, 1.0], [1.0, 1.0]]))
    assert velocity[:, 0] == pytest.approx([-LIMIT, LIMIT])
    assert not infeasible.any()


@pytest.mark.parametrize("seed", range(4))
def test_random_teams_never_lose_clearance_in_closed_loop(seed: int) -> None:
    rng = np.random.default_rng(seed)
    walls = [[1.0, 0.0, -30.0], [-1.0, 0.0, -330.0], [0.0, 1.0, -30.0], [0.0, -1.0, -330.0]]
    cells = [(40.0 * x, 40.0 * y) for x in range(8) for y in range(8) if (x, y) not in {(2, 2), (5, 5), (2, 6)}]
    start = np.array(cells)[rng.permutation(len(cells))[:14]] + 10.0
    given = scene(
        start,
        np.zeros((14, 2)),
        circles=[[90.0, 90.0, 8.0]],
        bars=[[205.0, 205.0, 215.0, 215.0, 4.0]],
        walls=walls,
        fires=[[90.0, 250.0, 5.0, 1.0]],
    )
    assert clearance(given) >= 0.0
    wish = rng.normal(size=(14, 2)) * 60.0
    for step in range(900):
        if step % 40 == 0:
            goal = np.array([90.0, 250.0]) if step % 80 == 0 else rng.uniform(0.0, 300.0, 2)
            wish = 90.0 * (goal - given.position) / np.hypot(*(goal - given.position).T)[:, None]
        velocity, _, infeasible = filtered(given._replace(nominal=wish))
        assert not infeasible.any()
        assert speeds(velocity).max() <= LIMIT * (1.0 + 1e-9)
        given = given._replace(
            position=given.position + SAFETY.control_period * velocity,
            fires=given.fires + SAFETY.control_period * given.fires[:, [3]] * [0.0, 0.0, 1.0, 0.0],
        )
        assert clearance(given) >= -1e-9


def test_a_crowd_pressed_on_a_growing_fire_gives_way_without_a_violation() -> None:
    angle = 2.399 * np.arange(24)
    boundary = 60.0 + 30.0 * np.sqrt(np.arange(24.0))
    given = scene(
        np.c_[boundary * np.cos(angle), boundary * np.sin(angle)], np.zeros((24, 2)), fires=[[0.0, 0.0, 20.0, 1.0]]
    )
    for _ in range(400):
        inward = -60.0 * given.position / np.hypot(*given.position.T)[:, None]
        velocity, _, infeasible = filtered(given._replace(nominal=inward))
        assert not infeasible.any()
        given = given._replace(
            position=given.position + SAFETY.control_period * velocity,
            fires=given.fires + SAFETY.control_period * given.fires[:, [3]] * [0.0, 0.0, 1.0, 0.0],
        )
        assert clearance(given) >= -1e-9


def test_the_same_scene_gives_the_same_bits() -> None:
    given = random_scene(np.random.default_rng(9), 8)
    assert [part.tobytes() for part in filtered(given)] == [part.tobytes() for part in filtered(given)]


def test_a_robot_that_pushes_against_a_bar_is_blocked_and_one_that_slides_along_it_is_not() -> None:
    bar = [[0.0, -500.0, 0.0, 500.0, 3.0]]
    stall = 3.0
    for wish, expected in (((60.0, 0.0), True), ((40.0, 30.0), False), ((0.5, 0.0), False), ((-60.0, 0.0), False)):
        velocity, active, _ = filtered(scene([[-15.0 - 1e-9, 0.0]], [wish], bars=bar))
        found = blocked(velocity[0, 0], velocity[0, 1], wish[0], wish[1], int(active[0]), stall)
        assert bool(found) is expected
    assert not blocked(0.0, 0.0, 60.0, 0.0, 0, stall)
    assert math.isclose(filtered(scene([[-15.0, 0.0]], [[60.0, 0.0]], bars=bar))[0][0, 0], 0.0, abs_tol=1e-9)
