"""Pieces of a recording, read before they are due, so that a poll reads a block whatever the recording holds.

A chunk may be a stare of `chunks.LONGEST` samples, and a file that is played again is read again from its start. Read
when they fall due, both would hold up the team:

    head, kept for every play | ready, read a block a poll | the rest of the file
    0 s                     AHEAD       now            now + AHEAD

After a rewind the head is played, while reading catches up with it.
"""

import math
from collections import deque
from collections.abc import Callable, Iterator

from higvf_interfaces.gaze.fixations import Classified

AHEAD = 6.0  # a block a poll, 50 polls a second: the longest chunk is read in 5.2 s [s]


class Prefetcher:
    """The chunks that are to be played; what lies before session time 0 never is.

    Attributes:
        first_time: of the recording's first sample [s]; NaN where it has none.
    """

    def __init__(self, chunks: Callable[[], Iterator[Classified | None]]) -> None:
        """Reads the head.

        Args:
            chunks: begins to read the recording, and gives an item a block: a chunk, or None where it settles none;
                called again at a rewind, if the recording is longer than the head.

        Raises:
            InputError: the recording cannot be read.
        """
        self._open = chunks
        self._stream = chunks()
        self._ready: deque[Classified] = deque()
        self._over = False
        self.first_time = math.nan
        self._known = self._again = 0  # items of the head; those of them that are still to be read again
        while not self._over and not self._reach(AHEAD):
            self._read()
            self._known += 1
        self._head, self._whole = tuple(self._ready), self._over

    def rewind(self) -> None:
        """Stands before the first chunk again; returns at once."""
        self._ready, self._over = deque(self._head), self._whole
        if not self._whole:
            self._stream, self._again = self._open(), self._known

    def read_on(self, now: float) -> None:
        """Reads a block, unless what is ready reaches far enough beyond session time `now` [s]."""
        if not self._over and (self._again or not self._reach(now + AHEAD)):
            self._read()

    def following(self) -> Classified | None:
        """The next chunk, which is waited for where it is not ready; None behind the last."""
        while not self._ready and not self._over:
            self._read()
        return self._ready[0] if self._ready else None

    def take(self) -> Classified:
        """Takes the chunk that `following` shows."""
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
