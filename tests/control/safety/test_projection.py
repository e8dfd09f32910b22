"""The exact projection of one velocity, against enumeration of all points where it can be."""

import math

import numpy as np
import pytest

from higvf_console.control.safety.projection import cull, project
from higvf_console.core.arrays import Floats
from tests.control.safety.barrier_reference import projection_by_enumeration


def random_constraints(rng: np.random.Generator, count: int, limit: float, lowest: float) -> Floats:
    angle = rng.uniform(0.0, 2.0 * np.pi, count)
    if count and rng.random() < 0.2:  # parallel, opposite and square rows
        angle[1:] = angle[0] + rng.choice([0.0, 0.5 * np.pi, np.pi], count - 1)
    return np.c_[np.cos(angle), np.sin(angle), limit * rng.uniform(lowest, 1.0, count)]


def projected(velocity: Floats, rows: Floats, limit: float) -> Floats | None:
    scratch = np.zeros(len(rows), np.int64)
    ux, uy, feasible = project(velocity[0], velocity[1], rows, len(rows), limit, scratch)
    return np.array([ux, uy]) if feasible else None


@pytest.mark.parametrize("lowest", [0.0, -0.1, -0.5, -1.0, -1.5])
def test_the_projection_is_exact_or_proven_impossible(lowest: float) -> None:
    rng = np.random.default_rng(2)
    impossible = 0
    for _ in range(1500):
        limit = float(rng.choice([1.0, 90.0]))
        rows = random_constraints(rng, int(rng.integers(0, 9)), limit, lowest)
        velocity = 0.6 * limit * rng.normal(size=2)
        found, expected = projected(velocity, rows, limit), projection_by_enumeration(velocity, rows, limit)
        assert (found is None) == (expected is None)
        impossible += found is None
        if found is not None and expected is not None:
            assert np.abs(found - expected).max() <= 1e-12 * limit
    assert (impossible > 50) == (lowest < -0.1)


@pytest.mark.parametrize("lowest", [0.0, -0.3])
def test_dropped_rows_never_change_the_projection(lowest: float) -> None:
    rng = np.random.default_rng(3)
    dropped = 0
    for _ in range(1500):
        rows = random_constraints(rng, 12, 1.0, lowest)
        velocity = rng.normal(size=2)
        velocity /= max(1.0, math.hypot(*velocity))
        kept = np.zeros(len(rows), np.int64)
        used = cull(velocity[0], velocity[1], rows, len(rows), 1.0, kept)
        everything = projection_by_enumeration(velocity, rows, 1.0)
        if used < 0:
            assert everything is None
            continue
        dropped += len(rows) - used
        fewer = projection_by_enumeration(velocity, rows[kept[:used]], 1.0)
        assert (fewer is None) == (everything is None)
        if fewer is not None and everything is not None:
            assert np.abs(fewer - everything).max() <= 1e-12
    assert dropped > 1500


def test_a_velocity_that_meets_all_rows_comes_back_bit_for_bit() -> None:
    rng = np.random.default_rng(4)
    for _ in range(200):
        velocity = rng.uniform(-60.0, 60.0, 2)
        rows = random_constraints(rng, 6, 90.0, 0.0)
        rows[:, 2] = rows[:, :2] @ velocity + rng.uniform(0.0, 5.0, 6)
        found = projected(velocity, rows, 90.0)
        assert found is not None and found.tobytes() == velocity.tobytes()


def test_a_clipped_velocity_is_not_clipped_again() -> None:
    for angle in np.linspace(0.0, 6.0, 500):
        once = projected(200.0 * np.array([np.cos(angle), np.sin(angle)]), np.zeros((0, 3)), 90.0)
        assert once is not None and abs(math.hypot(*once) - 90.0) < 1e-12
        twice = projected(once, np.zeros((0, 3)), 90.0)
        assert twice is not None and twice.tobytes() == once.tobytes()


def test_a_row_that_asks_for_full_speed_gets_it() -> None:
    found = projected(np.array([30.0, 40.0]), np.array([[1.0, 0.0, -90.0]]), 90.0)
    assert found is not None and np.abs(found - [-90.0, 0.0]).max() < 1e-12
