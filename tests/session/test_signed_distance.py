"""The smoothed signed distance is near the true one and has the gradient that it says."""

import numpy as np
import pytest

from higvf_console.arrays import Floats, floats
from higvf_console.session.polygons import signed_distance
from higvf_console.session.signed_distance import SignedDistance, sampled_distance, smoothed_distance

U_SHAPE = floats([[0, 0], [100, 0], [100, 80], [80, 80], [80, 20], [20, 20], [20, 80], [0, 80]])
CELL = 5.0


@pytest.fixture(scope="module")
def grid() -> SignedDistance:
    return sampled_distance([U_SHAPE], CELL, margin=30.0)


@pytest.fixture(scope="module")
def points() -> Floats:
    return floats(np.random.default_rng(4).uniform([-30, -30], [130, 110], (2000, 2)))


def test_samples_are_exact_and_cover_the_margin(grid: SignedDistance) -> None:
    rows, columns = grid.values.shape
    nodes = np.array([(i, j) for j in (0, 7, rows - 1) for i in (0, 11, columns - 1)])
    expected = signed_distance([U_SHAPE], grid.origin + CELL * nodes)
    assert [grid.values[j, i] for i, j in nodes] == pytest.approx(expected)
    far_corner = grid.origin + CELL * np.array([columns - 1, rows - 1])
    assert (grid.origin <= [-30, -30]).all()
    assert (far_corner >= [130, 110]).all()


def test_the_smoothed_distance_stays_within_a_cell_of_the_true_one(grid: SignedDistance, points: Floats) -> None:
    value, _ = smoothed_distance(grid, points)
    assert np.abs(value - signed_distance([U_SHAPE], points)).max() <= 0.82 * CELL


def test_the_gradient_is_that_of_the_smoothed_distance(grid: SignedDistance, points: Floats) -> None:
    _, gradient = smoothed_distance(grid, points)
    for axis in range(2):
        step = 1e-4 * np.eye(2)[axis]
        ahead, behind = (smoothed_distance(grid, points + s)[0] for s in (step, -step))
        assert gradient[:, axis] == pytest.approx((ahead - behind) / 2e-4, abs=1e-6)


def test_the_gradient_has_no_jump_where_samples_or_nearest_edges_change(grid: SignedDistance) -> None:
    y = np.full(20_001, 50.0)  # through both arms, the pocket and its middle
    line = np.stack([np.linspace(-30, 130, 20_001), y], axis=1)
    _, gradient = smoothed_distance(grid, line)
    assert np.abs(np.diff(gradient, axis=0)).max() < 0.01


def test_beside_a_straight_edge_it_is_the_distance_itself(grid: SignedDistance) -> None:
    value, gradient = smoothed_distance(grid, floats([[50, -20]]))
    assert value[0] == pytest.approx(20.0)
    assert gradient[0] == pytest.approx([0.0, -1.0])


def test_beyond_the_grid_it_does_not_change_outward(grid: SignedDistance) -> None:
    value, gradient = smoothed_distance(grid, floats([[50, -500], [50, -900]]))
    assert value[0] == value[1]
    assert gradient[:, 1] == pytest.approx([0.0, 0.0])
