"""Which obstacles form one group, and the way out of the pocket of a group."""

import numpy as np
import pytest

from higvf_console.control.guidance import groups
from higvf_console.control.guidance.groups import group_obstacles
from higvf_console.core.arrays import Floats, floats

R_O = 12.0
U = floats([(0.0, 0.0, 200.0, 0.0, 5.0), (0.0, 200.0, 200.0, 200.0, 5.0), (200.0, 0.0, 200.0, 200.0, 5.0)])

pytestmark = pytest.mark.usefixtures("plain_kernels")


def circles(*at: tuple[float, float, float]) -> Floats:
    return floats([(x, y, x, y, radius) for x, y, radius in at], -1, 5)


def members(parts: Floats) -> list[list[int]]:
    found = group_obstacles(parts, R_O, 1.0)
    start = found.boundary_start[1]
    return [sorted(found.part[start[g] : start[g + 1]].tolist()) for g in range(len(start) - 1)]


def test_no_obstacles_make_no_groups() -> None:
    found = group_obstacles(circles(), R_O, 1.0)
    assert len(found.boundary) == len(found.part) == len(found.hull) == len(found.pocket) == 0


@pytest.mark.parametrize(("gap", "expected"), [(2 * R_O - 1e-6, [[0, 1]]), (2 * R_O + 1e-6, [[0], [1]])])
def test_two_parts_are_one_group_when_no_robot_fits_between_them(gap: float, expected: list[list[int]]) -> None:
    assert members(circles((0.0, 0.0, 10.0), (20.0 + gap, 0.0, 10.0))) == expected


def test_bars_that_cross_are_one_group_although_all_their_ends_are_far_apart() -> None:
    cross = floats([(-300.0, 0.0, 300.0, 0.0, 2.0), (0.0, -300.0, 0.0, 300.0, 2.0)])
    assert members(cross) == [[0, 1]]


def test_a_part_that_is_near_the_hull_of_a_group_belongs_to_it_though_it_is_far_from_every_part() -> None:
    pair = ((0.0, 0.0, 10.0), (40.0, 0.0, 10.0))
    assert members(circles(*pair, (20.0, 34.0, 1.0))) == [[0, 1, 2]], "23 m from the hull, 28.4 m from a part"
    assert members(circles(*pair, (20.0, 36.0, 1.0))) == [[0, 1], [2]]


def test_the_hull_of_a_group_holds_all_its_parts_and_a_lone_part_has_none() -> None:
    found = group_obstacles(circles((0.0, 0.0, 10.0), (40.0, 0.0, 10.0), (500.0, 0.0, 7.0)), R_O, 1.0)
    assert found.boundary_start[0].tolist() == [0, len(found.hull), len(found.hull)], (
        "the hull of the pair, and nothing for the other"
    )
    low, high = found.hull.min(axis=0), found.hull.max(axis=0)
    assert (low <= [-10.0, -9.9]).all()
    assert (high >= [50.0, 9.9]).all()
    assert found.boundary[1].tolist() == [500.0, 0.0, 500.0, 0.0, 7.0, 0.0, 0.0, 0.0, 0.0]


def test_a_group_without_room_for_a_robot_has_no_pocket() -> None:
    found = group_obstacles(circles((0.0, 0.0, 10.0), (40.0, 0.0, 10.0)), R_O, 1.0)
    assert len(found.pocket) == 0


def test_from_anywhere_in_a_pocket_the_way_out_leads_out_and_keeps_the_clearance() -> None:
    found = group_obstacles(U, R_O, 1.0)
    x0, y0, cell, columns = found.boundary[0, -4:]
    way, room = found.pocket[:, :2], found.pocket[:, 2]
    for start in ((150.0, 100.0), (170.0, 170.0), (20.0, 30.0)):
        at = np.array(start)
        for _ in range(200):
            column, row = round((at[0] - x0) / cell), round((at[1] - y0) / cell)
            node = row * int(columns) + column
            assert room[node] >= R_O - cell
            at += 2.0 * way[node]
            if at[0] < -5.0:
                break
        assert at[0] < -5.0, f"from {start} the way ends at {at}"


@pytest.mark.parametrize("block", [1, 7, 1_000_000])
def test_the_sweep_finds_the_near_boxes_however_it_is_cut(monkeypatch: pytest.MonkeyPatch, block: int) -> None:
    monkeypatch.setattr(groups, "_BLOCK", block)
    rng = np.random.default_rng(3)
    low = floats(rng.uniform(0.0, 300.0, (40, 2)))
    high = floats(low + rng.uniform(0.0, 40.0, (40, 2)))
    apart = np.maximum(low[:, None] - high[None], low[None] - high[:, None]).max(axis=2)
    expected = [(i, j) for i in range(40) for j in range(i + 1, 40) if apart[i, j] < 10.0]
    found = groups._near_boxes(low, high, 10.0)  # pyright: ignore[reportPrivateUsage]
    assert sorted(map(tuple, found.tolist())) == expected
