"""The session's clock: what commands make of it, and when a tick is due; nothing here waits."""

from threading import Event as Signal
from types import SimpleNamespace
from typing import Any, cast

import pytest

from higvf_console.core.commands import Freeze, Pause, SetSpeed, Step
from higvf_console.runtime import clock as module
from higvf_console.runtime.clock import CATCH_UP, FASTEST, SLOWEST, Clock


@pytest.fixture
def waits(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The clock's waits [s], of which none takes any time: it is 100 s all along."""
    monkeypatch.setattr(module, "perf_counter", lambda: 100.0)
    return []


def signal(waits: list[float]) -> Signal:
    return cast(Signal, SimpleNamespace(wait=waits.append))


def test_a_frozen_clock_advances_by_single_steps_alone() -> None:
    clock = Clock()
    assert clock.advances()
    clock.command(Freeze(True))
    assert not clock.advances()
    clock.command(Step())
    clock.command(Step())
    assert [clock.advances() for _ in range(3)] == [True, True, False]
    clock.command(Freeze(False))
    assert clock.advances()


def test_steps_that_were_not_taken_are_forgotten_when_the_clock_runs_or_halts() -> None:
    clock = Clock()
    clock.command(Freeze(True))
    clock.command(Step())
    clock.halt()
    assert not clock.advances()
    assert clock.frozen


def test_a_step_is_refused_while_the_run_stands() -> None:
    clock = Clock()
    clock.command(Freeze(True))
    assert "start the run" in clock.command(Step(), stands=True)
    assert not clock.advances()


@pytest.mark.parametrize("factor", [SLOWEST / 2, FASTEST * 2, float("nan")])
def test_a_speed_out_of_range_is_refused_with_the_range(factor: float) -> None:
    clock = Clock()
    assert f"choose {SLOWEST:g} to {FASTEST:g}" in clock.command(SetSpeed(factor))
    assert clock.speed == 1.0


def test_other_commands_change_nothing() -> None:
    clock = Clock()
    assert clock.command(Pause()) == ""
    assert (clock.frozen, clock.speed) == (False, 1.0)


def test_a_slowed_clock_is_due_at_a_share_of_the_beats_and_a_fast_one_at_all() -> None:
    clock = Clock()
    clock.set_speed(0.25)
    assert [clock.beat() for _ in range(8)] == [False, False, False, True] * 2
    clock.set_speed(4.0)
    assert all(clock.beat() for _ in range(8))


def test_the_clock_waits_for_the_next_beat_and_a_fast_one_waits_less(waits: list[float]) -> None:
    clock = Clock()
    assert clock.wait(99.99, 0.02, signal(waits)) == (pytest.approx(100.01), 0.0)
    clock.set_speed(4.0)
    clock.wait(99.999, 0.02, signal(waits))
    assert waits == [pytest.approx(0.01), pytest.approx(0.004)]


def test_a_late_loop_catches_up_a_few_ticks_and_gives_up_the_rest(waits: list[float]) -> None:
    clock, late = Clock(), 10.0
    due, lost = clock.wait(100.0 - late, 0.02, signal(waits))
    assert waits == [], "there is no time to wait"
    assert lost == pytest.approx(late - (CATCH_UP + 1) * 0.02)
    assert due == pytest.approx(100.0 - CATCH_UP * 0.02)
    assert clock.lost == lost


def test_lost_time_adds_up(waits: list[float]) -> None:
    clock = Clock()
    lost: list[Any] = [clock.wait(99.0, 0.02, signal(waits))[1] for _ in range(2)]
    assert clock.lost == pytest.approx(sum(lost))
