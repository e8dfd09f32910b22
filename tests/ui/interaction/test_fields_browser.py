"""Fields of a page in a real browser: what is typed arrives as a whole, and only what is a number."""

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser import Stage, wait_for_stop, wait_until

pytestmark = pytest.mark.browser


def length(page: Page) -> Locator:
    return page.get_by_label("Length (m)", exact=True)


def type_into(field: Locator, text: str) -> None:
    field.click()
    field.press("Control+a")
    field.press_sequentially(text)


@pytest.fixture(autouse=True)
def _as_at_first(stage: Stage, page: Page) -> None:
    """The field of a length shows 25."""
    assert stage.length is not None
    stage.length.show(25.0, settle=0.0)
    expect(length(page)).to_have_value("25")


@pytest.mark.parametrize("end", ["Enter", "Tab"])
def test_a_number_arrives_once_as_it_was_typed_when_its_field_is_left(stage: Stage, page: Page, end: str) -> None:
    field = length(page)
    type_into(field, "12e-1")
    assert stage.typed == []
    assert field.input_value() == "12e-1"
    field.press(end)
    wait_until(lambda: stage.typed)
    page.wait_for_timeout(200)
    assert stage.typed == [1.2]


def test_what_is_no_number_or_out_of_range_is_refused_in_words_and_the_old_value_stays(
    stage: Stage, page: Page
) -> None:
    field = length(page)
    for text, words in (("1e", "'1e' is not a number"), ("900", "900 is not from 1 to 500 m")):
        type_into(field, text)
        field.press("Enter")
        page.locator(".mantine-Notification-root", has_text=words).wait_for()
        expect(field).to_have_value("25")
    assert stage.typed == []


def test_escape_and_an_empty_field_change_nothing(stage: Stage, page: Page) -> None:
    field = length(page)
    type_into(field, "77")
    field.press("Escape")
    expect(field).to_have_value("25")
    type_into(field, "7")
    field.press("Backspace")
    assert field.input_value() == ""
    field.press("Tab")
    expect(field).to_have_value("25")
    assert stage.typed == []


def test_an_arrow_steps_a_number_by_a_tenth_of_its_order_of_magnitude(stage: Stage, page: Page) -> None:
    field = length(page)
    field.click()
    field.press("ArrowDown")
    wait_until(lambda: stage.typed)
    assert stage.typed == [24.0]


def test_space_stops_the_team_from_a_number_field(stage: Stage, page: Page) -> None:
    length(page).click()
    page.keyboard.press("Space")
    wait_until(lambda: stage.pressed == ["stop"])
    wait_for_stop(page, "accepted")
    assert stage.typed == []


def test_what_the_server_gives_meanwhile_waits_until_the_typing_ends(stage: Stage, page: Page) -> None:
    field = length(page)
    type_into(field, "7")
    assert stage.length is not None
    stage.length.show(40.0, settle=0.0)
    page.wait_for_function("() => document.activeElement.defaultValue === '40'", polling=50)
    assert field.input_value() == "7"
    field.press("Escape")
    expect(field).to_have_value("40")
    assert stage.typed == []


def test_the_number_beside_a_slider_cannot_be_half_typed(stage: Stage, page: Page) -> None:
    slider = stage.server.gui.add_slider("slider", 0.0, 9.0, 0.1, 1.0)
    field = page.locator(".mantine-Slider-root").locator("..").locator("input[inputmode]")
    field.wait_for()
    wait_until(lambda: not field.is_editable())
    slider.remove()
