"""On a phone and in small windows nothing of the console lies outside the page, or on what else it has."""

import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import combinations
from time import sleep

import pytest
from playwright.sync_api import Browser, Locator, Page

from higvf_console.core.commands import AskReset, EmergencyStop, Freeze, ResetEmergencyStop
from higvf_console.ui.alarms import acknowledge_alarms
from tests.browser import open_console, screenshot, told, wait_until
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser

_CANVAS = (
    "(() => { const r = __viserMutable.canvas.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom] })()"
)
_BOXES = """
(found) => found.map((node) => {
  const { left, top, right, bottom } = node.getBoundingClientRect();
  return [left, top, right, bottom];
})
"""
# Keeps every text that the line of the latest message has from now on.
_KEEP_LINES = """
(line) => {
  window.keptLines = [];
  const keep = (records) => {
    for (const record of records) for (const node of record.addedNodes) window.keptLines.push(node.textContent);
  };
  new MutationObserver(keep).observe(line, { childList: true });
}
"""
_BUTTONS = ".tools button, .status button:visible, .roles"
Box = tuple[float, float, float, float]


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    """The firefighting scenario, live."""
    with console_at_work("firefighting") as running:
        yield running


@pytest.fixture(scope="module")
def phone(chromium: Browser, running: Running) -> Iterator[Page]:
    """A phone that watches what another page steers, which gives it a strip of roles."""
    first = open_console(chromium, running.url)
    page = open_console(chromium, running.url, 390, 844, touch=True, smooth=True)
    page.locator(".roles.open").wait_for()
    yield page
    page.context.close()
    first.context.close()


def box(found: Locator) -> Box:
    """Left, top, right, bottom [CSS px]."""
    place = found.bounding_box()
    assert place is not None
    return place["x"], place["y"], place["x"] + place["width"], place["y"] + place["height"]


def settled(wrong: Callable[[], list[object]], tries: int = 60) -> None:
    """Waits until nothing is wrong or missing any more: the page lays itself out a few frames later."""
    for _ in range(tries):
        with suppress(AssertionError):
            if not wrong():
                return
        sleep(0.25)
    assert wrong() == []


def inside(one: Box, other: Box) -> bool:
    return other[0] <= one[0] and other[1] <= one[1] and one[2] <= other[2] and one[3] <= other[3]


def apart(one: Box, other: Box) -> bool:
    return one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


@pytest.mark.parametrize(("width", "height"), [(390, 844), (768, 1024), (900, 600), (1280, 720)])
def test_strip_tools_arena_stop_and_panel_stay_in_the_page_and_off_each_other(
    phone: Page, width: int, height: int
) -> None:
    phone.set_viewport_size({"width": width, "height": height})
    parts = {"strip": ".status", "tools": ".tools", "stop": "button.stop", "help": "button.ask"}

    def boxes() -> dict[str, Box]:
        tabs = box(phone.get_by_role("tab").first)
        panel = (0.0 if height > width else tabs[0], tabs[1], float(width), float(height))
        return {name: box(phone.locator(part)) for name, part in parts.items()} | {"panel": panel}

    def wrong() -> list[object]:
        found = boxes()
        inner = dict(enumerate(phone.locator(_BUTTONS).evaluate_all(_BOXES)))
        canvas = phone.evaluate(_CANVAS)
        out = [
            (name, place)
            for name, place in {**found, **inner, "canvas": canvas}.items()
            if place[0] < 0 or place[1] < 0 or place[2] > width or place[3] > height
        ]
        overlapping = [pair for pair in combinations(found, 2) if not apart(found[pair[0]], found[pair[1]])]
        beside = [(name, found[name], canvas) for name in ("strip", "panel") if not apart(canvas, found[name])]
        outside = [(name, found[name]) for name in ("tools", "stop", "help") if not inside(found[name], canvas)]
        return [*out, *overlapping, *beside, *outside]

    settled(wrong)
    screenshot(phone, f"phone-{width}x{height}")


def test_a_message_of_viser_is_told_in_the_line_and_not_over_the_arena(phone: Page, running: Running) -> None:
    for client in running.server.get_clients().values():
        client.add_notification("Note", "Some words that the operator shall read.", auto_close_seconds=None)
    wait_until(told(phone, "Note: Some words that the operator shall read."), 20.0)
    assert not phone.locator(".mantine-Notification-root").first.is_visible()


def test_a_page_that_a_processor_draws_is_no_message(phone: Page, running: Running) -> None:
    phone.locator(".status .message span").evaluate(_KEEP_LINES)
    for client in running.server.get_clients().values():
        for title in ("Software WebGL rendering detected", "WebGL unavailable"):
            client.add_notification(title, "Check the settings.", auto_close_seconds=None)
    wait_until(lambda: "WebGL unavailable: Check the settings." in phone.evaluate("window.keptLines"), 20.0)
    phone.wait_for_function("() => !document.querySelector('.mantine-Notification-root')")
    assert not [line for line in phone.evaluate("window.keptLines") if "Software" in line]


@pytest.mark.parametrize(("width", "height"), [(390, 844), (1280, 720)])
def test_the_alarms_open_the_log_also_where_the_panel_is_folded(
    phone: Page, running: Running, width: int, height: int
) -> None:
    phone.set_viewport_size({"width": width, "height": height})
    sheet = phone.locator('.mantine-Paper-root[style*="position: fixed"]')
    wait_until(lambda: (sheet.count() > 0) is (height > width))  # viser has laid the panel out anew,
    phone.get_by_role("tab", name="Steer").first.wait_for()  # and shows it: it would be unfolded else, not folded
    handle = phone.locator("[data-dock-region-collapse]")
    (sheet.get_by_text("Firefighting", exact=True) if height > width else handle).first.dispatch_event("click")
    wait_until(lambda: not phone.get_by_role("tab", name="Steer").first.is_visible(), 20.0)
    running.push(Freeze(True), EmergencyStop())  # an alarm whose cause lasts, and no fire that grows to the team
    phone.get_by_role("button", name=re.compile(r"^\d+ alarms?$")).dispatch_event("click")
    phone.get_by_role("button", name=re.compile(r"^Acknowledge \d+ alarms?$")).wait_for()
    running.push(AskReset(), ResetEmergencyStop(), Freeze(False))
    wait_until(lambda: not running.state.intent.stopped)
    running.console.ui.change(acknowledge_alarms())
    wait_until(lambda: not phone.locator(".alarms").inner_text())
    phone.get_by_role("tab", name="Steer").first.click()


def test_the_red_button_of_a_phone_is_left_of_the_panel(phone: Page) -> None:
    phone.set_viewport_size({"width": 390, "height": 844})
    panel = phone.locator(".mantine-Paper-root", has=phone.get_by_role("tab")).last
    wait_until(lambda: apart(box(phone.locator("button.stop")), box(panel)), 20.0)
    left, top, right, bottom = box(phone.locator("button.stop"))
    assert right - left >= 96
    assert bottom - top >= 56


def test_the_key_list_of_a_phone_ends_above_its_buttons_and_has_room_for_words(phone: Page) -> None:
    phone.set_viewport_size({"width": 390, "height": 844})
    phone.keyboard.press("?")
    card = phone.get_by_role("dialog", name="Keys")
    card.wait_for()
    wait_until(lambda: apart(box(card), box(phone.locator("button.ask"))), 20.0)
    left, _, right, _ = box(card.locator("dd").first)
    assert right - left > 200
    screenshot(phone, "phone-keys")
    phone.keyboard.press("?")


def test_without_the_server_the_strip_says_that_it_shows_the_last_known_state(phone: Page) -> None:
    phone.evaluate(
        "() => { const viewer = __viserMutable; [viewer.kept, viewer.sendMessage] = [viewer.sendMessage, () => {}]; }"
    )
    wait_until(told(phone, "Last known state"))
    phone.locator(".status.gone [data-act=pause]:disabled").wait_for()
    phone.evaluate("() => { __viserMutable.sendMessage = __viserMutable.kept; }")
    wait_until(lambda: not phone.locator(".status.gone").count())
    assert not told(phone, "Last known state")()
