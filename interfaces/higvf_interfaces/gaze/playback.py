"""Plays classified gaze on the session clock, holding no more of it than what is due in a few seconds."""

from collections.abc import Callable, Iterator

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_interfaces.gaze.fixations import THRESHOLDS, Classified, Fixation, fixation
from higvf_interfaces.gaze.prefetch import Prefetcher
from higvf_interfaces.streams import CLOCK_GRAIN


class GazePlayback:
    """Hands out each sample and each fixation of a recording once, when its time has come.

    Attributes:
        started: whether anything has been played; before, there is no newest sample.
        first_time: when the first sample is due [s].
    """

    def __init__(self, chunks: Callable[[], Iterator[Classified | None]]) -> None:
        """Stands before a recording.

        Args:
            chunks: begins to read the recording, as `Prefetcher` takes it; called again when the session clock has gone
                back.
        """
        self._chunks = Prefetcher(chunks)
        self.first_time = self._chunks.first_time
        self._begin()

    def advance(self, now: float) -> tuple[bool, list[Fixation]]:
        """Plays on to session time `now` [s], or again from the start where that has gone back.

        Returns:
            Whether there are new samples, and the fixations that have ended.
        """
        if now < self._now:
            self._chunks.rewind()
            self._begin()
        self._now = now
        self._chunks.read_on(now)
        new, ended = self._play()
        while (following := self._following()) is not None and following.time[0] <= now + CLOCK_GRAIN:
            self._take()
            also_new, also_ended = self._play()
            new, ended = new or also_new, ended + also_ended
        return new, ended

    def unfinished(self) -> list[Fixation]:
        """What there is so far of the fixation that lasts now, if it is long enough to be one."""
        chunk, newest = self._chunk, self._next - 1
        current = int(np.searchsorted(chunk.first, newest, side="right")) - 1
        if current < 0 or chunk.last[current] <= newest:
            return []
        if chunk.time[newest] - chunk.time[chunk.first[current]] < THRESHOLDS.shortest:
            return []
        return [fixation(chunk, int(chunk.first[current]), newest)]

    @property
    def time(self) -> float:
        """When the newest sample was due [s]."""
        return float(self._chunk.time[self._next - 1])

    @property
    def point(self) -> Floats:
        """The newest sample (2,) [px]."""
        return self._chunk.points[self._next - 1]

    @property
    def seen(self) -> bool:
        """Whether the newest sample saw the eye."""
        return bool(self._chunk.seen[self._next - 1])

    @property
    def ended(self) -> bool:
        """Whether everything has been played."""
        return self._played and self._following() is None

    def _begin(self) -> None:
        self._now = -np.inf
        self.started = False
        self._take()

    @property
    def _played(self) -> bool:
        """Whether the chunk has been played; nothing of the next one is due before."""
        return self._next >= len(self._chunk.time)

    def _following(self) -> Classified | None:
        return self._chunks.following() if self._played else None

    def _take(self) -> None:
        """Goes on with the next chunk; what lies before session time 0 is never played."""
        self._chunk = chunk = self._chunks.take()
        self._next = int(np.searchsorted(chunk.time, 0.0))
        self._fixation = int(np.searchsorted(chunk.time[chunk.last], 0.0))

    def _play(self) -> tuple[bool, list[Fixation]]:
        """What of the current chunk has fallen due."""
        chunk, until = self._chunk, self._now + CLOCK_GRAIN
        due = max(self._next, int(np.searchsorted(chunk.time, until, side="right")))
        done = max(self._fixation, int(np.searchsorted(chunk.time[chunk.last], until, side="right")))
        ended = [fixation(chunk, int(chunk.first[k]), int(chunk.last[k])) for k in range(self._fixation, done)]
        new = due > self._next
        self._next, self._fixation = due, done
        self.started = self.started or new
        return new, ended
