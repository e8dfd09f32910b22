"""Neighbour lists and components, against the definition."""

import numpy as np
import pytest

from higvf_console.control.intention.neighbours import components, within
from higvf_console.core.arrays import Floats, floats


def by_definition(position: Floats, reach: float) -> list[list[int]]:
    apart = np.hypot(*(position[:, None] - position[None]).transpose(2, 0, 1))
    return [[j for j in range(len(position)) if j != i and apart[i, j] <= reach] for i in range(len(position))]


def listed(position: Floats, reach: float) -> list[list[int]]:
    start, to = within(position, reach)
    assert start.dtype == to.dtype == np.int64
    assert len(to) == start[-1]
    return [to[start[i] : start[i + 1]].tolist() for i in range(len(position))]


@pytest.mark.parametrize("robots", [0, 1, 2, 17, 60, 300])
@pytest.mark.parametrize("reach", [0.0, 5.0, 35.0, 400.0, np.inf])
def test_everyone_in_reach_is_listed_in_the_order_of_the_robots(robots: int, reach: float) -> None:
    rng = np.random.default_rng(robots)
    for width, height in ((200.0, 200.0), (5000.0, 1.0), (1.0, 2000.0)):
        position = rng.uniform(-1.0, 1.0, (robots, 2)) * [width, height]
        assert listed(position, reach) == by_definition(position, reach)


def test_a_neighbour_exactly_at_the_reach_counts_even_across_cells() -> None:
    position = floats([[10.0 * (k % 10), 10.0 * (k // 10)] for k in range(100)])
    assert listed(position, 10.0) == by_definition(position, 10.0)


def test_robots_in_one_place_are_neighbours() -> None:
    assert listed(np.ones((40, 2)), 0.0) == [[j for j in range(40) if j != i] for i in range(40)]


@pytest.mark.parametrize("robots", [3, 40])
def test_a_robot_without_a_position_has_no_neighbours_and_is_nobodys(robots: int) -> None:
    position = np.random.default_rng(1).uniform(0.0, 100.0, (robots, 2))
    position[1, 0] = np.nan
    assert listed(position, 50.0) == by_definition(position, 50.0)
    assert listed(position, 50.0)[1] == []


def test_a_component_is_named_by_its_smallest_robot() -> None:
    line = floats([[0.0, 0.0], [100.0, 0.0], [10.0, 0.0], [110.0, 0.0], [20.0, 0.0], [500.0, 0.0]])
    assert components(*within(line, 10.0)).tolist() == [0, 1, 0, 1, 0, 5]
    assert components(*within(line, np.inf)).tolist() == [0] * 6
    assert components(*within(line[:0], 10.0)).tolist() == []
