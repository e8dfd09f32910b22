"""The one line that tells the latest message, and which events are new."""

from collections.abc import Sequence

from higvf_console.core.events import Event, Severity

STAY_S = {Severity.INFO: 4.0, Severity.GOOD: 6.0, Severity.WARNING: 8.0, Severity.ALARM: 8.0}  # ahead of older alarms
_ANSWERS = frozenset({"refused", "clipped"})  # to what the operator did last


def _rank(event: Event) -> int:
    """The higher of two events keeps the line; an answer to what was done is as high as an alarm."""
    ranks = {Severity.INFO: 0, Severity.GOOD: 1, Severity.WARNING: 2, Severity.ALARM: 3}
    return ranks[Severity.ALARM if event.kind in _ANSWERS else event.severity]


class LatestMessage:
    """Chooses the message to be shown: the latest, then an alarm that still stands, then the latest again.

    A message keeps the line for a while against lesser ones. What the operator has just done is seen anyway and only
    logged.
    """

    def __init__(self) -> None:
        """Nothing has happened."""
        self._latest: Event | None = None
        self._until = 0.0  # [s]

    def chosen(self, fresh: Sequence[Event], standing: Sequence[Event], now: float) -> Event | None:
        """The message at `now` [s].

        Args:
            fresh: what is new, oldest first.
            standing: alarms that nobody has read and whose cause lasts, oldest first.
            now: time of a clock that does not stop [s].
        """
        for event in fresh:
            if event.severity != Severity.INFO or event.kind == "target":
                if self._latest is not None and now < self._until and _rank(event) < _rank(self._latest):
                    continue
                self._latest, self._until = event, now + STAY_S[event.severity]
        if standing and now >= self._until:
            return standing[-1]
        latest = self._latest
        ended = latest is not None and latest.severity == Severity.ALARM and not any(latest is one for one in standing)
        return None if ended and now >= self._until else latest


def newer(events: Sequence[Event], newest: Event | None) -> list[Event]:
    """The events after one that was seen, oldest first; all of them when it is no longer kept."""
    fresh: list[Event] = []
    for event in reversed(events):
        if event is newest:
            break
        fresh.append(event)
    return fresh[::-1]
