"""Number fields of a page in a real browser: what they show when they are left without a number."""

from collections.abc import Sequence

import pytest
from playwright.sync_api import Page

from tests.browser import Stage, wait_until

pytestmark = pytest.mark.browser


@pytest.mark.parametrize("keys", [("Backspace",), ("-",), ("7", "Backspace")])
def test_a_number_field_left_without_a_number_shows_its_last_one(stage: Stage, page: Page, keys: Sequence[str]) -> None:
    stage.number.value = 25.0
    field = page.locator(f"[id='{stage.number._impl.uuid}']")  # pyright: ignore[reportPrivateUsage]
    wait_until(lambda: field.input_value() == "25")
    field.click()
    field.press("Control+a")
    for key in keys:
        field.press(key)
    assert field.input_value() in ("", "-")
    field.press("Tab")
    last = keys[0] if "7" in keys else "25"
    wait_until(lambda: field.input_value() == last)
    wait_until(lambda: stage.number.value == float(last))


def test_the_last_number_of_a_field_is_the_one_that_the_server_gave_meanwhile(stage: Stage, page: Page) -> None:
    stage.number.value = 3.0
    field = page.locator(f"[id='{stage.number._impl.uuid}']")  # pyright: ignore[reportPrivateUsage]
    wait_until(lambda: field.input_value() == "3")
    field.click()
    field.press("Control+a")
    stage.number.value = 4.0
    wait_until(lambda: field.input_value() == "4")
    field.press("Control+a")
    field.press("Backspace")
    field.press("Tab")
    wait_until(lambda: field.input_value() == "4")
    assert stage.number.value == 4.0
