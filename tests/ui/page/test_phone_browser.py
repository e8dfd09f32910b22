"""On a phone and in small windows nothing of the console lies outside the page, or on what else it has."""

from collections.abc import Iterator
from itertools import combinations

import pytest
from playwright.sync_api import Browser, Locator, Page

from tests.browser import open_console, screenshot, wait_until
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser

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


def apart(one: Box, other: Box) -> bool:
    return one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


@pytest.mark.parametrize(("width", "height"), [(390, 844), (900, 600), (1280, 720)])
def test_strips_notes_and_stop_stay_in_the_page_and_off_each_other(
    phone: Page, running: Running, width: int, height: int
) -> None:
    phone.set_viewport_size({"width": width, "height": height})
    note = phone.locator(".mantine-Notification-root", has_text="Some words")
    notes = [
        client.add_notification("Note", "Some words that the operator shall read.", auto_close_seconds=None)
        for client in running.server.get_clients().values()
    ]
    note.wait_for()

    def boxes() -> dict[str, Box]:
        parts = {"tools": ".tools", "roles": ".roles", "stop": "button.stop", "help": "button.ask"}
        return {name: box(phone.locator(part)) for name, part in parts.items()} | {"note": box(note)}

    def laid_out() -> bool:
        found = boxes()
        tools = [box(button) for button in phone.locator(".tools button").all()]
        return all(
            left >= 0 and top >= 0 and right <= width and bottom <= height
            for left, top, right, bottom in [*found.values(), *tools]
        ) and all(apart(*pair) for pair in combinations(found.values(), 2))

    wait_until(laid_out, 20.0)  # it slides in
    screenshot(phone, f"phone-{width}x{height}")
    for sent in notes:
        sent.remove()
    note.wait_for(state="hidden")


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
