"""What the strip over the arena is sent, and what its buttons do; without a browser."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import pytest
import viser

from higvf_console.core.commands import Acknowledge, Freeze, OperatorCommand, Pause, ResetRun, Resume, SetSpeed, Step
from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import ChannelHealth, ChannelState, PointerSink
from higvf_console.runtime.phase import Phase, RunPhase
from higvf_console.sim.simulation import advance
from higvf_console.ui.page import page
from higvf_console.ui.panels.run import RunControls
from higvf_console.ui.panels.status import StatusStrip
from higvf_console.ui.ui_state import UiStore, add_alarms
from higvf_console.ui.widgets.html import TIMES
from tests.teams import team

SETUP = team()
STATE, TRACE = advance(SETUP.start, SETUP.world, SETUP.params)
STOP = Event(1.0, Severity.ALARM, "stop", "STOP: all robots stand still.")
SERVER = cast(viser.ViserServer, SimpleNamespace(get_clients=dict))


def nothing(*_: object) -> None:
    """Does nothing."""


class Page:
    """Notes what the strip is told, and sends what a button sends."""

    def __init__(self) -> None:
        self.told: list[tuple[str, Any]] = []
        self.act: Callable[[int, page.Body], None] = nothing

    def call(self, _server: object, script: str, method: str, view: object) -> None:
        assert script == "strip"
        self.told.append((method, view))

    def listen(self, _server: object, topic: str, callback: Callable[[int, page.Body], None]) -> None:
        assert topic == "run"
        self.act = callback

    def press(self, act: str, value: str = "") -> None:
        self.act(1, {"act": act, "value": value})


@pytest.fixture
def there(monkeypatch: pytest.MonkeyPatch) -> Page:
    there = Page()
    monkeypatch.setattr(page, "call", there.call)
    monkeypatch.setattr(page, "listen", there.listen)
    monkeypatch.setattr(page, "install", nothing)
    return there


def snapshot(*events: Event, time: float = 1.0, gaze: ChannelState = ChannelState.LIVE, **intent: bool) -> Any:
    return SimpleNamespace(
        state=STATE._replace(intent=STATE.intent._replace(**intent)), trace=TRACE, time=time, frozen=False, speed=1.0,
        min_clearance=2.0, tick_ms=0.3, infeasible_ticks=0, deadlock_s=0.0, events=events,
        channels=(("gaze", ChannelHealth(gaze, "why")),), phase=RunPhase(Phase.RUNNING), setup=SETUP, team=None,
        lost_time=0.0,
    )  # fmt: skip


def test_only_what_reads_differently_is_sent_again(there: Page) -> None:
    strip = StatusStrip(SERVER, 0.02, UiStore())
    strip.update(snapshot())
    assert {method for method, _ in there.told} == {"clock", "run", "facts", "alarms", "message", "returned"}
    there.told.clear()
    strip.update(snapshot(time=2.0))
    assert there.told == [("clock", "0:02.0")]


def test_an_alarm_is_told_in_the_line_and_counted_until_it_is_withdrawn(there: Page) -> None:
    ui = UiStore()
    strip = StatusStrip(SERVER, 0.02, ui)
    ui.change(add_alarms([STOP]))
    strip.update(snapshot(STOP, stopped=True))
    told = dict(there.told)
    assert told["alarms"] == "1 alarm"
    assert (told["message"]["text"], told["message"]["unread"]) == (STOP.text, True)
    assert [state["word"] for state in told["run"]["states"]] == ["STOPPED"]


def test_without_a_message_the_line_says_what_the_state_means(there: Page) -> None:
    StatusStrip(SERVER, 0.02, UiStore()).update(snapshot(paused=True))
    assert dict(there.told)["message"]["text"].startswith("Robots hold their place")


def test_inputs_that_are_back_can_be_acknowledged(there: Page) -> None:
    StatusStrip(SERVER, 0.02, UiStore()).update(snapshot(gaze=ChannelState.RECOVERED))
    assert dict(there.told)["returned"] == ["gaze"]


@pytest.fixture
def given() -> list[OperatorCommand]:
    return []


@pytest.fixture
def controls(there: Page, given: list[OperatorCommand]) -> RunControls:  # noqa: ARG001 - the page must be there
    return RunControls(SERVER, cast(PointerSink, SimpleNamespace(push=given.append)))


def test_a_button_means_the_other_of_what_holds(controls: RunControls, there: Page, given: list[Any]) -> None:
    there.press("pause")
    there.press("freeze")
    controls.update(SimpleNamespace(state=snapshot(paused=True).state, frozen=True))  # pyright: ignore[reportArgumentType]
    there.press("pause")
    there.press("freeze")
    there.press("step")
    assert given == [Pause(), Freeze(True), Resume(), Freeze(False), Step()]


def test_a_step_freezes_a_running_clock(controls: RunControls, there: Page, given: list[Any]) -> None:  # noqa: ARG001
    there.press("step")
    assert given == [Freeze(True), Step()]


def test_a_reset_is_pressed_twice(controls: RunControls, there: Page, given: list[Any]) -> None:  # noqa: ARG001
    there.press("reset")
    assert given == []
    there.press("reset")
    assert given == [ResetRun()]


def test_a_speed_that_is_not_offered_is_refused(controls: RunControls, there: Page, given: list[Any]) -> None:  # noqa: ARG001
    there.press("speed", f"8{TIMES}")
    there.press("acknowledge")
    assert given == [SetSpeed(8.0), Acknowledge()]
    with pytest.raises(ValueError, match="'999' is not one of"):
        there.press("speed", "999")
    assert len(given) == 2
