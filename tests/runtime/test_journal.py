"""The journal of a session: events and commands are bounded, and a recording that fails ends alone."""

import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import Cursor, OperatorCommand, Pick, StrokePoints
from higvf_console.core.events import Event, Severity
from higvf_console.runtime import journal as module
from higvf_console.runtime.journal import Journal
from higvf_console.scenario.scenario import Scenario


class FullDisk:
    """A recorder that notes what it is given, until the disk is full."""

    def __init__(self, room: int = 10**6) -> None:
        self.room = room
        self.given: list[object] = []

    def command(self, command: OperatorCommand, _: Scenario | None) -> None:
        if len(self.given) >= self.room:
            raise OSError(28, "No space left on device")
        self.given.append(command)

    def keep(self) -> None:
        self.given.append("keep")


def test_cursors_and_points_are_recorded_and_not_listed() -> None:
    recorder = FullDisk()
    journal = Journal(recorder)  # pyright: ignore[reportArgumentType]
    given = [Pick(1), Cursor(floats([1.0, 2.0])), StrokePoints(floats([[1.0, 2.0]])), Pick(0)]
    for time, command in enumerate(given):
        journal.command(float(time), command, None, recorded=True)
    assert recorder.given == given
    assert [(applied.time, applied.command) for applied in journal.commands] == [(0.0, given[0]), (3.0, given[3])]
    assert journal.applied == 2


def test_what_a_replay_does_not_need_is_listed_and_not_recorded() -> None:
    recorder = FullDisk()
    journal = Journal(recorder)  # pyright: ignore[reportArgumentType]
    journal.command(0.0, Pick(1), None, recorded=False)
    assert recorder.given == []
    assert journal.applied == 1


def test_a_recording_that_fails_is_reported_once_and_the_session_goes_on() -> None:
    recorder = FullDisk(room=1)
    journal = Journal(recorder)  # pyright: ignore[reportArgumentType]
    for time in range(4):
        journal.command(float(time), Pick(time), None, recorded=True)
        journal.keep(float(time))
    assert recorder.given == [Pick(0), "keep"]
    assert [(event.time, event.severity, event.text) for event in journal.events] == [
        (1.0, Severity.ALARM, "The recording ends here: No space left on device.")
    ]
    assert len(journal.commands) == 4


def test_the_latest_events_and_commands_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "EVENTS_KEPT", 3)
    monkeypatch.setattr(module, "COMMANDS_KEPT", 2)
    journal = Journal()
    for number in range(5):
        journal.add((Event(float(number), Severity.INFO, "test", str(number)),))
        journal.command(float(number), Pick(number), None, recorded=True)
    assert [event.text for event in journal.events] == ["2", "3", "4"]
    assert [applied.command for applied in journal.commands] == [Pick(3), Pick(4)]
    assert journal.applied == 5


def test_nothing_is_refused_for_no_reason() -> None:
    journal = Journal()
    journal.refuse(1.0, "")
    assert journal.events == ()
    journal.refuse(2.0, "Not done: it is late.")
    assert [(event.time, event.kind, event.text) for event in journal.events] == [
        (2.0, "refused", "Not done: it is late.")
    ]
