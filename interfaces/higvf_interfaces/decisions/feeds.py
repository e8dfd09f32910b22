"""Where a channel's decisions come from: a log of labels, a decoder at work on a recording, or either made worse."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from higvf_console.core.arrays import floats
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.streams import Playhead


class Due(NamedTuple):
    """A decision whose time has come; `number` counts the decisions of one play from 0."""

    number: int
    decision: Decision


class DecisionFeed(Protocol):
    """Decisions by session time. When the time goes back, the run has started again and so does the feed."""

    @property
    def labels(self) -> Sequence[str]:
        """Every label that it can give."""
        ...

    @property
    def notes(self) -> Sequence[str]:
        """What was repaired or assumed, in words."""
        ...

    @property
    def started(self) -> bool:
        """Whether anything has been played."""
        ...

    @property
    def ended(self) -> bool:
        """Whether everything has been played."""
        ...

    def due(self, now: float) -> list[Due]:
        """Decisions that have fallen due by session time `now` [s], in order of time."""
        ...


class LogFeed:
    """A log of decisions, played on the session clock."""

    def __init__(self, log: CommandLog, start: float) -> None:
        """Plays `log` from session time `start` on [s]; what that moves before 0 is not played."""
        self._decisions = tuple(decision._replace(time=decision.time + start) for decision in log.decisions)
        self._playhead = Playhead(floats([decision.time for decision in self._decisions]))
        self.labels: Sequence[str] = sorted({decision.label for decision in self._decisions})
        self.notes: Sequence[str] = log.notes

    @property
    def started(self) -> bool:
        """Whether anything has been played."""
        return self._playhead.started

    @property
    def ended(self) -> bool:
        """Whether everything has been played."""
        return self._playhead.ended

    def due(self, now: float) -> list[Due]:
        """Decisions that have fallen due by session time `now` [s]."""
        return [Due(index, self._decisions[index]) for index in self._playhead.advance(now)]
