"""Chains of points are turned the right way, known to cross themselves, and measured from outside and inside."""

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.world.build import edge_bars
from higvf_console.world.polygons import (
    crossing,
    obstacles_of,
    oriented,
    signed_area,
    signed_distance,
    without_repeats,
)

SQUARE = floats([[0, 0], [100, 0], [100, 100], [0, 100]])
YARD = floats([[20, 20], [20, 80], [80, 80], [80, 20]])  # clockwise: a free area inside
L_SHAPE = floats([[0, 0], [100, 0], [100, 30], [30, 30], [30, 100], [0, 100]])


def test_a_chain_is_turned_the_way_that_is_asked_for() -> None:
    for chain in (L_SHAPE, L_SHAPE[::-1]):
        assert signed_area(oriented(chain)) == 5100.0
        assert signed_area(oriented(chain, clockwise=True)) == -5100.0


def test_a_chain_far_from_the_origin_keeps_its_area() -> None:
    assert signed_area(0.01 * L_SHAPE + np.array([1e6 / 3, 1e6 / 7])) == pytest.approx(0.51, rel=1e-8)


def test_repeated_points_and_a_last_one_that_is_the_first_are_dropped() -> None:
    points = floats([[0, 0], [0, 0], [9, 0], [9, 9], [9, 9], [0, 0]])
    assert {tuple(point) for point in without_repeats(points).tolist()} == {(0.0, 0.0), (9.0, 0.0), (9.0, 9.0)}
    assert len(without_repeats(points)) == 3


def test_edges_become_bars_without_width_that_close_the_chain() -> None:
    bars = edge_bars([SQUARE, YARD])
    assert bars.shape == (8, 5)
    assert (bars[:, 4] == 0.0).all()
    assert bars[3].tolist() == [0, 100, 0, 0, 0]
    assert bars[7].tolist() == [80, 20, 20, 20, 0]
    assert edge_bars([]).shape == (0, 5)


def test_free_areas_belong_to_the_obstacle_before_them() -> None:
    assert [len(chains) for chains in obstacles_of([SQUARE, YARD, L_SHAPE])] == [2, 1]


@pytest.mark.parametrize(
    ("chain", "edges"),
    [
        (SQUARE, None),
        (L_SHAPE, None),
        (floats([[0, 0], [50, 0], [100, 0], [50, 80]]), None),  # a corner on a straight edge
        (floats([[0, 0], [100, 100], [100, 0], [0, 100]]), (0, 2)),  # a bow tie
        (floats([[0, 0], [100, 0], [50, 0], [50, 80]]), (0, 1)),  # folds back
        (floats([[0, 0], [100, 0], [100, 50], [50, 0], [0, 50]]), (0, 2)),  # a corner on another edge
    ],
)
def test_a_chain_that_crosses_touches_or_folds_back_on_itself_is_known_by_two_edges(
    chain: Floats, edges: tuple[int, int] | None
) -> None:
    assert crossing([chain]) == edges


def test_two_chains_that_cross_each_other_are_known_too() -> None:
    assert crossing([SQUARE, YARD]) is None
    assert crossing([SQUARE, YARD + np.array([50, 0])]) == (1, 5)


@pytest.mark.parametrize(
    ("point", "distance"),
    [((50, 15), -15.0), ((10, 90), -10.0), ((65, 65), 35.0), ((130, -40), 50.0), ((-7, 50), 7.0)],
)
def test_the_distance_from_a_shape_that_is_not_convex(point: tuple[float, float], distance: float) -> None:
    assert signed_distance([L_SHAPE], floats([point]))[0] == pytest.approx(distance)


def test_a_free_area_inside_is_outside_the_obstacle() -> None:
    assert signed_distance([SQUARE, YARD], floats([[50, 50], [10, 50], [-5, 50]])) == pytest.approx([30, -10, 5])


def test_a_ray_through_corners_does_not_fool_the_side() -> None:
    diamond = floats([[0, -10], [10, 0], [0, 10], [-10, 0]])
    assert (signed_distance([diamond], floats([[-20, 0], [-20, 10], [-20, -10], [20, 0]])) > 0).all()
    assert signed_distance([diamond], floats([[-5, 0]]))[0] < 0
