"""The time for which this process was awake: somebody else's silence is not measured while it could not listen."""

import threading
from collections.abc import Callable
from time import monotonic

NAP = 1.0  # longest time between two looks that counts in full [s]


class AwakeClock:
    """Seconds that run on while they are read often enough.

    A process that was stopped, or had no core for long, reads it late: of such a gap, `NAP` seconds count.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        """Starts at 0.

        Args:
            clock: any that runs on [s].
        """
        self._clock, self._lock = clock, threading.Lock()
        self._read, self._time = clock(), 0.0

    def now(self) -> float:
        """Time awake so far [s]; callable from any thread."""
        with self._lock:
            read = self._clock()
            self._time += min(read - self._read, NAP)
            self._read = read
            return self._time
