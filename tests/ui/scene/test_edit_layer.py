"""What is chosen is put in place before it is shown, and its handles are shown only where they can be held."""

from collections.abc import Iterator

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.edits import EntityKind
from higvf_console.ui.interaction.grips import Drag
from higvf_console.ui.page.guard import new_token, open_server
from higvf_console.ui.scene.edit import EditLayer
from higvf_console.ui.scene.group import GroupLayer
from higvf_console.ui.scene.parts import Canvas
from higvf_console.ui.theme import USUAL_LOOK
from higvf_console.world.editing.entities import EntityRef
from tests.teams import team

SETUP = team(robots=[(100.0, 100.0), (300.0, 100.0)], fires=[(600.0, 350.0, 30.0), (900.0, 350.0, 30.0)])
FIRST, SECOND = EntityRef(EntityKind.FIRE, 0), EntityRef(EntityKind.FIRE, 1)


@pytest.fixture
def canvas() -> Iterator[Canvas]:
    server = open_server("127.0.0.1", 0, new_token(), "edit")
    yield Canvas(server, SETUP.arena, USUAL_LOOK)
    server.stop()


def test_a_choice_and_its_handle_are_in_place_before_they_are_seen(canvas: Canvas) -> None:
    layer = EditLayer(canvas, SETUP)
    square, outline = layer._square._node, layer._chosen._node  # pyright: ignore[reportPrivateUsage]
    assert not square.visible
    for place, x in ((FIRST, 630.0), (SECOND, 930.0)):
        layer.update(SETUP.start, place, None)
        assert (square.visible, outline.visible) == (False, False)
        assert square.batched_positions[0, 0] == x
        assert np.abs(outline.points[..., 0] - x).min() < 1.0
        layer.update(SETUP.start, place, None)
        assert (square.visible, outline.visible) == (True, True)
    layer.update(SETUP.start, SECOND, None, handles=False)
    assert (square.visible, outline.visible) == (False, True)
    layer.update(SETUP.start, None, None)
    assert (square.visible, outline.visible) == (False, False)


def test_the_ghost_of_what_is_held_is_in_place_before_it_is_seen(canvas: Canvas) -> None:
    layer = EditLayer(canvas, SETUP)
    ghost = layer._ghost._node  # pyright: ignore[reportPrivateUsage]
    drag = Drag(floats([600.0, 350.0]), floats([700.0, 350.0]), FIRST)
    layer.update(SETUP.start, FIRST, drag)
    assert not ghost.visible
    assert ghost.points[..., 0].max() == pytest.approx(730.0, abs=0.1)
    layer.update(SETUP.start, FIRST, drag)
    assert ghost.visible
    layer.update(SETUP.start, FIRST, None)
    assert not ghost.visible


def test_the_robots_of_a_group_wear_rings(canvas: Canvas) -> None:
    layer = GroupLayer(canvas, SETUP.layout)
    rings = layer._rings._node  # pyright: ignore[reportPrivateUsage]
    layer.update(SETUP.start, frozenset({1, 7}))
    assert rings.visible
    assert np.abs(rings.points.mean(axis=(0, 1))[:2] - [300.0, 100.0]).max() < 1.0
    layer.update(SETUP.start, frozenset())
    assert not rings.visible
