"""The camera stays straight above the arena, whatever is pressed."""

import itertools
from collections.abc import Callable, Iterator

import cv2
import numpy as np
import pytest
from playwright.sync_api import Page

from higvf_console.core.arrays import Floats
from higvf_console.core.viewport import Arena
from higvf_console.ui.interaction import camera
from tests.browser import (
    ARENA,
    Stage,
    draw,
    screenshot,
    to_page,
    turn_wheel,
    wait_for_console,
    wait_until,
)

pytestmark = pytest.mark.browser

FRAMES = "window.__viserTestpoints.rendererInfo.render.frame"


def corners(page: Page, arena: Arena = ARENA) -> Floats:
    """Where the arena's corners are seen (4, 2), in CSS pixels of the page."""
    return np.array(to_page(page, list(itertools.product((arena.x_min, arena.x_max), (arena.y_min, arena.y_max)))))


def is_fitted(page: Page, arena: Arena = ARENA) -> bool:
    """Whether the arena lies inside the canvas, upright, as large as it can, clear of the STOP button."""
    seen = corners(page, arena)
    left, top, right, bottom = page.evaluate(
        "(({ left, top, right, bottom }) => [left, top, right, bottom])"
        "(window.__viserMutable.canvas.getBoundingClientRect())"
    )
    button = page.locator("button.stop").bounding_box()
    assert button is not None
    width, height = np.ptp(seen, axis=0)
    free = np.array([right - left - width, bottom - top - height])
    room = np.array(
        [camera.PADDING["left"] + camera.PADDING["right"], camera.PADDING["top"] + camera.PADDING["bottom"]]
    )
    return bool(
        left < seen[:, 0].min()
        and seen[:, 0].max() < right
        and top < seen[:, 1].min()
        and seen[:, 1].max() < button["y"]
        and seen[1, 1] < seen[0, 1]  # y points up
        and abs(width / height - arena.width / arena.height) < 0.01
        and np.abs(free - room).min() < 2
    )


def brightness(page: Page, x: float, y: float) -> float:
    """Of the picture round a point of the page, 0 to 255."""
    png = page.screenshot(clip={"x": x - 5, "y": y - 5, "width": 10, "height": 10})
    return float(np.mean(np.asarray(cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR))))


def test_the_arena_fits_a_page_of_any_shape_and_after_a_reload(page: Page) -> None:
    for width, height in ((700, 760), (1000, 420), (1000, 640)):
        page.set_viewport_size({"width": width, "height": height})
        wait_until(lambda size=(width, height): page.evaluate("[innerWidth, innerHeight]") == list(size))
        wait_until(lambda: is_fitted(page))
    page.reload()
    wait_for_console(page)
    wait_until(lambda: is_fitted(page))


@pytest.fixture
def page_of(page: Page, stage: Stage) -> Iterator[Callable[[Arena], Page]]:
    """Shows another arena, with a bright floor, on the shared page; afterwards its own again."""

    def show(arena: Arena) -> Page:
        camera.install(stage.server, arena)
        corners = np.array([[x, y, 0.0] for x in (arena.x_min, arena.x_max) for y in (arena.y_min, arena.y_max)])
        stage.server.scene.add_mesh_simple("/other", corners, np.array([[0, 2, 3], [0, 3, 1]]), color=(250, 250, 250))
        return page

    yield show
    stage.server.scene.remove_by_name("/other")
    camera.install(stage.server, ARENA)
    wait_until(lambda: is_fitted(page, ARENA))


@pytest.mark.parametrize("arena", [Arena(-5000.0, -4000.0, 5000.0, 4000.0), Arena(-1.2, 0.0, 0.9, 1.6)], ids=str)
def test_arenas_of_ten_kilometres_and_of_two_metres_are_seen(page_of: Callable[[Arena], Page], arena: Arena) -> None:
    page = page_of(arena)
    wait_until(lambda: is_fitted(page, arena))
    x, y = to_page(page, [[(arena.x_min + arena.x_max) / 2, (arena.y_min + arena.y_max) / 2]])[0]
    wait_until(lambda: brightness(page, x, y) > brightness(page, x, 10) + 30)
    screenshot(page, f"arena-{arena.width:.0f}m")


def wait_for_frames(page: Page, count: int = 3) -> None:
    """Waits until viser has drawn that many frames."""
    first = page.evaluate(FRAMES)
    wait_until(lambda: page.evaluate(FRAMES) >= first + count)


def test_keys_that_drive_visers_camera_move_nothing(page: Page) -> None:
    before = corners(page)
    for key in ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "w", "a", "s", "d", "q", "e"):
        page.keyboard.down(key)
        wait_for_frames(page)
        page.keyboard.up(key)
        assert np.abs(corners(page) - before).max() < 1e-3, key


@pytest.mark.parametrize("move", ["rotate(0.4, 0.3, false)", "truck(200, 100, false)", "dollyTo(500, false)"])
def test_whatever_else_moves_the_camera_it_goes_back(page: Page, move: str) -> None:
    before = corners(page)
    page.evaluate(f"() => {{ window.__viserMutable.cameraControl.{move}; }}")
    wait_for_frames(page)
    assert np.abs(corners(page) - before).max() < 1e-3


def test_the_wheel_zooms_to_the_pointer(page: Page) -> None:
    ground = [[300.0, 500.0]]
    place = to_page(page, ground)[0]
    turn_wheel(page, place, -240, -240, 120)
    assert np.ptp(corners(page)[:, 0]) > 640
    assert np.abs(np.array(to_page(page, ground)[0]) - place).max() < 1.0


def test_the_wheel_never_loses_the_arena(page: Page) -> None:
    turn_wheel(page, [60, 60], *[2000] * 8)
    seen = corners(page)
    assert np.ptp(seen[:, 0]) > 200
    assert seen.min() > -100


@pytest.mark.parametrize("button", [1, 2])
def test_the_right_and_the_middle_button_pan_and_draw_nothing(page: Page, stage: Stage, button: int) -> None:
    before = corners(page)
    draw(page, [[400, 400], [420, 380], [450, 330]], rate=100, button=button)
    assert np.abs(corners(page) - before - [50, -70]).max() < 1.0
    assert stage.strokes == [] and stage.clicks == []


def test_key_f_fits_the_view_again(page: Page) -> None:
    before = corners(page)
    turn_wheel(page, [300, 300], -600)
    assert np.abs(corners(page) - before).max() > 50
    page.keyboard.press("f")
    wait_until(lambda: np.abs(corners(page) - before).max() < 1)


PINCH = """
([from, to]) => {
  const canvas = window.__viserMutable.canvas;
  const fire = (type, [x, y], id) => canvas.dispatchEvent(new PointerEvent(type, { bubbles: true, composed: true,
    clientX: x, clientY: y, pointerId: id, isPrimary: id === 1, pointerType: "touch",
    button: type === "pointermove" ? -1 : 0 }));
  from.forEach((place, i) => fire("pointerdown", place, i + 1));
  to.forEach((place, i) => fire("pointermove", place, i + 1));
  to.forEach((place, i) => fire("pointerup", place, i + 1));
}
"""


def test_two_fingers_zoom_and_pan_and_draw_nothing(page: Page, stage: Stage) -> None:
    ground = [[400.0, 300.0], [600.0, 300.0]]
    fingers = to_page(page, ground)
    goal = [[fingers[0][0] - 60, fingers[0][1] - 40], [fingers[1][0] + 80, fingers[1][1] - 40]]
    page.evaluate(PINCH, [fingers, goal])
    assert np.abs(np.array(to_page(page, ground)) - goal).max() < 1.0
    assert "end" not in stage.phases() and stage.clicks == []
