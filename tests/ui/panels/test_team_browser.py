"""A team in a real browser: checked, armed, one robot stopped, all stopped; every step by the page alone."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from higvf_console.team.state import Arming, TeamState
from tests.browser import console_page, screenshot, wait_until
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    """E-pucks behind a link that is late and loses messages."""
    with console_at_work("epucks", team="simulated=:latency_s=0.05,noise_m=0.002,loss=0.05") as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    """A page that shows it, at the panel of the team."""
    with console_page(chromium, running.url, "Team") as page:
        yield page


def team_of(running: Running) -> TeamState:
    team = running.session.snapshot.team
    assert team is not None
    return team


def states(page: Page) -> str:
    return page.locator(".hg-strip").locator(".states").inner_text()


def test_a_team_is_checked_armed_and_stopped_by_the_page(page: Page, running: Running) -> None:
    wait_until(lambda: states(page) == "DISARMED")
    page.get_by_role("button", name="Check the team").click()
    page.get_by_role("button", name="Arm: let the team drive").click()
    wait_until(lambda: team_of(running).arming is Arming.ARMED)
    wait_until(lambda: states(page) == "RUNNING")
    page.get_by_role("button", name="Stop this robot").click()
    wait_until(lambda: team_of(running).stopped.tolist() == [True, False, False, False, False])
    wait_until(lambda: page.locator(".team", has_text="stopped").count() == 1)
    page.keyboard.press("Space")
    wait_until(lambda: running.state.intent.stopped)
    lamps = page.locator(".lamps")
    wait_until(lambda: lamps.inner_text().count("\u25cf") == 3)
    assert "of" not in lamps.inner_text()
    screenshot(page, "team-stopped")
    page.get_by_role("button", name="Disarm").click()
    wait_until(lambda: team_of(running).arming is Arming.DISARMED)
