"""What all attacks share: a live console with an honest page, what is measured, and the table at the end."""

import gc
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from higvf_console.runtime.background import scheduling
from higvf_console.runtime.background.worker import Worker
from tests.attacks.raw_page import Login, RawPage, log_in
from tests.attacks.watch import Watch, moves
from tests.browser import wait_until
from tests.consoles import Running, console_at_work
from tests.roles import patient_scenario

HONEST = "the honest page, 16"
_FIGURE = "figure"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Prints the table attack -> figure -> verdict."""
    rows: list[tuple[str, str, str]] = []
    for outcome, verdict in (("passed", "held"), ("failed", "FALLEN")):
        for report in terminalreporter.stats.get(outcome, []):
            if report.when == "call" and "tests/attacks/" in report.nodeid:
                name = report.nodeid.rpartition("::")[2].removeprefix("test_").replace("_", " ")
                figures = ", ".join(str(value) for key, value in report.user_properties if key == _FIGURE)
                rows.append((name, figures, verdict))
    if rows:
        terminalreporter.section("attack -> figure -> verdict")
        widths = [max(len(row[column]) for row in rows) for column in (0, 1)]
        for name, figures, verdict in rows:
            terminalreporter.write_line(f"{name:<{widths[0]}}  {figures:<{widths[1]}}  {verdict}")


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """The firefighting scenario, live, with patience for a busy machine."""
    worker = Worker()
    with console_at_work(patient_scenario(tmp_path_factory.mktemp("attacks")), worker=worker) as running:
        scheduling.keep_loaded()  # as `higvf run` does
        yield running
    gc.unfreeze()
    worker.close()


@pytest.fixture(scope="module")
def login(running: Running) -> Login:
    """Of an attacker."""
    return log_in(running.url)


@pytest.fixture
def honest(running: Running) -> Iterator[RawPage]:
    """A page of another login that was there first, and gives signs of life."""
    with RawPage(running.url) as page:
        stopping = threading.Event()

        def beat() -> None:
            while not stopping.wait(0.5):
                page.hello(HONEST)

        page.hello(HONEST)
        wait_until(lambda: HONEST in running.console._roles._identities.values())  # pyright: ignore[reportPrivateUsage]
        beating = threading.Thread(target=beat, daemon=True)
        beating.start()
        yield page
        stopping.set()
        beating.join()
    wait_until(lambda: not running.console._roles._identities)  # pyright: ignore[reportPrivateUsage]


@pytest.fixture(scope="module")
def whole_watch(running: Running) -> Watch:
    """On the ticks of the console."""
    watch = Watch(running.session)
    running.session.tick = watch.tick
    running.session.pointer.push = watch.push
    return watch


@pytest.fixture
def watch(running: Running, whole_watch: Watch) -> Watch:
    """On the ticks of one attack, which begins with a team that moves."""
    wait_until(lambda: moves(running))
    whole_watch.clear()
    return whole_watch


@pytest.fixture
def figure(record_property: Callable[[str, Any], None]) -> Callable[[str], None]:
    """Notes a figure for the table."""
    return lambda text: record_property(_FIGURE, text)
