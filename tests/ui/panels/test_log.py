"""No alarm is left out of the notifications, however late they are renewed."""

from types import SimpleNamespace
from typing import Any, cast

import pytest
import viser

from higvf_console.core.events import Event, Severity
from higvf_console.ui.page import page
from higvf_console.ui.panels.log import MOST_AT_ONCE, LogPanel, Notifications
from higvf_console.ui.ui_state import UiStore, acknowledge_alarms


class Note:
    """A notification on a page."""

    def __init__(self, text: str, notes: list["Note"]) -> None:
        self.text, self._notes = text, notes
        notes.append(self)

    def remove(self) -> None:
        self._notes.remove(self)


@pytest.fixture
def notes() -> list[Note]:
    """The notifications that the one page shows."""
    return []


@pytest.fixture
def ui() -> UiStore:
    return UiStore()


@pytest.fixture
def panel(monkeypatch: pytest.MonkeyPatch, notes: list[Note], ui: UiStore) -> LogPanel:
    def nothing(*_: object) -> None:
        pass

    def widget(*_: object, **__: object) -> SimpleNamespace:
        return SimpleNamespace(on_click=nothing)

    def notify(_title: str, text: str, **_: object) -> Note:
        return Note(text, notes)

    for name in ("listen", "install"):
        monkeypatch.setattr(page, name, nothing)
    gui = SimpleNamespace(add_button=widget, add_html=widget)
    client = SimpleNamespace(add_notification=notify)
    server = SimpleNamespace(gui=gui, get_clients=lambda: {0: client})
    return LogPanel(cast(viser.ViserServer, server), ui)


def stop(time: float) -> Event:
    return Event(time, Severity.ALARM, "stop", "STOP: all robots stand still.")


def snapshot(*events: Event) -> Any:
    return SimpleNamespace(events=events)


def test_the_next_alarm_of_a_kind_is_notified_though_the_last_was_acknowledged_only_just_now(
    panel: LogPanel, ui: UiStore, notes: list[Note]
) -> None:
    first, second = stop(1.0), stop(9.0)
    panel.update(snapshot(first))
    assert len(notes) == 1
    ui.change(acknowledge_alarms())
    panel.update(snapshot(first, second))
    assert len(notes) == 1, "the first is taken back, and the second shown"
    assert ui.state.alarms == (second,)
    panel.update(snapshot(first, second))
    assert len(notes) == 1


def test_an_alarm_that_still_stands_is_not_notified_twice(panel: LogPanel, notes: list[Note]) -> None:
    first, second = stop(1.0), stop(9.0)
    panel.update(snapshot(first))
    panel.update(snapshot(first, second))
    assert len(notes) == 1


def test_an_acknowledged_alarm_is_taken_back(panel: LogPanel, ui: UiStore, notes: list[Note]) -> None:
    alarm = stop(1.0)
    panel.update(snapshot(alarm))
    ui.change(acknowledge_alarms(alarm.text))
    panel.update(snapshot(alarm))
    assert notes == []


def test_what_happens_after_an_alarm_does_not_push_it_out() -> None:
    alarm = stop(1.0)
    later = [Event(1.0 + k, Severity.WARNING, f"kind {k}", "It happened.") for k in range(5)]
    assert Notifications().chosen([alarm, *later], 0.0) == [alarm, *later[-MOST_AT_ONCE:]]
