"""Reports of one kind, each interval at most one: whoever repeats a fault fills neither a log nor a memory."""

from collections.abc import Hashable

EVERY = 60.0  # [s]
_MOST_KINDS = 1024


class Limiter:
    """Counts what is not reported, by kind."""

    def __init__(self, every: float = EVERY) -> None:
        """Starts with nothing reported.

        Args:
            every: shortest time between two reports of one kind [s].
        """
        self._every = every
        self._reported: dict[Hashable, float] = {}
        self._silent: dict[Hashable, int] = {}

    def due(self, kind: Hashable, now: float, count: int = 1) -> int:
        """How many have come since the last report of this kind, if one is due; 0 where it is not.

        Args:
            kind: of the report.
            now: any clock that runs on [s].
            count: how many have come now.
        """
        if kind not in self._reported and len(self._reported) >= _MOST_KINDS:
            kind = None  # all further kinds count as one
        total = self._silent.get(kind, 0) + count
        if now - self._reported.get(kind, -self._every) < self._every:
            self._silent[kind] = total
            return 0
        self._reported[kind], self._silent[kind] = now, 0
        return total
