"""How the console looks, in a real browser: themes, text sizes, alarms that stay, first steps, every tab's layout."""

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from higvf_console.core.commands import AskReset, EmergencyStop, Freeze, Pick, ResetEmergencyStop, ResetRun
from higvf_console.ui.theme import DARK, LIGHT, TEXT_SIZES, THEMES, USUAL_LOOK, hex_rgb
from higvf_console.ui.ui_state import UiStore
from tests.browser import (
    draw,
    open_console,
    screenshot,
    tab,
    to_page,
    told,
    wait_for_console,
    wait_until,
)
from tests.consoles import Running, console_at_work
from tests.teams import stroke

pytestmark = pytest.mark.browser
SIZES = ((1280, 720), (1920, 1080))
# Rectangles (left, top, right, bottom) [CSS px] of what shares the page, and what is wrong inside the panel.
_LAYOUT = """
() => {
  const shadows = [...document.body.children].map((host) => host.shadowRoot).filter(Boolean);
  const overlay = (selector) => shadows.map((root) => root.querySelector(selector)).find(Boolean);
  const tabs = [...document.querySelectorAll("[role=tab]")].filter((tab) => tab.checkVisibility());
  const row = tabs[0].parentElement;
  const box = (node) => {
    const { left, top, right, bottom } = node.getBoundingClientRect();
    return [left, top, right, bottom];
  };
  const panels = [...document.querySelectorAll(".hg")].filter((node) => node.checkVisibility());
  const wide = (node) => node.scrollWidth > node.clientWidth + 1;
  return {
    boxes: {
      strip: box(overlay(".status")),
      panel: [box(row)[0], box(row)[1], window.innerWidth, window.innerHeight],
      stop: box(overlay("button.stop")),
      help: box(overlay("button.ask")),
      hints: box(overlay(".strip")),
    },
    page: [window.innerWidth, window.innerHeight],
    row: box(row),
    tabs: tabs.map(box),
    cut: [...tabs.map((tab) => tab.firstElementChild ?? tab), ...panels].filter(wide).map((node) => node.textContent),
    clipped: [...overlay(".strip").querySelectorAll("li:not(.spare)"), overlay("button.stop")]
      .filter((node) => node.scrollHeight > node.clientHeight + 1 || wide(node)).map((node) => node.textContent),
    sideways: document.documentElement.scrollWidth > window.innerWidth,
  };
}
"""
# Whether the panel has come to the right edge of the page, and all that was in motion to rest.
_AT_REST = """
() => window.innerWidth - document.querySelector("[role=tab]").parentElement.getBoundingClientRect().right < 40
  && !document.getAnimations().some((animation) => animation.playState === "running")
"""


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    """The firefighting scenario, live."""
    with console_at_work("firefighting") as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    """A page of a browser that never showed the console before."""
    page = open_console(chromium, running.url, *SIZES[0], hints=True, smooth=True)
    yield page
    page.context.close()


@pytest.fixture
def ui(running: Running) -> Iterator[UiStore]:
    """What is chosen to be seen; as usual again after the test."""
    ui = running.console.ui
    yield ui
    ui.update(look=USUAL_LOOK, alarms=())
    running.push(AskReset(), ResetEmergencyStop(), ResetRun())
    wait_until(lambda: not running.state.intent.stopped)


def choose(page: Page, label: str, option: str) -> None:
    page.get_by_label(label, exact=True).first.click()
    page.get_by_role("option", name=option, exact=True).click()


def pixel(page: Page, ground: tuple[float, float]) -> np.ndarray:
    """What is seen at a ground point [m]: red, green, blue."""
    picture = np.asarray(cv2.imdecode(np.frombuffer(page.screenshot(), np.uint8), cv2.IMREAD_COLOR))
    x, y = to_page(page, [ground])[0]
    return picture[round(y), round(x), ::-1].astype(int)


def surround(page: Page) -> str:
    """Background of the canvas, as CSS has it."""
    return page.evaluate("""() => {
      let node = __viserMutable.canvas;
      while (getComputedStyle(node).backgroundColor === "rgba(0, 0, 0, 0)") node = node.parentElement;
      return getComputedStyle(node).backgroundColor;
    }""")


def overlap(one: list[float], other: list[float]) -> bool:
    """Whether two rectangles (left, top, right, bottom) share any area."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    return width > 0.5 and min(one[3], other[3]) - max(one[1], other[1]) > 0.5


def steps(page: Page) -> list[str]:
    """The hints that are shown, each with a tick if it is done."""
    return page.locator(".strip.open li").evaluate_all(
        "(items) => items.map(({ className, children }) =>"
        " children[1].textContent + (className.includes('done') ? ' ✓' : ''))"
    )


def test_the_first_steps_are_ticked_when_done_and_come_back_from_the_key_list(
    page: Page,
    running: Running,
    ui: UiStore,  # noqa: ARG001 - puts all back
) -> None:
    assert steps(page) == ["Draw a path", "Pick a robot", "Space stops"]
    screenshot(page, "hints")
    draw(page, to_page(page, [[300 + 10 * k, 600] for k in range(30)]), rate=500)
    wait_until(lambda: "Draw a path ✓" in steps(page))
    draw(page, to_page(page, running.state.motion.position[1:2]), rate=0)
    wait_until(lambda: "Pick a robot ✓" in steps(page))
    page.reload()
    wait_for_console(page)
    wait_until(lambda: steps(page) == ["Draw a path ✓", "Pick a robot ✓", "Space stops"])
    page.keyboard.press("Space")
    wait_until(lambda: steps(page) == [])  # all done: the strip goes
    page.reload()
    wait_for_console(page)
    assert steps(page) == []
    page.locator("button.ask").click()
    screenshot(page, "keys")
    hidden = page.get_by_role("dialog", name="Keys").evaluate("(list) => list.scrollHeight - list.clientHeight")
    assert hidden == 0, "all keys are seen at once"
    page.locator("button.again").click()
    assert steps(page) == ["Draw a path", "Pick a robot", "Space stops"]
    page.locator(".strip button").click()
    assert steps(page) == []


def test_theme_and_text_size_are_chosen_in_the_view_panel_and_hold_for_a_reload(page: Page, ui: UiStore) -> None:
    tab(page, "View")
    size = "parseFloat(getComputedStyle(document.querySelector('.hg')).fontSize)"
    usual = page.evaluate(size)
    assert surround(page) == f"rgb{hex_rgb(DARK.surround)}"
    choose(page, "Theme", "Light")
    choose(page, "Text size", "Large")
    wait_until(lambda: surround(page) == f"rgb{hex_rgb(LIGHT.surround)}")
    wait_until(lambda: np.abs(pixel(page, (450.0, 650.0)) - hex_rgb(LIGHT.floor)).max() < 4)
    wait_until(lambda: page.evaluate(size) / usual == pytest.approx(TEXT_SIZES["Large"]))
    page.reload()
    wait_for_console(page)
    wait_until(lambda: surround(page) == f"rgb{hex_rgb(LIGHT.surround)}")
    wait_until(lambda: np.abs(pixel(page, (450.0, 650.0)) - hex_rgb(LIGHT.floor)).max() < 4)
    tab(page, "View")
    wait_until(lambda: page.get_by_label("Theme", exact=True).first.input_value() == "Light")
    assert ui.state.look.palette is LIGHT


def stop_again(running: Running) -> None:
    """Resets a STOP and stops anew: one after the other, for a STOP overtakes a reset that waits."""
    running.push(AskReset(), ResetEmergencyStop())
    wait_until(lambda: not running.state.intent.stopped)
    running.push(EmergencyStop())
    wait_until(lambda: running.state.intent.stopped)


def test_an_alarm_stays_until_it_is_read_or_its_cause_ends(page: Page, running: Running, ui: UiStore) -> None:
    def counted() -> str:
        return page.locator(".status .alarms").inner_text()

    running.push(EmergencyStop())
    wait_until(told(page, "all robots stand still"))
    wait_until(lambda: counted() == "1 alarm")
    page.get_by_role("button", name="Read", exact=True).click()
    wait_until(lambda: counted() == "")
    assert ui.state.alarms == ()
    stop_again(running)
    wait_until(lambda: counted() == "1 alarm")
    tab(page, "Log")
    wait_until(lambda: page.locator(".hg .log .alarm:visible").count() == 1)
    page.get_by_role("button", name="Acknowledge 1 alarm").click()
    wait_until(lambda: counted() == "")
    assert running.state.intent.stopped, "to acknowledge commands nothing"
    stop_again(running)
    wait_until(lambda: counted() == "1 alarm")
    running.push(AskReset(), ResetEmergencyStop())
    wait_until(lambda: counted() == "")


@pytest.mark.parametrize(("width", "height"), SIZES)
@pytest.mark.parametrize("theme", THEMES)
def test_nothing_overlaps_or_overflows_in_any_tab(
    page: Page, running: Running, ui: UiStore, theme: str, width: int, height: int
) -> None:
    ui.update(look=USUAL_LOOK._replace(palette=THEMES[theme]))
    page.set_viewport_size({"width": width, "height": height})
    shipped = running.session.scenario.strokes[0]
    running.push(Freeze(False), Pick(0), *stroke(shipped.points, shipped.robot))
    page.evaluate("window.higvf.call('hints', 'reopen')")
    wait_until(lambda: running.state.motion.tick > 100)
    running.push(EmergencyStop())
    wait_until(told(page, "all robots stand still"))
    wait_until(lambda: surround(page) == f"rgb{hex_rgb(THEMES[theme].surround)}")
    names = page.get_by_role("tab").all_inner_texts()
    for name in names:
        tab(page, name)
        page.wait_for_function(_AT_REST, polling=50)
        screenshot(page, f"{theme}-{width}x{height}-{name}".lower())
        check_layout(page.evaluate(_LAYOUT))
    assert len(names) >= 6


def check_layout(found: dict[str, Any]) -> None:
    boxes, (width, height) = found["boxes"], found["page"]
    assert [pair for pair in combinations(boxes, 2) if overlap(boxes[pair[0]], boxes[pair[1]])] == []
    for name, (left, top, right, bottom) in boxes.items():
        assert left >= 0, name
        assert top >= 0, name
        assert right <= width, name
        assert bottom <= height, name
    left, top, right, bottom = found["row"]
    for box in found["tabs"]:
        assert left <= box[0] < box[2] <= right + 0.5
        assert top <= box[1] < box[3] <= bottom + 0.5
    assert len({box[1] for box in found["tabs"]}) == 1, "the tabs need more than one row"
    assert found["cut"] == []
    assert found["clipped"] == []
    assert not found["sideways"]
