"""The centralised filter, against an independent solver, and in closed loop."""

import numpy as np
import osqp
import pytest
from scipy import sparse

from higvf_console.control.safety.coupled_filter import CoupledFilter
from higvf_console.control.safety.nearest_point import (
    CONFLICT,
    OPTIMAL,
    empty_constraints,
    nearest,
    optimality_error,
    violation,
)
from higvf_console.core.arrays import Floats, floats
from tests.control.safety.barrier_reference import (
    SAFETY,
    Scene,
    clearance,
    coupled_constraints,
    filtered,
    least_violation,
    random_scene,
    scene,
    speeds,
)

LIMIT = SAFETY.speed_limit


def oracle(given: Scene) -> Floats | None:
    """The program [23] by OSQP at high accuracy, without a speed limit on the result."""
    matrix, bound = coupled_constraints(given)
    limited = given.nominal * np.minimum(1.0, LIMIT / np.maximum(speeds(given.nominal), 1e-9))[:, None]
    solver = osqp.OSQP()
    solver.setup(
        sparse.eye(matrix.shape[1], format="csc"), -limited.ravel() / LIMIT, sparse.csc_matrix(matrix),
        np.full(len(bound), -np.inf), bound / LIMIT, eps_abs=1e-9, eps_rel=1e-9, max_iter=40000, verbose=False,
    )  # fmt: skip
    result = solver.solve(raise_error=False)
    if result.info.status != "solved":
        return None
    return LIMIT * np.asarray(result.x).reshape(-1, 2)


def test_the_optimum_is_that_of_an_independent_solver_where_the_speed_limit_is_slack() -> None:
    rng = np.random.default_rng(10)
    coupled = CoupledFilter()
    compared = 0
    for _ in range(300):
        given = random_scene(rng, int(rng.integers(1, 9)))
        if not len(coupled_constraints(given)[0]):
            continue
        expected = oracle(given)
        if expected is not None and speeds(expected).max() < LIMIT:
            velocity, _, infeasible = coupled.filter_velocities(*given.arguments())
            assert np.abs(velocity - expected).max() <= 1e-6 * LIMIT
            assert not infeasible.any()
            compared += 1
    assert compared > 60


def test_the_speed_limit_is_part_of_the_problem_and_infeasible_teams_fall_back() -> None:
    rng = np.random.default_rng(11)
    coupled = CoupledFilter()
    solved = 0
    for _ in range(300):
        given = random_scene(rng, int(rng.integers(1, 9)))
        matrix, bound = coupled_constraints(given)
        before = coupled.fallbacks
        velocity, _, infeasible = coupled.filter_velocities(*given.arguments())
        assert speeds(velocity).max() <= LIMIT * (1.0 + 1e-9)
        if coupled.fallbacks > before:
            assert least_violation(matrix, bound, LIMIT) > -1e-6 * LIMIT
            distributed = filtered(given)
            assert velocity.tobytes() == distributed[0].tobytes()
            assert infeasible.tolist() == distributed[2].tolist()
        elif len(matrix):
            solved += 1
            assert (matrix @ velocity.ravel() - bound).max() <= 1e-8 * LIMIT
    assert solved > 80
    assert coupled.fallbacks > 80


def test_it_stays_nearer_to_the_nominal_velocities_than_the_distributed_filter() -> None:
    given = scene([[0.0, 0.0], [26.0, 0.0]], [[0.0, 0.0], [-60.0, 0.0]])
    apart = filtered(given)[0] - given.nominal
    together = CoupledFilter().filter_velocities(*given.arguments())[0] - given.nominal
    assert (together**2).sum() < (apart**2).sum()


def test_free_teams_keep_their_velocities_bit_for_bit() -> None:
    given = scene([[0.0, 0.0], [200.0, 0.0]], [[31.7, -2.3], [0.1, 0.2]])
    velocity, active, _ = CoupledFilter().filter_velocities(*given.arguments())
    assert velocity.tobytes() == given.nominal.tobytes()
    assert active.tolist() == [0, 0]


def test_data_that_are_not_numbers_are_left_to_the_distributed_filter() -> None:
    coupled = CoupledFilter()
    velocity, _, infeasible = coupled.filter_velocities(
        *scene([[0.0, 0.0], [90.0, np.nan]], [[1.0, 2.0], [3.0, 4.0]]).arguments()
    )
    assert velocity.tolist() == [[1.0, 2.0], [0.0, 0.0]]
    assert infeasible.tolist() == [False, True]
    assert coupled.fallbacks == 1


@pytest.mark.parametrize("seed", range(2))
def test_teams_keep_clearance_in_closed_loop_while_the_row_list_ages(seed: int) -> None:
    rng = np.random.default_rng(seed)
    start = 40.0 * np.array([(x, y) for x in range(4) for y in range(3)], dtype=float) + 60.0
    given = scene(
        start,
        np.zeros((12, 2)),
        circles=[[20.0, 20.0, 8.0]],
        bars=[[240.0, 60.0, 240.0, 160.0, 4.0]],
        walls=[[1.0, 0.0, -30.0], [-1.0, 0.0, -330.0]],
        fires=[[120.0, 220.0, 5.0, 1.0]],
    )
    coupled = CoupledFilter()
    wish = np.zeros((12, 2))
    for step in range(500):
        if step % 40 == 0:
            goal = np.array([120.0, 220.0]) if step % 80 == 0 else rng.uniform(0.0, 300.0, 2)
            wish = 90.0 * (goal - given.position) / np.hypot(*(goal - given.position).T)[:, None]
        velocity, _, infeasible = coupled.filter_velocities(*given._replace(nominal=wish).arguments())
        assert not infeasible.any()
        given = given._replace(
            position=given.position + SAFETY.control_period * velocity,
            fires=given.fires + SAFETY.control_period * given.fires[:, [3]] * [0.0, 0.0, 1.0, 0.0],
        )
        assert clearance(given) >= -1e-8
    assert coupled.fallbacks == 0


def test_every_answer_of_the_exact_solver_proves_itself() -> None:
    rng = np.random.default_rng(12)
    proven = {OPTIMAL: 0, CONFLICT: 0}
    for _ in range(600):
        members, count = int(rng.integers(1, 6)), int(rng.integers(1, 12))
        rows = empty_constraints(members, count)
        for r in range(count):
            angle = rng.uniform(0.0, 2.0 * np.pi)
            rows.linear[r] = unit_constraint(angle, float(rng.uniform(-0.6, 0.8)))
            rows.ends[r] = [*rng.permutation(members), -1][:2]
        nominal = rng.normal(size=(members, 2))
        solution = nearest(nominal, rows, 1.0)
        proven[solution.status] += 1
        if solution.status == OPTIMAL:
            assert violation(rows, solution.velocity, 1.0) <= 1e-9
            assert optimality_error(nominal, rows, solution, 1.0) <= 1e-6
        else:
            weight = solution.weight[: solution.size]
            total = np.zeros((members, 2))
            for r in range(solution.size):
                total[rows.ends[r, 0]] += weight[r] * rows.linear[r, :2]
                if rows.ends[r, 1] >= 0:
                    total[rows.ends[r, 1]] -= weight[r] * rows.linear[r, :2]
            assert weight.min() >= 0.0
            assert np.abs(total).max() <= 1e-6
            assert weight @ rows.linear[: solution.size, 2] < 0.0
    assert min(proven.values()) > 50


def unit_constraint(angle: float, bound: float) -> tuple[float, float, float]:
    return float(np.cos(angle)), float(np.sin(angle)), bound


def test_each_way_in_which_a_solution_is_not_the_nearest_shows_in_its_error() -> None:
    nominal, rows = floats([[0.5, 0.0]]), empty_constraints(1, 1)
    rows.ends[0], rows.linear[0] = (0, -1), (1.0, 0.0, 0.2)
    right = nearest(nominal, rows, 1.0)
    assert optimality_error(nominal, rows, right, 1.0) <= 1e-12
    weight, other = right.weight, right.velocity
    for wrong, error in (
        (right._replace(velocity=floats([[0.2, 0.1]])), 0.1),  # not stationary
        (right._replace(weight=floats(weight + 0.25 * (weight > 0.0))), 0.25),  # nor so
        (right._replace(velocity=floats([[0.1, 0.0]]), weight=floats(weight + 0.1 * (weight > 0.0))), 0.1),  # slack
        (right._replace(velocity=floats(2.0 * nominal - other), weight=floats(-weight)), 0.3),  # a pull
    ):
        assert optimality_error(nominal, rows, wrong, 1.0) == pytest.approx(error)
