"""The live picture of a camera lies under the arena; a late one is grey and says how old it is."""

from collections.abc import Iterator

import numpy as np
import pytest

from higvf_console.core.team import Picture
from higvf_console.core.viewport import Arena
from higvf_console.ui.page.guard import new_token, open_server
from higvf_console.ui.scene.camera_picture import EVERY, CameraLayer, painted
from higvf_console.ui.scene.parts import Canvas
from higvf_console.ui.theme import USUAL_LOOK

ARENA = Arena(0.0, 0.0, 3.2, 2.0)
RED = np.zeros((200, 320, 3), np.uint8)
RED[..., 0] = 200


@pytest.fixture
def canvas() -> Iterator[Canvas]:
    server = open_server("127.0.0.1", 0, new_token(), "camera")
    yield Canvas(server, ARENA, USUAL_LOOK)
    server.stop()


def test_a_picture_is_faint_and_a_late_one_grey_and_dated() -> None:
    fresh, late, later = (painted(RED, (20, 20, 20), age) for age in (0.2, 3.4, 4.4))
    assert fresh.shape == late.shape == RED.shape
    assert (fresh == (92, 12, 12)).all()
    assert np.abs(np.ptp(late.astype(int), axis=2)).max() == 0  # no colours
    assert late[40:].max() < 50 < late[:30].max()  # but for the words, all of it is dark
    assert (late != later).any()


def test_pictures_are_painted_as_they_come_but_not_too_often(canvas: Canvas) -> None:
    layer, seen = CameraLayer(canvas), []

    def show(taken_at: float, now: float) -> None:
        layer.update(Picture(RED, ARENA, taken_at), now)
        node = layer._node._node  # pyright: ignore[reportPrivateUsage, reportOptionalMemberAccess]
        if not seen or node.image is not seen[-1]:
            seen.append(node.image)
        assert node.visible and node.format == "jpeg"

    layer.update(None, 0.0)
    show(1.0, 1.05)
    show(1.0, 1.3)
    assert len(seen) == 1
    show(1.31, 1.05 + 0.9 * EVERY)
    assert len(seen) == 1
    show(1.31, 1.4)
    assert len(seen) == 2
    for now in (2.5, 2.9, 3.2, 3.4, 4.4):  # 1, 2 and 3 s old
        show(1.31, now)
    assert len(seen) == 5


def test_without_a_picture_nothing_is_shown(canvas: Canvas) -> None:
    layer = CameraLayer(canvas)
    layer.update(Picture(RED, ARENA, 1.0), 1.0)
    layer.update(None, 1.1)
    assert not layer._node._node.visible  # pyright: ignore[reportPrivateUsage, reportOptionalMemberAccess]
