"""STOP reaches the server from wherever the operator is, once for each press, and is not undone by haste."""

from collections.abc import Callable
from typing import Literal

import pytest
from playwright.sync_api import Page, expect

from higvf_console.ui.interaction import keys
from tests.browser import (
    Stage,
    draw,
    open_stage,
    press_stop,
    screenshot,
    to_page,
    wait_for_console,
    wait_for_stop,
    wait_until,
)

pytestmark = pytest.mark.browser


@pytest.mark.parametrize("place", ["number", "dropdown", "button", None])
def test_space_stops_wherever_the_focus_is(
    page: Page, stage: Stage, place: Literal["number", "dropdown", "button"] | None
) -> None:
    if place:
        stage.focus(page, place)
    page.keyboard.press("Space")
    wait_until(lambda: stage.pressed == ["stop"])
    wait_for_stop(page, "accepted")
    assert stage.number.value == 1.0
    assert stage.dropdown.value == "first"
    page.keyboard.press("Escape")


def test_space_types_a_blank_in_a_text_field(page: Page, stage: Stage) -> None:
    stage.focus(page, "text")
    page.keyboard.press("End")
    page.keyboard.press("Space")
    page.keyboard.press("Enter")
    wait_until(lambda: stage.text.value == "words ")
    assert stage.pressed == []
    stage.text.value = "words"


def test_a_held_space_stops_once_and_each_press_stops_again(page: Page, stage: Stage) -> None:
    for _ in range(20):
        page.keyboard.down("Space")
    page.keyboard.up("Space")
    page.wait_for_timeout(400)
    assert stage.pressed == ["stop"]
    page.keyboard.press("Space")
    wait_until(lambda: stage.pressed == ["stop", "stop"])


def test_a_stop_is_sent_until_it_is_acknowledged_and_counts_once(page: Page, stage: Stage) -> None:
    stage.hears_stop = False
    page.keyboard.press("Space")
    wait_for_stop(page, "sending")
    page.wait_for_timeout(500)
    expect(page.locator("button.stop")).to_contain_text("not acknowledged")
    stage.hears_stop = True
    wait_for_stop(page, "accepted")
    page.wait_for_timeout(400)
    assert stage.pressed == ["stop"]


def test_a_stop_that_the_server_never_shows_is_called_not_confirmed(page: Page, stage: Stage) -> None:
    page.keyboard.press("Space")
    expect(page.locator("button.stop")).to_contain_text("Not confirmed")
    keys.show_stopped(stage.server, True)
    wait_for_stop(page, "stopped")


def test_the_red_button_stops_with_the_focus_in_a_field(page: Page, stage: Stage) -> None:
    stage.focus(page, "number")
    page.locator("button.stop").click()
    wait_until(lambda: stage.pressed == ["stop"])
    wait_for_stop(page, "accepted")
    assert page.evaluate("document.activeElement.inputMode") == "decimal"


def test_the_red_button_and_space_stop_with_a_dialog_open(page: Page, stage: Stage) -> None:
    with stage.server.gui.add_modal("dialog") as dialog:
        stage.server.gui.add_number("inside", 1.0)
    page.get_by_role("dialog").wait_for()
    page.wait_for_timeout(300)
    page.locator("button.stop").click()
    wait_until(lambda: stage.pressed == ["stop"])
    page.keyboard.press("Space")
    wait_until(lambda: stage.pressed == ["stop", "stop"])
    screenshot(page, "stop-over-dialog")
    dialog.close()
    page.get_by_role("dialog").wait_for(state="hidden")


def test_the_red_button_is_large_visible_and_clear_of_the_panel(page: Page) -> None:
    box = page.locator("button.stop").bounding_box()
    assert box is not None
    assert box["width"] >= 96 and box["height"] >= 56
    on_top = page.evaluate(
        "([x, y]) => document.elementFromPoint(x, y).shadowRoot?.elementFromPoint(x, y)?.closest('button').className",
        [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2],
    )
    assert "stop" in on_top


def test_a_latched_stop_is_reset_by_two_unhurried_presses(page: Page, stage: Stage) -> None:
    keys.show_stopped(stage.server, True)
    wait_for_stop(page, "stopped")
    page.wait_for_timeout(450)
    press_stop(page, times=3)
    wait_for_stop(page, "asked")
    screenshot(page, "reset-asked")
    page.wait_for_timeout(450)
    press_stop(page)
    wait_until(lambda: stage.pressed == ["ask_reset", "reset_stop"])
    keys.show_stopped(stage.server, False)
    wait_for_stop(page, "ready")


def test_space_takes_back_the_first_step_of_a_reset(page: Page, stage: Stage) -> None:
    keys.show_stopped(stage.server, True)
    wait_for_stop(page, "stopped")
    page.wait_for_timeout(450)
    press_stop(page)
    wait_for_stop(page, "asked")
    page.keyboard.press("Space")
    wait_for_stop(page, "stopped")
    assert stage.pressed == ["ask_reset", "stop"]


def test_a_reset_that_is_not_confirmed_in_time_lapses(page: Page, stage: Stage) -> None:
    keys.show_stopped(stage.server, True)
    wait_for_stop(page, "stopped")
    page.wait_for_timeout(450)
    press_stop(page)
    wait_for_stop(page, "asked")
    page.wait_for_timeout(5200)
    wait_for_stop(page, "stopped")
    press_stop(page)
    wait_until(lambda: stage.pressed == ["ask_reset", "ask_reset"])


def test_stop_and_its_state_survive_a_reload_and_a_reconnection(page: Page, stage: Stage) -> None:
    keys.show_stopped(stage.server, True)
    page.reload()
    wait_for_console(page)
    wait_for_stop(page, "stopped")
    before = set(stage.server.get_clients())
    stage.server._websock_server.disconnect_all_clients()  # pyright: ignore[reportPrivateUsage]
    wait_until(lambda: set(stage.server.get_clients()) - before)
    wait_for_stop(page, "stopped")
    page.keyboard.press("Space")
    wait_until(lambda: stage.pressed == ["stop"])
    draw(page, to_page(page, [[100.0, 100.0]]), rate=0)
    wait_until(lambda: stage.clicks)
    page.wait_for_timeout(200)
    assert len(stage.clicks) == 1
    assert page.locator("button.stop").count() == 1


def test_a_stop_pressed_without_connection_is_sent_when_it_is_back(page: Page, stage: Stage) -> None:
    stage.server._websock_server.disconnect_all_clients()  # pyright: ignore[reportPrivateUsage]
    wait_for_stop(page, "offline")
    page.keyboard.press("Space")
    wait_until(lambda: stage.pressed == ["stop"])


def test_the_button_says_when_the_server_is_gone(open_page: Callable[[str], Page]) -> None:
    stage = open_stage()
    page = open_page(stage.url)
    stage.server.stop()
    wait_for_stop(page, "offline")
    expect(page.locator("button.stop")).to_contain_text("STOP cannot reach the server")
    page.keyboard.press("Space")
    expect(page.locator("button.stop")).to_contain_text("STOP waits for the server")
    screenshot(page, "no-connection")


def test_keys_of_the_map_call_by_their_names(page: Page, stage: Stage) -> None:
    for key in "pcrzxv1":
        page.keyboard.press(key)
    page.keyboard.press("P")
    page.keyboard.press("9")
    names = ["pause", "clear_path", "reverse_path", "freeze", "step", "field_arrows", "pick_1", "pause", "pick_9"]
    wait_until(lambda: len(stage.pressed) >= len(names))
    assert stage.pressed == names


@pytest.mark.parametrize("field", ["number", "text"])
def test_keys_do_nothing_while_a_field_is_typed_into(
    page: Page, stage: Stage, field: Literal["number", "text"]
) -> None:
    stage.focus(page, field)
    page.keyboard.press("p")
    page.keyboard.press("1")
    page.keyboard.press("?")
    page.keyboard.press("Escape")
    draw(page, to_page(page, [[100.0, 100.0]]), rate=0)
    wait_until(lambda: stage.clicks)
    assert stage.pressed == []
    stage.text.value, stage.number.value = "words", 1.0


@pytest.fixture
def fields(page: Page, stage: Stage) -> None:
    """The fields are as at first, on both sides; what was typed before has arrived."""
    page.wait_for_timeout(500)
    stage.number.value, stage.text.value = 1.0, "words"
    number = f"[id='{stage.number._impl.uuid}']"  # pyright: ignore[reportPrivateUsage]
    expect(page.locator(number)).to_have_value("1")
    expect(page.locator("input[value='words']")).to_have_count(1)


@pytest.mark.usefixtures("fields")
@pytest.mark.parametrize("key", ["Enter", "Escape"])
@pytest.mark.parametrize("field", ["number", "text"])
def test_enter_gives_what_was_typed_escape_takes_text_back_and_both_give_the_keys_back(
    page: Page, stage: Stage, field: Literal["number", "text"], key: str
) -> None:
    stage.focus(page, field)
    page.keyboard.press("End")
    page.keyboard.type("77")
    page.keyboard.down(key)
    page.wait_for_function("document.activeElement === document.body", polling=50)
    page.keyboard.down(key)  # still held
    page.keyboard.up(key)
    page.keyboard.press("p")
    wait_until(lambda: "pause" in stage.pressed)
    given = (177, "words") if field == "number" else (1, "words77" if key == "Enter" else "words")
    wait_until(lambda: (stage.number.value, stage.text.value) == given)
    assert stage.pressed == ["pause"]
    stage.text.value, stage.number.value = "words", 1.0


@pytest.mark.parametrize("way", ["click", "Enter"])
def test_a_chosen_option_holds_and_its_dropdown_gives_the_keys_back(page: Page, stage: Stage, way: str) -> None:
    stage.focus(page, "dropdown")
    option = page.get_by_role("option", name="second")
    option.wait_for()
    page.keyboard.press("Control+a")
    page.keyboard.type("sec")
    if way == "click":
        option.click()
    else:
        page.keyboard.press("ArrowDown")
        page.keyboard.press("Enter")
    option.wait_for(state="hidden")
    page.keyboard.press("p")
    wait_until(lambda: stage.pressed == ["pause"])
    wait_until(lambda: stage.dropdown.value == "second")
    expect(page.get_by_role("combobox").first).to_have_value("second")
    stage.dropdown.value = "first"


def test_escape_closes_a_dropdown_and_gives_the_keys_back(page: Page, stage: Stage) -> None:
    stage.focus(page, "dropdown")
    option = page.get_by_role("option", name="second")
    option.wait_for()
    page.keyboard.press("Escape")
    option.wait_for(state="hidden")
    page.keyboard.press("p")
    wait_until(lambda: stage.pressed == ["pause"])
    assert stage.dropdown.value == "first"


@pytest.mark.usefixtures("fields")
@pytest.mark.parametrize("key", ["Enter", "Escape"])
def test_the_key_after_a_field_is_left_is_heard_however_busy_the_page_is(page: Page, stage: Stage, key: str) -> None:
    stage.focus(page, "text")
    page.evaluate(
        """(keys) => {
            for (const [key, code] of keys)
                document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key, code, bubbles: true }));
        }""",
        [[key, key], ["p", "KeyP"]],
    )
    page.keyboard.press("Space")
    wait_until(lambda: len(stage.pressed) == 2)
    assert stage.pressed == ["pause", "stop"]


@pytest.mark.usefixtures("fields")
def test_a_step_by_the_arrows_of_a_number_field_leaves_the_keys_alive(page: Page, stage: Stage) -> None:
    page.locator(".mantine-NumberInput-control").first.click()
    wait_until(lambda: stage.number.value == 2.0)
    page.keyboard.press("p")
    wait_until(lambda: stage.pressed == ["pause"])
    stage.number.value = 1.0


def test_the_search_of_the_palette_keeps_the_focus_after_enter(page: Page, stage: Stage) -> None:
    run: list[bool] = []
    command = stage.server.gui.add_command("Do it")
    command.on_trigger(lambda _: run.append(True))
    search = page.get_by_placeholder("Search")
    wait_until(lambda: page.keyboard.press("Control+k") or search.count())  # the command has to arrive
    search.fill("nothing like it")
    page.keyboard.press("Enter")
    page.wait_for_timeout(200)
    page.keyboard.type("!")
    expect(search).to_have_value("nothing like it!")
    search.fill("Do it")
    page.keyboard.press("Enter")
    wait_until(lambda: run)
    search.wait_for(state="hidden")
    command.remove()
    assert stage.pressed == []


def test_a_field_of_a_dialog_keeps_the_focus_after_enter(page: Page, stage: Stage) -> None:
    with stage.server.gui.add_modal("dialog") as dialog:
        inside = stage.server.gui.add_number("inside", 5.0)
    field = page.locator(f"[id='{inside._impl.uuid}']")  # pyright: ignore[reportPrivateUsage]
    field.focus()
    page.keyboard.press("Enter")
    page.wait_for_timeout(200)
    expect(field).to_be_focused()
    dialog.close()
    page.get_by_role("dialog").wait_for(state="hidden")
    assert stage.pressed == []


def test_a_shortcut_of_the_browser_is_no_key_of_ours(page: Page, stage: Stage) -> None:
    page.keyboard.press("Alt+p")
    page.keyboard.press("x")
    wait_until(lambda: stage.pressed)
    assert stage.pressed == ["step"]


def test_the_key_list_shows_every_key_and_closes_again(page: Page, stage: Stage) -> None:
    card = page.get_by_role("dialog", name="Keys")
    page.keyboard.press("?")
    card.wait_for()
    screenshot(page, "keys")
    covers, stop = card.bounding_box(), page.locator("button.stop").bounding_box()
    assert covers and stop and covers["y"] + covers["height"] < stop["y"], "its last rows are behind the red button"
    for binding in keys.KEYMAP:
        expect(card).to_contain_text(binding.text)
    press_stop(page)
    wait_until(lambda: stage.pressed == ["stop"])
    page.keyboard.press("?")
    card.wait_for(state="hidden")
    page.keyboard.press("?")
    card.wait_for()
    page.keyboard.press("Escape")
    card.wait_for(state="hidden")


_TYPE = """
(events) => {
  for (const event of events)
    document.body.dispatchEvent(new KeyboardEvent("keydown", { bubbles: true, cancelable: true, ...event }));
  const hosts = [...document.body.children].map((host) => host.shadowRoot?.querySelector(".bar .note"));
  return hosts.find((note) => note).textContent;
}
"""


def type_keys(page: Page, *events: dict[str, object]) -> str:
    """Key strokes as a keyboard of any layout makes them; the note beside the STOP button after them."""
    return page.evaluate(_TYPE, list(events))


# What the browsers tell of keys whose place is that of another key on a QWERTY keyboard.
NO_KEYS: dict[str, dict[str, object]] = {
    "Colemak ;": {"key": ";", "code": "KeyP"},
    "Dvorak ;": {"key": ";", "code": "KeyZ"},
    "AZERTY ,": {"key": ",", "code": "KeyM"},
    "Bepo a with grave": {"key": "à", "code": "KeyZ"},
    "Greek ;": {"key": ";", "code": "KeyQ"},
    "End on the number pad": {"key": "End", "code": "Numpad1"},
    "an arrow on the number pad": {"key": "ArrowUp", "code": "Numpad8"},
    "Home on the number pad": {"key": "Home", "code": "Numpad7"},
    "PageUp on the number pad": {"key": "PageUp", "code": "Numpad9"},
    "a dead key": {"key": "Dead", "code": "Digit6"},
    "an input method": {"key": "Process", "code": "KeyP"},
    "! of a QWERTY row": {"key": "!", "code": "Digit1", "shiftKey": True},
    "AltGr with a digit": {"key": "@", "code": "Digit2", "modifierAltGraph": True},
    "Dvorak Ctrl ;": {"key": ";", "code": "KeyZ", "ctrlKey": True},
}
KEYS: dict[str, tuple[dict[str, object], str]] = {
    "Cyrillic ze": ({"key": "з", "code": "KeyP"}, "pause"),
    "Greek rho": ({"key": "\u03c1", "code": "KeyR"}, "reverse_path"),
    "Hebrew zayin": ({"key": "ז", "code": "KeyZ"}, "freeze"),
    "Thai": ({"key": "ั", "code": "KeyP"}, "pause"),
    "AZERTY ampersand": ({"key": "&", "code": "Digit1"}, "pick_1"),
    "AZERTY e with acute": ({"key": "é", "code": "Digit2"}, "pick_2"),
    "AZERTY 3 with Shift": ({"key": "3", "code": "Digit3", "shiftKey": True}, "pick_3"),
    "4 on the number pad": ({"key": "4", "code": "Numpad4"}, "pick_4"),
    "Colemak p": ({"key": "p", "code": "KeyR"}, "pause"),
    "Ctrl with Cyrillic ya": ({"key": "я", "code": "KeyZ", "ctrlKey": True}, "undo"),
    "Ctrl with Greek zeta": ({"key": "ζ", "code": "KeyZ", "ctrlKey": True}, "undo"),
    "Ctrl with Hebrew zayin": ({"key": "ז", "code": "KeyZ", "ctrlKey": True}, "undo"),
    "Ctrl Shift with Cyrillic ya": ({"key": "Я", "code": "KeyZ", "ctrlKey": True, "shiftKey": True}, "redo"),
}


def test_punctuation_accents_and_named_keys_are_never_the_key_at_their_place(page: Page, stage: Stage) -> None:
    type_keys(page, *NO_KEYS.values())
    page.keyboard.press("x")
    wait_until(lambda: stage.pressed)
    assert stage.pressed == ["step"]


def test_letters_without_latin_ones_and_the_row_of_digits_are_known_by_their_place(page: Page, stage: Stage) -> None:
    type_keys(page, *(event for event, _ in KEYS.values()))
    wait_until(lambda: len(stage.pressed) >= len(KEYS))
    assert stage.pressed == [name for _, name in KEYS.values()]


def test_a_robot_above_9_is_typed_as_a_number(page: Page, stage: Stage) -> None:
    keys.show_robots(stage.server, 200)
    page.wait_for_timeout(300)
    press: dict[str, dict[str, object]] = {
        name: {"key": name, "code": f"Key{name}"} for name in ("1", "7", "3", "0", "4", "5", "2", "p")
    }
    named: dict[str, dict[str, object]] = {name: {"key": name, "code": name} for name in ("Enter", "Escape")}
    seventeen, typed = [press["1"], press["7"]], page.locator(".bar .note")
    assert type_keys(page, *seventeen) == "Robot 17 …"
    assert type_keys(page, named["Enter"]) == "", "it ends a number, and confirms nothing"
    for more in (["3", "0"], ["4", "p"], ["5"]):  # none is longer than 30; another key ends a number
        type_keys(page, *(press[name] for name in more))
    assert type_keys(page, named["Escape"]) == ""
    type_keys(page, press["1"], press["2"])  # a pause ends it
    names = ["pick_17", "pick_30", "pick_4", "pause", "pick_12"]
    wait_until(lambda: len(stage.pressed) >= len(names))
    assert stage.pressed == names
    expect(typed).to_have_text("")
    keys.show_robots(stage.server, 9)
    page.wait_for_timeout(300)
