"""What the hand does in the arena arrives complete, in order, and in metres."""

from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

from higvf_console.core.arrays import Floats
from tests.browser import Stage, draw, screenshot, to_page, turn_wheel, wait_for_stop, wait_until

pytestmark = pytest.mark.browser


def figure_eight(count: int, centre: tuple[float, float] = (600.0, 350.0), size: float = 1.0) -> Floats:
    """A self-crossing stroke (count, 2) [m]."""
    angle = np.linspace(0.0, 2 * np.pi, count)
    return np.array(centre) + size * np.stack([300 * np.cos(angle), 200 * np.sin(2 * angle)], axis=1)


def send(page: Page, topic: str, /, **body: Any) -> None:
    page.evaluate(
        "([topic, body]) => window.__viserMutable.sendMessage({ type: 'PageMessage', topic, body })", [topic, body]
    )


def release(page: Page, place: list[float]) -> None:
    page.evaluate(
        "([x, y]) => window.__viserMutable.canvas.dispatchEvent(new PointerEvent('pointerup',"
        " { bubbles: true, composed: true, clientX: x, clientY: y, pointerId: 77 }))",
        place,
    )


@pytest.mark.parametrize("wheel", [0, -900])
def test_a_stroke_of_188_points_at_125_hz_arrives_complete_in_order_and_in_place(
    page: Page, stage: Stage, wheel: int
) -> None:
    turn_wheel(page, [300, 300], wheel)
    stroke = figure_eight(188, size=1.0 if wheel == 0 else 0.2)
    draw(page, to_page(page, stroke), rate=125)
    wait_until(lambda: "end" in stage.phases())
    assert stage.phases() == ["start", "update", "end"]
    assert stage.drawn().shape == (188, 2)
    assert np.abs(stage.drawn() - stroke).max() < 1.0


def test_points_that_the_browser_coalesced_all_arrive(page: Page, stage: Stage) -> None:
    stroke = figure_eight(3000)
    draw(page, to_page(page, stroke), rate=0)
    wait_until(lambda: "end" in stage.phases())
    assert stage.drawn().shape == (3000, 2)
    assert np.abs(stage.drawn() - stroke).max() < 1.0


@pytest.mark.parametrize("kind", ["touch", "pen"])
def test_a_finger_and_a_pen_draw_too(page: Page, stage: Stage, kind: str) -> None:
    draw(page, to_page(page, figure_eight(50)), rate=500, kind=kind)
    wait_until(lambda: "end" in stage.phases())
    assert len(stage.drawn()) == 50


def test_a_press_that_hardly_moves_is_a_click_and_no_stroke(page: Page, stage: Stage) -> None:
    (x, y) = to_page(page, [[400.0, 500.0]])[0]
    draw(page, [[x, y], [x + 1, y - 2]], rate=500)
    draw(page, [[x, y]], rate=0)
    wait_until(lambda: len(stage.clicks) == 2)
    assert all(np.hypot(*(click - [400.0, 500.0])) < 1.0 for click in stage.clicks)
    assert stage.strokes == []


def test_a_real_mouse_clicks_and_draws(page: Page, stage: Stage) -> None:
    start, end = to_page(page, [[400.0, 500.0], [700.0, 300.0]])
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=3)
    page.mouse.up()
    wait_until(lambda: "end" in stage.phases())
    assert np.abs(stage.drawn()[[0, -1]] - [[400.0, 500.0], [700.0, 300.0]]).max() < 2.0
    page.mouse.click(*start)
    wait_until(lambda: len(stage.clicks) == 1)


def test_four_clicks_in_one_go_are_four_clicks(page: Page, stage: Stage) -> None:
    for place in to_page(page, [[100, 100], [200, 100], [300, 100], [400, 100]]):
        draw(page, [place], rate=0)
    wait_until(lambda: len(stage.clicks) == 4)
    assert [round(click[0]) for click in stage.clicks] == [100, 200, 300, 400]


def test_a_browser_that_takes_the_pointer_away_cancels_the_stroke(page: Page, stage: Stage) -> None:
    draw(page, to_page(page, figure_eight(30)), rate=500, finish="pointercancel")
    wait_until(lambda: "cancel" in stage.phases())
    assert "end" not in stage.phases()


def test_escape_cancels_the_stroke_and_the_rest_of_the_drag(page: Page, stage: Stage) -> None:
    places = to_page(page, figure_eight(30))
    draw(page, places, rate=500, finish="")
    page.keyboard.press("Escape")
    release(page, places[-1])
    draw(page, [places[0]], rate=0)
    wait_until(lambda: stage.clicks)
    assert stage.phases() == ["start", "update", "cancel"]


def test_a_connection_lost_in_mid_stroke_cancels_it_on_both_sides(page: Page, stage: Stage) -> None:
    places = to_page(page, figure_eight(30))
    draw(page, places, rate=500, finish="")
    wait_until(lambda: "start" in stage.phases())
    before = set(stage.server.get_clients())
    stage.server._websock_server.disconnect_all_clients()  # pyright: ignore[reportPrivateUsage]
    wait_until(lambda: "cancel" in stage.phases())
    wait_until(lambda: set(stage.server.get_clients()) - before)
    wait_for_stop(page, "ready")
    release(page, places[0])
    wait_until(lambda: len(echo(page)) == 0)
    draw(page, places, rate=500)
    wait_until(lambda: "end" in stage.phases())
    assert stage.phases() == ["start", "update", "cancel", "start", "update", "end"]


def echo(page: Page) -> Floats:
    """Where the echo's points are seen (n, 2), in CSS pixels of the page."""
    return np.array(
        page.evaluate("""() => {
          const hosts = [...document.body.children].filter((node) => node.shadowRoot?.querySelector("polyline.line"));
          const line = hosts[0].shadowRoot.querySelector("polyline.line");
          return [...line.points].map((point) => {
            const { x, y } = point.matrixTransform(line.getScreenCTM());
            return [x, y];
          });
        }""")
    )


def test_the_echo_stays_on_the_ground_when_the_view_is_zoomed_and_goes_when_the_stroke_ends(
    page: Page, stage: Stage
) -> None:
    stroke = figure_eight(60, size=0.4)
    draw(page, to_page(page, stroke), rate=500, finish="")
    assert np.abs(echo(page) - to_page(page, stroke)).max() < 1.0
    turn_wheel(page, [300, 300], -400)
    wait_until(lambda: np.abs(echo(page) - to_page(page, stroke)).max() < 1.0)
    screenshot(page, "echo-zoomed")
    draw(page, to_page(page, figure_eight(20)), rate=500)
    wait_until(lambda: "end" in stage.phases())
    wait_until(lambda: len(echo(page)) == 0)


def test_drawing_takes_the_focus_from_a_field(page: Page, stage: Stage) -> None:
    stage.focus(page, "text")
    draw(page, to_page(page, figure_eight(10)), rate=500)
    assert page.evaluate("document.activeElement === document.body")
    wait_until(lambda: "end" in stage.phases())


def test_the_page_tells_how_it_lies_over_the_ground(page: Page, stage: Stage) -> None:
    turn_wheel(page, [200, 400], -300)
    ground = [[250.0, 150.0], [900.0, 650.0]]
    places = to_page(page, ground)
    wait_until(lambda: stage.viewports and np.abs(stage.viewports[-1].to_ground(np.array(places)) - ground).max() < 1.0)
    assert (stage.viewports[-1].width_px, stage.viewports[-1].height_px) == (1000.0, 640.0)


def test_a_viewport_is_the_whole_page_in_device_pixels(page: Page, stage: Stage) -> None:
    stage.viewports.clear()
    canvas = [100, 60, 600, 500]  # its middle, (400, 310), lies over (10, 20)
    send(page, "viewport", page=[1000, 800], canvas=canvas, pixel_ratio=2, centre=[10, 20], metres_per_px=0.5)
    wait_until(lambda: any(one.width_px == 2000 for one in stage.viewports))  # the page may tell its own besides
    viewport = next(one for one in stage.viewports if one.width_px == 2000)
    assert viewport.height_px == 1600
    ground = viewport.to_ground(2 * np.array([[400.0, 310.0], [500.0, 310.0], [400.0, 410.0]]))
    assert np.allclose(ground, [[10, 20], [60, 20], [10, -30]])


SPOILED: dict[str, dict[str, Any]] = {
    "a number out of range": {"points": [1.0, 1e9]},
    "an odd count": {"points": [1.0, 2.0, 3.0]},
    "a lost packet": {"sequence": 2},
    "another stroke's packet": {"id": 4},
}


def packet(number: int, sequence: int, phase: str, points: list[float]) -> dict[str, Any]:
    return {"id": number, "sequence": sequence, "phase": phase, "points": points, "group": False}


@pytest.mark.parametrize("name", SPOILED)
def test_a_spoiled_packet_cancels_its_stroke_and_the_next_stroke_is_whole(page: Page, stage: Stage, name: str) -> None:
    send(page, "stroke", **packet(3, 0, "start", [1, 2]))
    send(page, "stroke", **packet(3, 1, "update", [3, 4]) | SPOILED[name])
    send(page, "stroke", **packet(3, 2, "end", [5, 6]))
    wait_until(lambda: len(stage.strokes) == 2)
    send(page, "stroke", **packet(9, 0, "start", [5, 6]))
    send(page, "stroke", **packet(9, 1, "end", [7, 8]))
    wait_until(lambda: "end" in stage.phases())
    assert stage.phases() == ["start", "cancel", "start", "end"]
    assert stage.drawn().tolist() == [[1, 2], [5, 6], [7, 8]]


_HAND = """
(events) => {
  for (const [type, init] of events) window.__viserMutable.canvas.dispatchEvent(new PointerEvent(type, {
    bubbles: true, composed: true, cancelable: true, isPrimary: true, ...init }));
}
"""


def act(page: Page, *events: tuple[str, dict[str, Any]]) -> None:
    """Dispatches pointer events in the arena."""
    page.evaluate(_HAND, events)


def at(place: list[float], **more: Any) -> dict[str, Any]:
    return {"clientX": place[0], "clientY": place[1], **more}


PEN: dict[str, Any] = {"pointerType": "pen", "pointerId": 5, "buttons": 1}
PALM: dict[str, Any] = {"pointerType": "touch", "pointerId": 6, "buttons": 1}


def test_a_palm_laid_down_during_a_pen_stroke_neither_ends_it_nor_clicks_nor_draws(page: Page, stage: Stage) -> None:
    places = to_page(page, figure_eight(40))
    palm = [at([places[0][0] + step, places[0][1] + 90], **PALM) for step in range(0, 60, 10)]
    act(page, ("pointerdown", at(places[0], **PEN)), *(("pointermove", at(p, **PEN)) for p in places[1:20]))
    act(page, ("pointerdown", palm[0]), *(("pointermove", rolled) for rolled in palm))
    act(page, *(("pointermove", at(p, **PEN)) for p in places[20:]))
    act(page, ("pointerup", at(places[-1], **PEN | {"buttons": 0})))
    act(page, ("pointermove", palm[-1]), ("pointerup", palm[-1] | {"buttons": 0}))
    wait_until(lambda: "end" in stage.phases())
    page.wait_for_timeout(300)
    assert stage.phases() == ["start", "update", "end"]
    assert len(stage.drawn()) == 40
    assert stage.clicks == []


def test_a_finger_draws_again_when_the_pen_has_been_away(page: Page, stage: Stage) -> None:
    draw(page, to_page(page, figure_eight(10)), rate=500, kind="pen")
    page.wait_for_timeout(1100)
    draw(page, to_page(page, figure_eight(10)), rate=500, kind="touch")
    wait_until(lambda: stage.phases().count("end") == 2)


def test_a_stroke_ends_where_the_left_button_is_released_while_the_right_one_is_held(page: Page, stage: Stage) -> None:
    start, middle, end, elsewhere = to_page(page, [[300.0, 300.0], [400.0, 300.0], [500.0, 400.0], [800.0, 100.0]])
    for place, down, up in ((start, "left", ""), (middle, "right", ""), (end, "", "left"), (elsewhere, "", "right")):
        page.mouse.move(*place, steps=3)
        if down:
            page.mouse.down(button="left" if down == "left" else "right")
        if up:
            page.mouse.up(button="left" if up == "left" else "right")
    wait_until(lambda: {"end", "cancel"} & set(stage.phases()))
    page.wait_for_timeout(300)
    assert stage.phases() == ["start", "update", "end"]
    assert np.abs(stage.drawn()[-1] - [500.0, 400.0]).max() < 2.0
    assert stage.clicks == []


def test_shift_makes_a_click_and_a_stroke_be_about_a_group(page: Page, stage: Stage) -> None:
    places = to_page(page, figure_eight(5))
    mouse = {"pointerType": "mouse", "pointerId": 1, "buttons": 1}
    for shift in (True, False):
        act(page, ("pointerdown", at(places[0], **mouse, shiftKey=shift)), ("pointerup", at(places[0], **mouse)))
        act(page, ("pointerdown", at(places[0], **mouse, shiftKey=shift)))
        act(page, *(("pointermove", at(place, **mouse)) for place in places), ("pointerup", at(places[-1], **mouse)))
    wait_until(lambda: stage.phases().count("end") == 2 and len(stage.clicks) == 2)
    half = len(stage.groups) // 2
    assert set(stage.groups[:half]) == {True}
    assert set(stage.groups[half:]) == {False}
