"""What a session reports and writes down: events for the operator, commands, recording, markers for other devices."""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple, ParamSpec

from higvf_console.channels.input_reports import calibration_event
from higvf_console.channels.marker_outlet import MarkerOutlet
from higvf_console.core.commands import Cursor, OperatorCommand, StrokePoints
from higvf_console.core.events import Event, Severity
from higvf_console.core.reports import CalibrationReport
from higvf_console.core.state import Motion
from higvf_console.runtime.recording import Recorder
from higvf_console.scenario.scenario import Scenario
from higvf_console.team.state import TeamReport

EVENTS_KEPT = 2000
COMMANDS_KEPT = 20_000
P = ParamSpec("P")


class AppliedCommand(NamedTuple):
    """A command and the session time at which it was applied [s]."""

    time: float
    command: OperatorCommand


class Journal:
    """The events and the commands of a session; a recording that fails ends with an event, and the session goes on.

    Attributes:
        events: the latest, oldest first.
        commands: the latest that were applied, without cursors and stroke points, which come by the thousand.
        applied: how many of these there were.
    """

    def __init__(self, recorder: Recorder | None = None, markers: MarkerOutlet | None = None) -> None:
        """Starts empty.

        Args:
            recorder: writes everything down.
            markers: reports to the laboratory's other devices.
        """
        self.events: tuple[Event, ...] = ()
        self.commands: deque[AppliedCommand] = deque(maxlen=COMMANDS_KEPT)
        self.applied = 0
        self._recorder, self._markers = recorder, markers

    def add(self, events: tuple[Event, ...]) -> None:
        """Reports what happened."""
        if self._markers is not None:
            for event in events:
                self._markers.event(event)
        if events:
            self.events = (self.events + events)[-EVENTS_KEPT:]

    def refuse(self, time: float, text: str) -> None:
        """Reports why something was not done at session `time` [s]; an empty text says that it was."""
        if text:
            self.add((Event(time, Severity.WARNING, "refused", text),))

    def command(self, time: float, command: OperatorCommand, scenario: Scenario | None, *, recorded: bool) -> None:
        """A command was applied.

        Args:
            time: session time [s].
            command: what was applied.
            scenario: in force from then on.
            recorded: whether a replay needs it.
        """
        if not isinstance(command, Cursor | StrokePoints):
            self.applied += 1
            self.commands.append(AppliedCommand(time, command))
            if self._markers is not None:
                self._markers.command(time, command)
        if self._recorder is not None and recorded:
            self._record(time, self._recorder.command, command, scenario)

    def calibration(self, time: float, channel: str, report: CalibrationReport) -> None:
        """An input has a new calibration, at session `time` [s]."""
        self.add((calibration_event(channel, report, time),))
        if self._recorder is not None:
            self._record(time, self._recorder.calibration, channel, report)

    def team(self, time: float, report: TeamReport) -> None:
        """A team was heard, at session `time` [s]."""
        if self._recorder is not None:
            self._record(time, self._recorder.team, report)

    def step(self, time: float, motion: Motion) -> None:
        """A control period was done, up to session `time` [s]."""
        if self._recorder is not None:
            self._record(time, self._recorder.step, motion)

    def keep(self, time: float) -> None:
        """Lets the recording reach the disk in time; to be called in every tick, whether the clock stands or not."""
        if self._recorder is not None:
            self._record(time, self._recorder.keep)

    def close(self, time: float) -> None:
        """Completes the recording."""
        if self._recorder is not None:
            self._record(time, self._recorder.close)

    def _record(self, time: float, write: Callable[P, object], *args: P.args, **kwargs: P.kwargs) -> None:
        try:
            write(*args, **kwargs)
        except (OSError, TypeError, ValueError) as error:  # the last two: what JSON does not know
            self._recorder = None
            text = f"The recording ends here: {getattr(error, 'strerror', None) or error}."
            self.add((Event(time, Severity.ALARM, "recording", text),))
