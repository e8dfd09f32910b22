"""The targets of a calibration in a real browser: where they should be, and gone with Esc."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from higvf_console.core.arrays import floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.interface import ChannelHealth, ChannelState, OperatorContext
from higvf_console.core.reports import CalibrationReport, CaptureReport
from tests.browser import console_page, screenshot, to_page, turn_wheel, wait_until
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser

# The middle of the target in the page [CSS px], or None while nothing is to be looked at.
_IN_HAND = "button[data-tool][aria-pressed=true]"
_TARGET = """
() => {
  for (const host of document.body.children) {
    const ground = host.shadowRoot?.querySelector(".ground.open");
    if (!ground) continue;
    const { left, top, width, height } = ground.querySelector(".dot").getBoundingClientRect();
    return [left + width / 2, top + height / 2, ground.textContent];
  }
  return null;
}
"""


class Tracker:
    """A live tracker in name; a test says how its calibration stands."""

    name = "gaze"

    def __init__(self) -> None:
        self.capture = CaptureReport("")
        self.begun = self.cancelled = 0

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        assert context.operator
        return ()

    def health(self, now: float) -> ChannelHealth:
        return ChannelHealth(ChannelState.LIVE, f"at {now:.1f} s")

    def close(self) -> None: ...

    def calibration_report(self) -> CalibrationReport | None:
        return None

    def capture_report(self) -> CaptureReport:
        return self.capture

    def begin_capture(self) -> None:
        self.begun += 1
        self.capture = CaptureReport("", floats([120, 630]), 1, 5, 0.0)

    def cancel_capture(self) -> None:
        self.cancelled += 1
        self.capture = CaptureReport("", outcome="given up; the map in use stays")


@pytest.fixture(scope="module")
def tracker() -> Tracker:
    return Tracker()


@pytest.fixture(scope="module")
def running(tracker: Tracker) -> Iterator[Running]:
    with console_at_work("firefighting", tracker) as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    with console_page(chromium, running.url, "Inputs") as page:
        yield page


def test_the_targets_are_shown_over_their_ground_points_until_esc(page: Page, tracker: Tracker) -> None:
    page.locator("button[data-tool='edit']").click()
    turn_wheel(page, to_page(page, [[600, 350]])[0], -500.0)  # a zoomed view is fitted first
    page.get_by_role("button", name="Calibrate gaze").click()
    wait_until(lambda: tracker.begun == 1 and page.evaluate(_TARGET))
    tracker.capture = CaptureReport("", floats([1080, 630]), 2, 5, 0.6)

    def over_its_point() -> bool:
        x, y, words = page.evaluate(_TARGET)
        return "2 of 5" in words and bool(np.hypot(*(np.array([x, y]) - to_page(page, [[1080, 630]])[0])) < 2.0)

    wait_until(over_its_point)
    page.wait_for_timeout(400)
    screenshot(page, "calibration-target")
    assert page.get_by_role("button", name="Calibrate gaze").is_disabled()
    page.keyboard.press("Escape")
    wait_until(lambda: tracker.cancelled == 1 and page.evaluate(_TARGET) is None)
    assert page.locator(_IN_HAND).get_attribute("data-tool") == "edit", "Esc gives up the calibration and nothing else"
    wait_until(lambda: "given up" in page.locator(".hg", has_text="Calibration").last.inner_text())
    page.keyboard.press("Escape")
    wait_until(lambda: page.locator(_IN_HAND).get_attribute("data-tool") == "path")
