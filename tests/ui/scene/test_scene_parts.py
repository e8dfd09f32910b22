"""What is hidden is not sent, and shows the latest state when it is shown."""

import warnings
from collections.abc import Iterator

import numpy as np
import pytest
import viser

from higvf_console.core.arrays import floats
from higvf_console.core.viewport import Arena
from higvf_console.ui.page.guard import new_token, open_server
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.theme import USUAL_LOOK

PLACES = floats([[10.0, 20.0], [30.0, 40.0]])


@pytest.fixture
def canvas() -> Iterator[Canvas]:
    server = open_server("127.0.0.1", 0, new_token(), "parts")
    yield Canvas(server, Arena(0.0, 0.0, 100.0, 60.0), USUAL_LOOK)
    server.stop()


def seen(node: viser.SceneNodeHandle, what: str) -> np.ndarray:
    """What a page has of a node, on the ground."""
    return getattr(node, what)[..., :2]


def test_hidden_marks_stay_where_they_were_until_they_are_shown(canvas: Canvas) -> None:
    marks = canvas.marks(Layer.ROBOT, "/marks", shapes.dart(5.0), count=2, colour="#ffffff")
    node = marks._node  # pyright: ignore[reportPrivateUsage]
    marks.place(PLACES, floats([0.0, np.pi]))
    assert (seen(node, "batched_positions") == PLACES).all()
    marks.show(False)
    marks.place(2 * PLACES, floats([np.pi, np.pi]), floats([3.0, 4.0]))
    assert (seen(node, "batched_positions") == PLACES).all()
    assert not node.visible
    marks.show(True)
    assert (seen(node, "batched_positions") == 2 * PLACES).all()
    assert node.batched_wxyzs[0] == pytest.approx([0, 0, 0, 1], abs=1e-6)
    assert np.asarray(node.batched_scales).tolist() == [3.0, 4.0]
    assert node.visible


def test_hidden_lines_stay_as_they_were_until_they_are_shown(canvas: Canvas) -> None:
    lines = canvas.lines(Layer.LINK, "/lines", None, 1.0)
    node = lines._node  # pyright: ignore[reportPrivateUsage]
    white = np.full((1, 2, 3), 255, np.uint8)
    lines.draw(PLACES[None], white)
    lines.show(False)
    lines.draw(2 * PLACES[None], white // 2)
    assert (seen(node, "points") == PLACES).all()
    lines.show(True)
    assert (seen(node, "points") == 2 * PLACES).all()
    assert (node.colors == white // 2).all()
    lines.show(False)
    lines.draw(floats([], 0, 2, 2))
    lines.show(True)
    assert not node.visible


def test_the_path_and_the_numbers_stand_above_robots_and_obstacles() -> None:
    below = max(Layer.OBSTACLE, Layer.ROBOT, Layer.TRAIL, Layer.HALO)
    above = (Layer.PATH, Layer.CHEVRON, Layer.FIRE_TEXT, Layer.OBSTACLE_TEXT, Layer.ROBOT_TEXT_HALO, Layer.ROBOT_TEXT)
    assert below < min(above)
    assert list(above) == sorted(above)


def test_what_stands_in_a_group_moves_and_goes_with_it(canvas: Canvas) -> None:
    group = canvas.group("/group")
    mesh = canvas.mesh(Layer.OBSTACLE, "/group/body", shapes.dart(5.0), "#ffffff")
    group.move(PLACES[0])
    assert group._node.position.tolist() == [10.0, 20.0, 0.0]  # pyright: ignore[reportPrivateUsage]
    assert mesh._node.name.startswith(group._node.name + "/")  # pyright: ignore[reportPrivateUsage]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        canvas.clear()
