"""Moving obstacles are drawn where they are, with their course and the way that they go in two seconds."""

from typing import Any, cast

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.ui.scene.ground import obstacle_bodies, obstacle_surfaces
from higvf_console.ui.scene.labels import named
from higvf_console.ui.scene.movers import AHEAD, Movers, course_line, velocity_arrows
from higvf_console.ui.scene.parts import Canvas
from higvf_console.ui.theme import DARK
from higvf_console.world.obstacles import Obstacles, course_along, course_straight
from higvf_console.world.setup import Setup
from tests.moving import with_obstacles
from tests.teams import team

PX = 1.0  # [m]
LOOP = course_along([(300.0, 300.0), (300.0, 500.0), (400.0, 500.0)], 20.0, loop=True)
STRAIGHT = course_straight(12.0, 5.0)


def site() -> Setup:
    circles = floats([[900.0, 600.0, 25.0], [300.0, 300.0, 20.0]])
    bars = floats([[600.0, 150.0, 600.0, 250.0, 6.0]])
    return with_obstacles(team(), Obstacles(circles, bars, (), (None, LOOP), (STRAIGHT,)))


def test_what_stands_still_is_drawn_apart_from_what_moves() -> None:
    assert len(obstacle_surfaces(site())) == 1
    assert obstacle_bodies(site()).vertices.mean(axis=0) == pytest.approx([900.0, 600.0], abs=1e-6)


def test_the_course_of_a_loop_is_closed_and_that_of_a_velocity_leads_through_the_obstacle() -> None:
    (circle, loop), (bar, straight) = site().layout.obstacles.movers()
    assert course_line(circle, loop, site()).tolist() == [[300, 300], [300, 500], [400, 500], [300, 300]]
    start, end = course_line(bar, straight, site())
    assert start.tolist() == [600.0, 200.0]
    assert (end - start) / np.hypot(*(end - start)) == pytest.approx([12 / 13, 5 / 13])


def test_an_arrow_starts_at_the_surface_and_shows_the_way_of_two_seconds() -> None:
    arrows = velocity_arrows(site(), 100, PX)
    circle, bar = arrows[0], arrows[3]
    assert circle[0] == pytest.approx([300.0, 340.0 + 20.0])
    assert circle[1] - circle[0] == pytest.approx([0.0, 20.0 * AHEAD])
    assert bar[1] - bar[0] == pytest.approx([12.0 * AHEAD, 5.0 * AHEAD])


def test_what_has_come_to_the_end_of_its_path_has_no_arrow() -> None:
    obstacles = Obstacles(
        floats([[0.0, 0.0, 20.0]]), floats([], 0, 5), (), (course_along([(0, 0), (10, 0)], 5.0, False),)
    )
    setup = with_obstacles(team(), obstacles)
    assert len(velocity_arrows(setup, 0, PX)) == 3
    assert len(velocity_arrows(setup, 500, PX)) == 0


class Node:
    """Notes what is asked of it."""

    def __init__(self) -> None:
        self.moves: list[list[float]] = []

    def move(self, origin: Any) -> None:
        self.moves.append(origin.tolist())

    def draw(self, *_: object) -> None:
        pass

    def show(self, _visible: bool) -> None:
        pass


class Sheet:
    """A canvas that keeps its nodes by name."""

    palette, px = DARK, PX

    def __init__(self) -> None:
        self.nodes: dict[str, Node] = {}

    def _add(self, name: str) -> Node:
        return self.nodes.setdefault(name, Node())

    def group(self, name: str) -> Node:
        return self._add(name)

    def mesh(self, _layer: object, name: str, *_: object) -> Node:
        return self._add(name)

    def lines(self, _layer: object, name: str, *_: object) -> Node:
        return self._add(name)


def test_fill_and_outlines_of_what_moves_are_moved_as_one() -> None:
    sheet, setup = Sheet(), site()
    movers = Movers(cast(Canvas, sheet), setup)
    motion = setup.start.motion._replace(tick=100)
    movers.update(setup.start._replace(motion=motion), boundaries=True)
    assert {name for name, node in sheet.nodes.items() if node.moves} == {"/movers/0", "/movers/1"}
    for part in ("body", "edge", "reactive", "repulsive"):
        assert f"/movers/0/{part}" in sheet.nodes
    assert sheet.nodes["/movers/0"].moves == [pytest.approx([0.0, 40.0])]


def test_obstacles_are_named_as_messages_name_them_where_they_are() -> None:
    found = named(site().layout.obstacles_at(100))
    assert [name for name, _ in found] == ["circle 1", "circle 2", "bar 1"]
    assert found[1][1] == pytest.approx([300.0, 340.0])
    assert found[2][1] == pytest.approx([600.0 + 24.0, 200.0 + 10.0])
