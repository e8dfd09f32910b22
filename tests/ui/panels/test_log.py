"""Alarms wait to be read, and are withdrawn when their cause has ended."""

from types import SimpleNamespace
from typing import Any, cast

import pytest
import viser

from higvf_console.core.events import Event, Severity
from higvf_console.ui.page import page
from higvf_console.ui.panels import log
from higvf_console.ui.panels.log import ALARM_S, LogPanel
from higvf_console.ui.ui_state import UiStore, acknowledge_alarms

STOP = Event(1.0, Severity.ALARM, "stop", "STOP: all robots stand still.")


@pytest.fixture
def ui() -> UiStore:
    return UiStore()


@pytest.fixture
def now(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A clock that only the test moves."""
    now = SimpleNamespace(seconds=100.0)
    monkeypatch.setattr(log.clock, "monotonic", lambda: now.seconds)
    return now


@pytest.fixture
def panel(monkeypatch: pytest.MonkeyPatch, ui: UiStore, now: SimpleNamespace) -> LogPanel:  # noqa: ARG001
    def nothing(*_: object) -> None:
        pass

    def widget(*_: object, **__: object) -> SimpleNamespace:
        return SimpleNamespace(on_click=nothing)

    monkeypatch.setattr(page, "listen", nothing)
    gui = SimpleNamespace(add_button=widget, add_html=widget)
    return LogPanel(cast(viser.ViserServer, SimpleNamespace(gui=gui)), ui)


def snapshot(*events: Event, stopped: bool) -> Any:
    return SimpleNamespace(events=events, state=SimpleNamespace(intent=SimpleNamespace(stopped=stopped)))


def test_an_alarm_is_withdrawn_when_its_cause_has_ended_but_not_before_it_could_be_seen(
    panel: LogPanel, ui: UiStore, now: SimpleNamespace
) -> None:
    panel.update(snapshot(STOP, stopped=True))
    now.seconds += 2 * ALARM_S
    panel.update(snapshot(STOP, stopped=True))
    assert ui.state.alarms == (STOP,)
    panel.update(snapshot(STOP, stopped=False))
    assert ui.state.alarms == ()


def test_an_alarm_of_a_short_cause_stands_for_a_while(panel: LogPanel, ui: UiStore, now: SimpleNamespace) -> None:
    panel.update(snapshot(STOP, stopped=False))
    now.seconds += 0.9 * ALARM_S
    panel.update(snapshot(STOP, stopped=False))
    assert ui.state.alarms == (STOP,)
    now.seconds += 0.2 * ALARM_S
    panel.update(snapshot(STOP, stopped=False))
    assert ui.state.alarms == ()


def test_a_withdrawn_or_acknowledged_alarm_does_not_come_back(panel: LogPanel, ui: UiStore) -> None:
    panel.update(snapshot(STOP, stopped=True))
    ui.change(acknowledge_alarms())
    panel.update(snapshot(STOP, stopped=True))
    assert ui.state.alarms == ()
