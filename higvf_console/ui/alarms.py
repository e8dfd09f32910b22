"""Alarms: one stands until somebody has acknowledged it or its cause has ended, whichever is first.

    events of the run  --  Alarms.update  ->  UiState.alarms  ->  panels show them
    button, page       --  acknowledge_alarms

To acknowledge is a matter of the view: it says that somebody has read the alarm, and commands nothing.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from time import monotonic
from typing import TYPE_CHECKING

from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import ChannelState
from higvf_console.sim.events import too_near
from higvf_console.ui.messages import newer
from higvf_console.ui.ui_state import Change, UiStore

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

ALARM_S = 5.0  # an alarm stands at least so long, however short its cause
MOST_ALARMS = 99  # that wait to be acknowledged; older ones are let go
_OFF = frozenset({ChannelState.LOST, ChannelState.RECOVERED})


class Alarms:
    """Keeps the alarms of the `UiState` in step with the run."""

    def __init__(self, ui: UiStore, clock: Callable[[], float] = monotonic) -> None:
        """Has seen no event yet.

        Args:
            ui: where the alarms are kept.
            clock: seconds of a clock that does not stop.
        """
        self._ui, self._clock = ui, clock
        self._newest: Event | None = None
        self._since: dict[int, float] = {}  # when an alarm was first seen [s], by its identity

    def update(self, snapshot: "Snapshot") -> None:
        """Adds the alarms among the events that are new, and withdraws those whose cause has ended."""
        if fresh := newer(snapshot.events, self._newest):
            self._newest = fresh[-1]
            self._ui.change(add_alarms(fresh))
        now, alarms = self._clock(), self._ui.state.alarms
        self._since = {id(alarm): self._since.get(id(alarm), now) for alarm in alarms}
        seen = [alarm for alarm in alarms if now - self._since[id(alarm)] >= ALARM_S]
        if ended := [alarm for alarm in seen if not cause_lasts(alarm, snapshot)]:
            self._ui.change(withdraw_alarms(ended))


def add_alarms(events: Sequence[Event]) -> Change:
    """The alarms among some events wait to be acknowledged."""
    alarms = tuple(event for event in events if event.severity == Severity.ALARM)
    return lambda state: replace(state, alarms=(*state.alarms, *alarms)[-MOST_ALARMS:]) if alarms else state


def acknowledge_alarms(text: str | None = None) -> Change:
    """The alarms with a text are acknowledged; None = all."""
    return lambda state: replace(
        state, alarms=tuple(alarm for alarm in state.alarms if text is not None and alarm.text != text)
    )


def withdraw_alarms(ended: Sequence[Event]) -> Change:
    """The alarms whose cause has ended wait no longer."""
    gone = {id(alarm) for alarm in ended}
    return lambda state: replace(state, alarms=tuple(alarm for alarm in state.alarms if id(alarm) not in gone))


def cause_lasts(alarm: Event, snapshot: "Snapshot") -> bool:
    """Whether what an alarm tells still holds; one whose cause cannot be seen to end lasts until it is read."""
    match alarm.kind:
        case "stop":
            return snapshot.state.intent.stopped
        case "infeasible":
            return _in_trouble(alarm, snapshot.trace.infeasible.tolist())
        case "clearance":
            return _in_trouble(alarm, too_near(snapshot.trace).tolist())
        case "channel":
            states = {health.state for channel, health in snapshot.channels if alarm.channel in ("", channel)}
            return bool(states & _OFF)
        case _:
            return True


def _in_trouble(alarm: Event, robots: list[bool]) -> bool:
    robot = alarm.robot
    return any(robots) if robot is None or robot >= len(robots) else robots[robot]
