"""Why a robot moves, as the operator sees it in a real browser."""

from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from higvf_console.core.arrays import floats
from higvf_console.core.commands import Freeze
from tests.browser import console_page, draw, screenshot, tab, to_page, visible, wait_until
from tests.consoles import Running, console_at_work

pytestmark = pytest.mark.browser


@pytest.fixture
def running() -> Iterator[Running]:
    """The firefighting scenario, frozen at its start."""
    with console_at_work("firefighting") as running:
        running.start_again()
        yield running


@pytest.fixture
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    """A page that shows it."""
    with console_page(chromium, running.url) as page:
        yield page


def numbers(shown: list[str]) -> list[float]:
    return [float(number.replace("\u2212", "-")) for number in shown]


def test_a_second_click_on_a_robot_opens_the_tab_that_says_why_it_moves(page: Page, running: Running) -> None:
    running.push(*running.shipped_stroke(), Freeze(False))
    robot = running.session.scenario.strokes[0].robot or 0
    wait_until(lambda: running.state.motion.tick > 60)
    running.push(Freeze(True))
    wait_until(lambda: running.session.snapshot.frozen)
    assert not visible(page, "/why/parts")
    draw(page, to_page(page, running.state.motion.position[robot : robot + 1]), rate=0)
    wait_until(lambda: visible(page, "/why/parts"))
    panel = page.locator(".hg", has_text=f"Why robot {robot + 1} moves")
    wait_until(panel.count)
    velocity = running.session.snapshot.last.after.velocity[robot]
    total = panel.locator("tfoot td")  # the panel is renewed less often than the arrows
    wait_until(lambda: numbers(total.all_inner_texts()[1:3]) == pytest.approx(velocity, abs=0.051))
    rows = [row.split("\t") for row in panel.locator("tbody tr").all_inner_texts()]
    parts = floats([numbers(row[1:3]) for row in rows])
    assert parts.sum(axis=0) == pytest.approx(velocity, abs=0.051 * len(parts))
    assert np.hypot(*parts[1]) > 1.0  # the human's
    wait_until(page.locator("svg.chart polygon").count)
    assert page.locator(".hg", has_text="Does the method hold?").locator("tbody tr").count() == 5
    screenshot(page, "console-why")
    draw(page, to_page(page, running.state.motion.position[robot : robot + 1]), rate=0)
    wait_until(lambda: not visible(page, "/why/parts"))


def test_another_robot_is_explained_without_being_steered_and_its_lines_of_sight_shown(
    page: Page, running: Running
) -> None:
    tab(page, "Why")
    page.get_by_role("combobox").nth(0).click()
    page.get_by_role("option", name="Robot 3").click()
    wait_until(page.locator(".hg", has_text="Why robot 3 moves").count)
    assert running.state.intent.influenced == 0
    page.get_by_role("checkbox", name="Lines of sight").click()
    wait_until(lambda: visible(page, "/why/seen"))
    screenshot(page, "console-sight")
    page.get_by_role("checkbox", name="Lines of sight").click()
    page.get_by_role("combobox").nth(0).click()
    page.get_by_role("option", name="Influenced robot").click()
    wait_until(page.locator(".hg", has_text="Why robot 1 moves").count)
