"""What all tests share: a real browser, recorded samples, and what is said when there is none."""

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from playwright.sync_api import Browser, Page, expect

from higvf_console.control.kernel import Kernel
from higvf_console.lab.bench.chromium import NAMES, find_chromium, launched
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.ui.interaction import keys
from tests.browser import (
    NO_NGINX,
    PATIENCE,
    Stage,
    open_console,
    open_stage,
    set_in_use,
    wait_for_stop,
)
from tests.mqtt import NO_MOSQUITTO

settings.register_profile("untimed", deadline=None)  # how long an example takes is no property of ours
settings.load_profile("untimed")

NO_CHROMIUM = f"no Chromium ({', '.join(NAMES)}): install the package 'chromium', or name it by HIGVF_CHROMIUM"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    skipped = [report for report in terminalreporter.stats.get("skipped", []) if NO_CHROMIUM in str(report.longrepr)]
    if skipped:
        terminalreporter.write_line(f"WARNING: {len(skipped)} browser tests were skipped: {NO_CHROMIUM}", yellow=True)
    if any(NO_MOSQUITTO in str(report.longrepr) for report in terminalreporter.stats.get("skipped", [])):
        terminalreporter.write_line(f"WARNING: the tests with an MQTT broker were skipped: {NO_MOSQUITTO}", yellow=True)
    if any(NO_NGINX in str(report.longrepr) for report in terminalreporter.stats.get("skipped", [])):
        terminalreporter.write_line(f"WARNING: the tests behind nginx were skipped: {NO_NGINX}", yellow=True)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """One Chromium for all tests; without one they are skipped, or fail where HIGVF_REQUIRE_BROWSER=1."""
    path = find_chromium()
    if path is None:
        (pytest.fail if os.environ.get("HIGVF_REQUIRE_BROWSER") == "1" else pytest.skip)(NO_CHROMIUM)
    expect.set_options(timeout=PATIENCE * 1000)
    with launched(path) as browser:
        yield browser


@pytest.fixture
def open_page(chromium: Browser) -> Iterator[Callable[[str], Page]]:
    """Opens consoles by their address; closes them after the test."""
    pages: list[Page] = []

    def open_one(url: str) -> Page:
        pages.append(open_console(chromium, url, sharp=True))
        return pages[-1]

    yield open_one
    for page in pages:
        page.context.close()


@pytest.fixture(scope="session")
def whole_stage() -> Iterator[Stage]:
    """The browser layer on a server without an engine."""
    stage = open_stage()
    yield stage
    stage.server.stop()


@pytest.fixture(scope="session")
def whole_page(chromium: Browser, whole_stage: Stage) -> Iterator[Page]:
    """The page that most browser tests share; opening one takes seconds."""
    page = open_console(chromium, whole_stage.url, sharp=True)
    set_in_use(page, False)
    yield page
    page.context.close()


@pytest.fixture(scope="module")
def used_page(whole_page: Page) -> Iterator[Page]:
    """That page, which draws while the tests of a module use it."""
    set_in_use(whole_page, True)
    yield whole_page
    set_in_use(whole_page, False)


@pytest.fixture
def stage(whole_stage: Stage) -> Stage:
    """The shared server, with its notes wiped."""
    notes = whole_stage
    for noted in (notes.strokes, notes.clicks, notes.groups, notes.viewports, notes.pressed, notes.typed):
        noted.clear()
    whole_stage.hears_stop = True
    return whole_stage


@pytest.fixture
def page(used_page: Page, stage: Stage) -> Page:
    """The shared page: nothing focused, the arena fitted, the team not stopped."""
    used_page.evaluate("document.activeElement.blur()")
    used_page.keyboard.press("f")
    for stopped, shown in ((True, "stopped"), (False, "ready")):  # settles a STOP of the test before
        keys.show_stopped(stage.server, stopped)
        wait_for_stop(used_page, shown)
    stage.pressed.clear()
    return used_page


@pytest.fixture
def plain_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels run as plain Python, so that a test of a few calls compiles nothing; the last bits may differ."""

    def plain(self: Kernel, *arguments: Any, **named: Any) -> Any:
        return self.py_func(*arguments, **named)

    monkeypatch.setattr(Kernel, "__call__", plain)


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Ctrl-C raises KeyboardInterrupt, as in a terminal; programs in the background ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def sample() -> Callable[[str], Path]:
    """Finds a recorded sample; skips the test where it is missing."""

    def found(name: str) -> Path:
        root = os.environ.get("HIGVF_SAMPLES") or Path(__file__).parents[2] / "shared" / "samples"
        path = Path(root) / name
        if not path.is_file():
            pytest.skip(f"recorded sample {name} is missing; HIGVF_SAMPLES names its folder")
        return path

    return found


TEAM = """
version: 1
name: team
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350], [730, 350]], jitter_m: 2}
fires:
  - {at_m: [500, 250], radius_m: 20, robots_needed: 2}
duration_s: 20
"""


@pytest.fixture(name="team")
def _team() -> Scenario:
    """A scenario small enough to tick a few times."""
    return parse_scenario(TEAM, "team.yaml")
