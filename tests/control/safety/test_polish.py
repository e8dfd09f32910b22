"""The exact optimum from a guess of the active constraints, part by part."""

import numpy as np
import pytest

from higvf_console.control.safety import polish as polishing
from higvf_console.control.safety.nearest_point import CONFLICT, FAILED, OPTIMAL, Constraints, empty_constraints
from higvf_console.control.safety.polish import Polished, polish
from higvf_console.core.arrays import bools, floats

LIMIT = 90.0
NOBODY = -1

pytestmark = pytest.mark.usefixtures("plain_kernels")


def constraints(*rows: tuple[int, int, float, float, float], robots: int) -> Constraints:
    """Rows i, j, ax, ay, b of a.(u_i - u_j) <= b; without j of a.u_i <= b."""
    made = empty_constraints(robots, len(rows))
    for r, (i, j, *linear) in enumerate(rows):
        made.ends[r] = i, j
        made.linear[r] = linear
    return made


def polished(nominal: list[tuple[float, float]], rows: Constraints, likely: list[bool]) -> Polished:
    return polish(floats(nominal), rows, bools(likely), LIMIT)


def test_two_robots_share_their_constraint_equally() -> None:
    found = polished([(10.0, 1.0), (-10.0, 2.0)], constraints((0, 1, 1.0, 0.0, 6.0), robots=2), [True])
    assert found.status == OPTIMAL
    assert found.velocity == pytest.approx(floats([(3.0, 1.0), (-3.0, 2.0)]))
    assert found.weight == pytest.approx([7.0])


def test_a_constraint_that_nobody_thought_of_is_found_and_one_in_vain_is_dropped() -> None:
    rows = constraints((0, NOBODY, 1.0, 0.0, 4.0), (0, NOBODY, 0.0, 1.0, 50.0), robots=1)
    found = polished([(10.0, 1.0)], rows, [False, True])
    assert found.velocity == pytest.approx(floats([(4.0, 1.0)]))
    assert found.weight == pytest.approx([6.0, 0.0])


def test_parts_that_a_broken_constraint_joins_are_solved_again() -> None:
    rows = constraints((0, 1, 1.0, 0.0, 6.0), (2, 1, 0.0, 1.0, -2.0), robots=3)
    found = polished([(10.0, 0.0), (-10.0, 0.0), (0.0, 0.0)], rows, [True, False])
    assert found.status == OPTIMAL
    assert found.velocity == pytest.approx(floats([(3.0, 0.0), (-3.0, 1.0), (0.0, -1.0)]))


def test_a_robot_without_an_active_constraint_keeps_its_velocity_bit_for_bit() -> None:
    rows = constraints((0, 1, 1.0, 0.0, 6.0), (2, NOBODY, 1.0, 0.0, 60.0), robots=3)
    found = polished([(10.0, 1.0), (-10.0, 2.0), (31.7, -2.3)], rows, [True, False])
    assert found.velocity[2].tolist() == [31.7, -2.3]


def test_the_speed_limit_holds_for_every_part() -> None:
    rows = constraints((0, NOBODY, -1.0, 0.0, -54.0), robots=1)
    found = polished([(0.0, LIMIT)], rows, [True])
    assert found.velocity == pytest.approx(floats([(54.0, 72.0)]), abs=1e-6)


def test_constraints_that_contradict_each_other_are_a_proven_conflict() -> None:
    rows = constraints((0, NOBODY, 1.0, 0.0, -1.0), (0, NOBODY, -1.0, 0.0, -1.0), robots=1)
    assert polished([(0.0, 0.0)], rows, [True, True]).status == CONFLICT


def test_a_part_that_is_too_large_is_left_to_another_method(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = constraints((0, 1, 1.0, 0.0, 6.0), (1, 2, 1.0, 0.0, 6.0), robots=3)
    wish = [(10.0, 0.0), (0.0, 0.0), (-10.0, 0.0)]
    assert polished(wish, rows, [True, True]).status == OPTIMAL
    monkeypatch.setattr(polishing, "_LARGEST_PART", 2)
    assert polished(wish, rows, [True, True]).status == FAILED


def test_a_random_team_meets_all_constraints_with_multipliers_that_balance_its_wishes() -> None:
    rng = np.random.default_rng(11)
    for _ in range(20):
        robots, count = int(rng.integers(2, 6)), int(rng.integers(1, 8))
        rows: list[tuple[int, int, float, float, float]] = []
        for _ in range(count):
            i, j = rng.permutation(robots)[:2].tolist()
            angle, shared = rng.uniform(0.0, 2.0 * np.pi), bool(rng.random() < 0.5)
            rows.append((i, j if shared else NOBODY, np.cos(angle), np.sin(angle), float(rng.uniform(0.0, 20.0))))
        wish = floats(rng.uniform(-40.0, 40.0, (robots, 2)))
        given = constraints(*rows, robots=robots)
        found = polish(wish, given, bools(rng.random(count) < 0.5), 1e3)  # zero velocity meets all of them
        assert found.status == OPTIMAL
        balance = found.velocity - wish
        for (i, j, ax, ay, b), weight in zip(rows, found.weight.tolist(), strict=True):
            normal = np.array([ax, ay])
            value = normal @ (found.velocity[i] - (found.velocity[j] if j >= 0 else 0.0))
            assert value <= b + 1e-6
            assert weight >= 0.0
            assert weight * (b - value) == pytest.approx(0.0, abs=1e-5)
            balance[i] += weight * normal
            if j >= 0:
                balance[j] -= weight * normal
        assert np.abs(balance).max() <= 1e-5
