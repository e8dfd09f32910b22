"""Decision feeds: the protocol of all sources of decisions, and the replay of a log of labels."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from higvf_console.core.arrays import floats
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.streams import Playhead


class Due(NamedTuple):
    """A decision that is due; `number` counts the decisions of one replay from 0."""

    number: int
    decision: Decision


class DecisionFeed(Protocol):
    """A source of decisions on the session clock; it restarts when the session time goes back (the run was reset)."""

    @property
    def labels(self) -> Sequence[str]:
        """All labels that the feed can give."""
        ...

    @property
    def notes(self) -> Sequence[str]:
        """Repairs and assumptions."""
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
        """Return the decisions that became due by session time `now` [s], in order of time."""
        ...


class LogFeed:
    """Replay of a log of decisions on the session clock."""

    def __init__(self, log: CommandLog, start: float) -> None:
        """Play `log` shifted by `start` [s]; decisions shifted before 0 are not played."""
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
