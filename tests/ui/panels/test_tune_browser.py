"""The panel of tunables in a real browser: typed, refused, preset, put back, undone."""

from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page

from higvf_console.control.parameters import Parameters
from higvf_console.core.commands import Freeze
from higvf_console.core.edits import SetParameters
from higvf_console.ui.theme import LIGHT, USUAL_LOOK
from higvf_console.world.editing.presets import preset_name
from tests.browser import console_page, screenshot, told, wait_until
from tests.consoles import Running, console_at_work
from tests.roles import send

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    """The firefighting scenario, live."""
    with console_at_work("firefighting") as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    """A page that shows the tab, of a clock that stands."""
    with console_page(chromium, running.url, "Tune") as page:
        running.push(Freeze(True))
        yield page


@pytest.fixture(autouse=True)
def _as_in_the_scenario(running: Running, page: Page) -> None:
    """Each test begins with the scenario's values."""
    params = running.session.scenario.params
    if running.session.snapshot.setup.params != params:
        page.get_by_role("button", name="Reset all", exact=True).click()
        wait_until(lambda: running.session.snapshot.setup.params == params)
    page.get_by_text("all values are the scenario's").wait_for()
    running.session.commands.clear()


def params_of(running: Running) -> Parameters:
    return running.session.snapshot.setup.params


def choose(page: Page, label: str, option: str) -> None:
    page.get_by_label(label, exact=True).first.click()
    page.get_by_role("option", name=option, exact=True).click()


def field(page: Page, label: str) -> Locator:
    return page.get_by_label(label, exact=True).first


def type_into(field: Locator, text: str) -> None:
    field.fill(text)
    field.press("Enter")


def test_a_typed_value_counts_once_and_is_marked_put_back_and_undone(page: Page, running: Running) -> None:
    choose(page, "Group", "Safety")
    type_into(field(page, "Robot clearance (m)"), "28")
    wait_until(lambda: params_of(running).safety.robot_clearance == 28.0)
    given = [command.values for command in running.given(SetParameters) if isinstance(command, SetParameters)]
    assert given == [{"safety.robot_clearance": 28.0}]
    page.get_by_label("● Robot clearance (m)", exact=True).first.wait_for()
    page.locator(".hg tr", has_text="Robot clearance").get_by_text("28").wait_for()
    screenshot(page, "tune-changed")
    page.get_by_role("button", name="Reset this group", exact=True).click()
    wait_until(lambda: params_of(running).safety.robot_clearance == 25.0)
    page.locator("body").press("Control+z")
    wait_until(lambda: params_of(running).safety.robot_clearance == 28.0)


def test_an_unsafe_value_is_refused_with_its_limit_and_springs_back(page: Page, running: Running) -> None:
    choose(page, "Group", "Formation")
    before = params_of(running)
    type_into(field(page, "Formation rate (1/s)"), "49")
    wait_until(told(page, "must stay below"))
    page.locator(".hg .warn", has_text="must stay below").wait_for()
    wait_until(lambda: field(page, "Formation rate (1/s)").input_value() == "0.5")
    assert params_of(running) is before
    choose(page, "Group", "Path")
    type_into(field(page, "Capture distance (m)"), "0.2")
    page.locator(".hg .warn", has_text="from 1 to 500 m").wait_for()
    assert params_of(running) is before


def test_no_limit_is_a_word_and_other_words_are_told(page: Page, running: Running) -> None:
    choose(page, "Group", "Perception")
    place = page.locator("input[value=unlimited]").first
    type_into(place, "150")
    wait_until(lambda: params_of(running).perception.perception_range == 150.0)
    page.get_by_role("cell", name="150", exact=True).first.wait_for()  # the panel knows it too
    type_into(page.locator("input[value='150']"), "far")
    wait_until(told(page, "'far' is not a number; 150 stays"))
    screenshot(page, "tune-perception")
    type_into(page.locator("input[value='150']"), "unlimited")
    wait_until(lambda: params_of(running).perception.perception_range == float("inf"))


@pytest.mark.parametrize("theme", ["dark", "light"])
def test_a_preset_is_one_step_and_its_name_is_known(page: Page, running: Running, theme: str) -> None:
    ui = running.console.ui
    ui.update(look=USUAL_LOOK if theme == "dark" else USUAL_LOOK._replace(palette=LIGHT))
    choose(page, "Group", "Safety")
    choose(page, "Preset", "Cautious")
    scenario = running.session.scenario.params
    wait_until(lambda: preset_name(params_of(running), scenario) == "Cautious")
    page.locator(".hg tr", has_text="Cruise speed").get_by_text("36").wait_for()
    wait_until(lambda: field(page, "● Speed limit (m/s)").input_value() == "67.5")
    page.mouse.move(640, 300)
    page.wait_for_timeout(500)
    screenshot(page, f"tune-{theme}")
    ui.update(look=USUAL_LOOK)
    page.get_by_role("tab", name="Tune", exact=True).press("Control+z")
    wait_until(lambda: params_of(running) == scenario)
    wait_until(lambda: page.get_by_label("Preset", exact=True).first.input_value() == "As in the scenario")


def test_a_value_that_is_none_of_the_choices_is_refused_in_the_line(page: Page, running: Running) -> None:
    presets = page.get_by_label("Preset", exact=True).first
    gui: Any = running.server.gui
    (uuid,) = [uuid for uuid, widget in gui._gui_input_handle_from_uuid.items() if widget.label == "Preset"]
    before = params_of(running)
    send(page, type="GuiUpdateMessage", uuid=uuid, updates={"value": "Cautius"})
    wait_until(told(page, "Preset: 'Cautius' is not one of As in the scenario, "))
    screenshot(page, "refused-value")
    assert params_of(running) is before
    wait_until(lambda: presets.input_value() == "As in the scenario")


def test_what_is_fixed_for_a_run_cannot_be_typed_and_says_so(page: Page) -> None:
    choose(page, "Group", "Safety")
    field(page, "Control period (s)").wait_for()
    assert field(page, "Control period (s)").is_disabled()
    page.get_by_text("Control period is fixed during a run").wait_for()
