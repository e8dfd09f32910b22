"""Control goes first where the system allows it, and what has no deadline does not."""

import gc
import os
import sys
from pathlib import Path
from threading import Thread

import pytest

from higvf_console.lab.bench.console_page import console_of
from higvf_console.runtime.background.scheduling import URGENT, USUAL, go_first, keep_loaded, stand_back
from tests.browser import wait_until

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or os.geteuid() != 0 or os.getpriority(os.PRIO_PROCESS, 0) != USUAL,
    reason="only root on Linux, not made nice itself, may let a thread go first",
)


def niceness() -> int:
    return os.getpriority(os.PRIO_PROCESS, 0)


def on_a_thread(*steps: object) -> list[int]:
    """The niceness after each step, on a thread of its own, and that of a thread started at the end."""
    found = list[int]()

    def run() -> None:
        for step in steps:
            assert callable(step)
            step()
            found.append(niceness())
        heir = Thread(target=lambda: found.append(niceness()))
        heir.start()
        heir.join()

    thread = Thread(target=run)
    thread.start()
    thread.join()
    return found


def test_a_thread_goes_first_with_those_that_it_starts_until_it_stands_back() -> None:
    assert on_a_thread(go_first) == [URGENT, URGENT]
    assert on_a_thread(go_first, stand_back) == [URGENT, USUAL, USUAL]
    assert on_a_thread(stand_back) == [USUAL, USUAL]
    assert niceness() == USUAL


def test_a_thread_that_was_made_nice_on_purpose_stays_so() -> None:
    assert on_a_thread(lambda: os.nice(7), go_first, stand_back) == [7, 7, 7, 7]


def test_a_live_console_controls_and_shows_first_and_waits_and_looks_ahead_as_others_do() -> None:
    with console_of("firefighting") as server:

        def count(nice: int) -> int:
            threads = [int(thread.name) for thread in Path(f"/proc/{server.process}/task").iterdir()]
            return [os.getpriority(os.PRIO_PROCESS, thread) for thread in threads].count(nice)

        wait_until(lambda: count(USUAL) >= 3)  # main, previews, the run without an operator
        assert count(URGENT) >= 3  # control, view, server


def test_what_is_loaded_is_kept_out_of_collections() -> None:
    before = gc.get_freeze_count()
    try:
        keep_loaded()
        assert gc.get_freeze_count() > before + 10_000
        assert len(gc.get_objects()) < 10_000
    finally:
        gc.unfreeze()
