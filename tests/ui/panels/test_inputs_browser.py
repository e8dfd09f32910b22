"""Replayed gaze in a real browser: its heat map, what it looked at, the button that it presses, the panel of inputs."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from higvf_console.channels.channels import open_interface
from higvf_console.core.commands import Freeze, ResetRun, SetSpeed, Step
from higvf_console.core.interface import InputSpec
from higvf_console.runtime.inputs import demo_specs
from higvf_console.scenario.scenario import load_scenario
from tests.browser import console_page, screenshot, visible, wait_until
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser

BUTTON = [0.2, 0.2, 0.5, 0.7]  # where the recorded eye rests, unlike the usual corner


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    """The recorded demonstration, with a button for the gaze to press."""
    gaze, *others = demo_specs(load_scenario("barrier-gaze"))
    gaze = InputSpec("gaze", gaze.source, {**gaze.options, "clutch": "dwell"}, {"button": BUTTON}, gaze.arena)
    with console_at_work("barrier-gaze", *(open_interface(spec) for spec in (gaze, *others))) as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    """A page that shows it, at the panel of inputs."""
    with console_page(chromium, running.url, "Inputs") as page:
        yield page


def section(page: Page, words: str) -> str:
    """The text of the table that has some words in it."""
    return page.locator(".hg", has_text=words).last.inner_text()


def test_the_ring_fills_while_gaze_rests_on_the_button(page: Page, running: Running) -> None:
    running.push(Freeze(True))
    wait_until(lambda: running.session.snapshot.frozen)
    running.push(ResetRun())  # while the page was opened, the eye may have left the button
    wait_until(lambda: running.session.snapshot.time == 0.0)
    time, progress = 0.0, 0.0
    while time < 0.2 or progress < 0.4:  # what was reported before the reset may still be at first
        assert time < 20.0, "the eye never rests on the button"
        running.push(Step())
        wait_until(lambda time=time: running.session.snapshot.time > time)
        time, report = running.session.snapshot.time, running.session.snapshot.inputs.dwell
        progress = report.progress if report else 0.0
    wait_until(lambda: visible(page, "/gaze/button") and visible(page, "/gaze/dwell"))
    page.wait_for_timeout(500)
    screenshot(page, "inputs-dwell")


def test_the_panel_tells_what_was_looked_at_and_what_was_decided(page: Page, running: Running) -> None:
    running.push(Freeze(False), SetSpeed(8.0))
    wait_until(lambda: running.session.snapshot.time > 20.0)
    wait_until(lambda: "Fire 3" in section(page, "Fixation rate"))
    wait_until(lambda: "right passed" in section(page, "Decisions of bci"))
    assert "Decisions of emg" in section(page, "Decisions of bci")
    screenshot(page, "inputs-panel")
    page.get_by_role("button", name="Calibrate gaze").scroll_into_view_if_needed()
    page.wait_for_timeout(300)
    screenshot(page, "inputs-panel-below")


def test_a_recording_cannot_be_calibrated_and_the_panel_says_why(page: Page) -> None:
    assert page.get_by_role("button", name="Calibrate gaze").is_disabled()
    assert "Gaze is replayed" in section(page, "Calibration")


def test_the_heat_map_is_shown_when_it_is_wanted(page: Page, running: Running) -> None:
    wait_until(lambda: running.session.snapshot.inputs.attention)
    assert not visible(page, "/gaze/heat")
    page.get_by_role("tab", name="View").click()
    page.get_by_role("checkbox", name="Gaze heat map").click()
    wait_until(lambda: visible(page, "/gaze/heat"))
    page.wait_for_timeout(1000)
    screenshot(page, "inputs-heat")
    page.get_by_role("checkbox", name="Gaze heat map").click()
    wait_until(lambda: not visible(page, "/gaze/heat"))
