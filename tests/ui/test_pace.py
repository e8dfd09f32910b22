"""The view leaves viser time to send; with a clock of its own."""

import threading
import time
from types import SimpleNamespace
from typing import cast

import pytest

from higvf_console.ui.console import FRAME, REST, Console


class Clock:
    """Time that passes only when something takes it; ends the view after ten frames."""

    def __init__(self, frame: float) -> None:
        self.now, self.frame, self.gaps = 0.0, frame, list[float]()

    def show(self, _snapshot: object) -> None:
        self.now += self.frame

    def is_set(self) -> bool:
        return len(self.gaps) == 10

    def wait(self, seconds: float) -> None:
        self.gaps.append(seconds)
        self.now += seconds


@pytest.mark.parametrize("share", [0.1, 0.9, 3.0])
def test_pages_get_what_was_shown_however_long_a_frame_takes(monkeypatch: pytest.MonkeyPatch, share: float) -> None:
    clock = Clock(share * FRAME)
    monkeypatch.setattr(time, "perf_counter", lambda: clock.now)
    view = SimpleNamespace(show=clock.show, _session=SimpleNamespace(snapshot=None))
    Console.run(cast(Console, view), cast(threading.Event, clock))
    assert min(clock.gaps) >= 0.999 * REST
    if share < 0.3:
        assert clock.now == pytest.approx(10 * FRAME), "a quiet machine shows every frame"
