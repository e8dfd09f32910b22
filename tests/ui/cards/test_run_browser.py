"""A run in a real browser, from the card before it to the one after it."""

import json
import math
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from higvf_console.core.commands import LoadScenario, ResetRun
from higvf_console.runtime.phase import Phase
from higvf_console.scenario.kept import draft_file, write_whole
from higvf_console.scenario.scenario import scenario_names
from higvf_console.ui.page.access import Role
from tests.attacks.test_seats import link_of
from tests.browser import console_page, press, screenshot, shown, wait_until
from tests.consoles import Running, console_at_work
from tests.scenario.test_kept_texts import gone_process

pytestmark = pytest.mark.browser
EASY = """
version: 1
title: An easy one
arena: {size_m: [400, 300]}
robots: {start_m: [[100, 150], [100, 200]]}
fires: [{at_m: [170, 175], radius_m: 5, growth_m_per_s: 0}]
duration_s: 20
"""


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """A short run that waits for its start, with a draft that another console left."""
    folder: Path = tmp_path_factory.mktemp("state")
    file = folder / "easy.yaml"
    file.write_text(EASY, encoding="utf-8")
    write_whole(draft_file(folder, gone_process()), EASY.replace("An easy one", "An unsaved one"))
    with console_at_work(str(file), attended=True, folder=folder) as running:
        yield running


@pytest.fixture(scope="module")
def page(chromium: Browser, running: Running) -> Iterator[Page]:
    with console_page(chromium, running.url) as page:
        yield page


def phase(running: Running) -> Phase:
    return running.session.snapshot.phase.phase


def test_a_page_that_watches_is_told_who_may_start(chromium: Browser, page: Page, running: Running) -> None:
    expect(page.locator("#run .act").first).to_be_enabled()
    with console_page(chromium, link_of(running, Role.OBSERVER)) as watching:
        card = watching.locator("#run")
        expect(card).to_contain_text("Browser 1 steers: only that page can use these buttons.")
        for name in ("Start", "Other scenario …", "Open it"):
            expect(card.get_by_role("button", name=name)).to_be_disabled()
        expect(card.get_by_role("button", name="Fold")).to_be_enabled()
        screenshot(watching, "run-ready-watching")
    expect(page.locator("#run .idle")).to_have_count(0)


def top(found: Locator) -> float:
    box = found.bounding_box()
    return box["y"] if box else 0.0


def bottom(found: Locator) -> float:
    box = found.bounding_box()
    return box["y"] + box["height"] if box else math.inf


def test_a_run_waits_is_started_ends_and_is_run_again(page: Page, running: Running) -> None:
    card = page.locator("#run")
    expect(card).to_contain_text("Ready: An easy one")
    screenshot(page, "run-ready")
    assert (phase(running), running.session.ticks) == (Phase.READY, 0)
    press(page, "Start")
    expect(card).to_contain_text("All fires are out")
    tools = page.locator("[role=toolbar]")
    wait_until(lambda: top(card) > bottom(tools))
    screenshot(page, "run-ended")
    ticks = running.session.ticks
    with page.expect_download() as download:
        press(page, "Save report")
    report = json.loads(Path(download.value.path()).read_text(encoding="utf-8"))
    assert (report["ended"], report["ticks"]) == ("all_fires_out", ticks)
    press(page, "Continue")
    wait_until(lambda: running.session.ticks > ticks)
    expect(card).not_to_contain_text("All fires are out")
    running.push(ResetRun())
    wait_until(lambda: phase(running) is Phase.ENDED)
    press(page, "Again")
    wait_until(lambda: len(running.given(ResetRun)) == 2)


def test_a_scenario_is_chosen_from_its_picture(page: Page, running: Running) -> None:
    press(page, "Other scenario …")
    dialog = page.locator("#own")
    expect(dialog.locator(".choice svg")).to_have_count(len(scenario_names()))
    screenshot(page, "run-scenarios")
    dialog.get_by_role("button", name="Empty arena").click()
    wait_until(lambda: running.session.scenario.title == "Empty arena")
    expect(page.locator("#run")).to_contain_text("Ready: Empty arena")
    expect(dialog).to_be_hidden()


def test_a_draft_that_was_left_is_opened_from_the_card(page: Page, running: Running) -> None:
    loaded = len(running.given(LoadScenario))
    press(page, "Open it")
    wait_until(lambda: len(running.given(LoadScenario)) == loaded + 1)
    wait_until(shown(page, "An unsaved one"))
