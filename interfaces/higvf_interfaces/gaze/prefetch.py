"""Prefetching of a gaze recording: chunks are read before they are due, at most one block per poll.

A chunk may be a fixation of `chunked_fixations.LONGEST` samples, and a replay reads the file again from its start. If
these were read when due, a poll would block the session. Therefore:

    head, kept in memory | played | prefetched, one block per poll | rest of the file
    0 s              AHEAD       now                       now + AHEAD

After a rewind the head is played from memory while reading catches up.
"""

import math
from collections import deque
from collections.abc import Callable, Iterator

from higvf_interfaces.gaze.fixations import Classified

AHEAD = 6.0  # at one block per poll and 50 polls per second the longest chunk is read in 5.2 s [s]


class Prefetcher:
    """Queue of the chunks to be played; chunks before session time 0 are skipped.

    Attributes:
        first_time: session time of the recording's first sample [s]; NaN if it has none.
    """

    def __init__(self, chunks: Callable[[], Iterator[Classified | None]]) -> None:
        """Read the head.

        Args:
            chunks: opens the recording and returns an iterator with one item per block: a chunk, or None if the block
                completes no chunk. Called again at a rewind if the recording is longer than the head.

        Raises:
            InputError: If the recording cannot be read.
        """
        self._open = chunks
        self._stream = chunks()
        self._ready: deque[Classified] = deque()
        self._over = False
        self.first_time = math.nan
        self._known = self._again = 0  # items of the head; items of the head still to be skipped after a rewind
        while not self._over and not self._reach(AHEAD):
            self._read()
            self._known += 1
        self._head, self._whole = tuple(self._ready), self._over

    def rewind(self) -> None:
        """Go back to the first chunk; returns at once."""
        self._ready, self._over = deque(self._head), self._whole
        if not self._whole:
            self._stream, self._again = self._open(), self._known

    def read_on(self, now: float) -> None:
        """Read one block, unless the prefetched chunks reach `AHEAD` beyond session time `now` [s]."""
        if not self._over and (self._again or not self._reach(now + AHEAD)):
            self._read()

    def following(self) -> Classified | None:
        """Return the next chunk without removing it; read it if necessary; None after the last chunk."""
        while not self._ready and not self._over:
            self._read()
        return self._ready[0] if self._ready else None

    def take(self) -> Classified:
        """Remove and return the next chunk."""
        return self._ready.popleft()

    def _reach(self, time: float) -> bool:
        return bool(self._ready) and float(self._ready[-1].time[-1]) >= time

    def _read(self) -> None:
        try:
            chunk = next(self._stream)
        except StopIteration:
            self._over, self._again = True, 0
            return
        if self._again:
            self._again -= 1
        elif chunk is not None:
            if math.isnan(self.first_time):
                self.first_time = float(chunk.time[0])
            if self._ready and self._ready[-1].time[-1] < 0:
                self._ready.pop()
            self._ready.append(chunk)
