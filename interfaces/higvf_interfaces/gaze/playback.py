"""Playback of a gaze recording on the session clock, in bounded memory."""

from collections.abc import Callable, Iterator

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_interfaces.gaze.fixations import THRESHOLDS, Classified, Fixation, fixation
from higvf_interfaces.gaze.prefetch import Prefetcher
from higvf_interfaces.streams import CLOCK_GRAIN, RunClock


class GazePlayback:
    """Plays each sample and each fixation of a recording once, when it is due.

    Attributes:
        started: whether a sample has been played; the newest sample is undefined before.
        first_time: session time of the first sample [s].
    """

    def __init__(self, chunks: Callable[[], Iterator[Classified | None]]) -> None:
        """Start before the first sample.

        Args:
            chunks: opens the recording; see `Prefetcher`.
        """
        self._chunks = Prefetcher(chunks)
        self.first_time = self._chunks.first_time
        self._clock = RunClock()
        self._begin()

    def advance(self, now: float) -> tuple[bool, list[Fixation]]:
        """Play up to session time `now` [s], from the start if the clock went back.

        Returns:
            Whether there are new samples, and the fixations that have ended since the last call.
        """
        if self._clock.was_reset(now):
            self._chunks.rewind()
            self._begin()
        self._chunks.read_on(now)
        new, ended = self._play()
        while (following := self._following()) is not None and following.time[0] <= now + CLOCK_GRAIN:
            self._take()
            also_new, also_ended = self._play()
            new, ended = new or also_new, ended + also_ended
        return new, ended

    def unfinished(self) -> list[Fixation]:
        """Return the part played so far of the current fixation, if it is long enough to be a fixation."""
        chunk, newest = self._chunk, self._next - 1
        current = int(np.searchsorted(chunk.first, newest, side="right")) - 1
        if current < 0 or chunk.last[current] <= newest:
            return []
        if chunk.time[newest] - chunk.time[chunk.first[current]] < THRESHOLDS.shortest:
            return []
        return [fixation(chunk, int(chunk.first[current]), newest)]

    @property
    def time(self) -> float:
        """Session time of the newest sample [s]."""
        return float(self._chunk.time[self._next - 1])

    @property
    def point(self) -> Floats:
        """Position of the newest sample (2,) [px]."""
        return self._chunk.points[self._next - 1]

    @property
    def seen(self) -> bool:
        """Whether gaze is known at the newest sample."""
        return bool(self._chunk.seen[self._next - 1])

    @property
    def ended(self) -> bool:
        """Whether the whole recording has been played."""
        return self._played and self._following() is None

    def _begin(self) -> None:
        self.started = False
        self._take()

    @property
    def _played(self) -> bool:
        """Whether the current chunk has been played."""
        return self._next >= len(self._chunk.time)

    def _following(self) -> Classified | None:
        return self._chunks.following() if self._played else None

    def _take(self) -> None:
        """Load the next chunk; samples before session time 0 are skipped."""
        self._chunk = chunk = self._chunks.take()
        self._next = int(np.searchsorted(chunk.time, 0.0))
        self._fixation = int(np.searchsorted(chunk.time[chunk.last], 0.0))

    def _play(self) -> tuple[bool, list[Fixation]]:
        """Play the part of the current chunk that is due."""
        chunk, until = self._chunk, self._clock.now + CLOCK_GRAIN
        due = max(self._next, int(np.searchsorted(chunk.time, until, side="right")))
        done = max(self._fixation, int(np.searchsorted(chunk.time[chunk.last], until, side="right")))
        ended = [fixation(chunk, int(chunk.first[k]), int(chunk.last[k])) for k in range(self._fixation, done)]
        new = due > self._next
        self._next, self._fixation = due, done
        self.started = self.started or new
        return new, ended
