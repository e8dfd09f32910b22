"""The view leaves viser time to send, and lets no answer to the operator wait; with a clock of its own."""

import threading
import time
from collections.abc import Sequence
from types import SimpleNamespace
from typing import cast

import pytest

from higvf_console.ui.console import REST, Console
from higvf_console.ui.frame_pace import FRAME


class Clock:
    """Time that passes only when something takes it; ends the view after ten frames.

    It is both signals that the view waits for: that it shall end, and that the operator has been answered.
    """

    def __init__(self, frame: float, answers: Sequence[float] = ()) -> None:
        self.now, self.frame, self.answers = 0.0, frame, list(answers)
        self.gaps, self.shown = list[float](), list[float]()

    def show(self, _snapshot: object) -> None:
        self.shown.append(self.now)
        self.now += self.frame

    def is_set(self) -> bool:
        return len(self.gaps) == 10

    def clear(self) -> None:
        pass

    def wait(self, seconds: float) -> None:
        self.gaps.append(seconds)
        end = self.now + seconds
        self.now = self.answers.pop(0) if self.answers and self.answers[0] < end else end


def run(monkeypatch: pytest.MonkeyPatch, clock: Clock) -> None:
    monkeypatch.setattr(time, "perf_counter", lambda: clock.now)
    snapshot = SimpleNamespace(lost_time=0.0)
    view = SimpleNamespace(show=clock.show, _session=SimpleNamespace(snapshot=snapshot, answered=clock))
    Console.run(cast(Console, view), cast(threading.Event, clock))


@pytest.mark.parametrize("share", [0.1, 0.9, 3.0])
def test_pages_get_what_was_shown_however_long_a_frame_takes(monkeypatch: pytest.MonkeyPatch, share: float) -> None:
    clock = Clock(share * FRAME)
    run(monkeypatch, clock)
    assert min(clock.gaps) >= 0.999 * REST
    if share < 0.3:
        assert clock.now == pytest.approx(10 * FRAME), "a quiet machine shows every frame"


def test_an_answer_to_the_operator_is_shown_at_once_and_delays_no_other_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    early, late = 2.2 * FRAME, 5.9 * FRAME
    clock = Clock(0.01 * FRAME, [early, late])
    run(monkeypatch, clock)
    assert {early, late} <= set(clock.shown)
    assert clock.shown[2:5] == pytest.approx([2 * FRAME, early, 3 * FRAME])
    after = clock.shown[clock.shown.index(late) + 1]
    assert after == pytest.approx(late + 0.01 * FRAME + REST), "what was shown is sent first"
