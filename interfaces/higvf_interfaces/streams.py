"""Replay on the session clock: `Playhead` finds the entries that are due, `Stamp` completes each command.

A replay neither sleeps nor reads the wall clock. Each poll returns the entries that are due by the session time, so a
log plays at 8x in a session at 8x and stops while the clock is frozen. A session time that goes back means that the run
was reset, which `RunClock` notices for all interfaces; the log then plays again from its start.
"""

import math
from dataclasses import replace

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.interface import OperatorContext

CLOCK_GRAIN = 1e-9  # tolerance for rounding: ticks times the control period may miss a decimal time [s]


class RunClock:
    """Session time as an interface is told it.

    Attributes:
        now: latest session time [s].
    """

    def __init__(self) -> None:
        """Start before the run."""
        self.now = -math.inf

    def was_reset(self, now: float) -> bool:
        """Set the session time `now` [s], and return whether it went back, because the run was reset."""
        before, self.now = self.now, now
        return now < before


class Playhead:
    """Returns each index of a log once, as soon as it is due."""

    def __init__(self, times: Floats) -> None:
        """Start before the first entry.

        Args:
            times: session times (n,), non-decreasing [s]; entries before 0 are never played.
        """
        self._times = times
        self._first = int(np.searchsorted(times, 0.0))
        self._next = self._first
        self._clock = RunClock()

    def advance(self, now: float) -> range:
        """Return the indices that became due since the last call, or since the start if the clock went back."""
        if self._clock.was_reset(now):
            self._next = self._first
        start = self._next
        self._next = int(np.searchsorted(self._times, now + CLOCK_GRAIN, side="right"))
        return range(start, max(start, self._next))

    @property
    def started(self) -> bool:
        """Whether at least one entry has been played."""
        return self._next > self._first

    @property
    def ended(self) -> bool:
        """Whether all entries have been played."""
        return self._next >= len(self._times)


class Stamp:
    """Sets time, source, operator and sequence number of an interface's commands."""

    def __init__(self, source: str) -> None:
        """Start the sequence of interface `source` at 0."""
        self._source = source
        self._sequence = 0

    def __call__(self, command: OperatorCommand, time: float, context: OperatorContext) -> OperatorCommand:
        """Return `command` stamped with session `time` [s] and the next sequence number."""
        sequence = self._sequence
        self._sequence += 1
        return replace(command, time=time, source=self._source, operator=context.operator, sequence=sequence)
