"""What all replays share: a playhead that follows the session clock, and the stamp that every command carries.

A replay never sleeps and never looks at the wall clock: at each poll it hands out what has fallen due by the session
time, so that a log plays at 8x with a session at 8x, and stands while the clock is frozen. When the session time goes
back, the run has started again, and the log plays again from its start.
"""

from dataclasses import replace

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.interface import OperatorContext

CLOCK_GRAIN = 1e-9  # ticks times the control period may miss a decimal time by a rounding [s]


class Playhead:
    """Hands out each index of a log once, when its time has come."""

    def __init__(self, times: Floats) -> None:
        """Stands before session `times` (n,), not decreasing [s]; what lies before 0 is never played."""
        self._times = times
        self._first = int(np.searchsorted(times, 0.0))
        self._next = self._first
        self._now = -np.inf

    def advance(self, now: float) -> range:
        """Indices that have fallen due since the last call; all from the start after the clock went back."""
        if now < self._now:
            self._next = self._first
        start = self._next
        self._now = now
        self._next = int(np.searchsorted(self._times, now + CLOCK_GRAIN, side="right"))
        return range(start, max(start, self._next))

    @property
    def started(self) -> bool:
        """Whether anything has been played."""
        return self._next > self._first

    @property
    def ended(self) -> bool:
        """Whether everything has been played."""
        return self._next >= len(self._times)


class Stamp:
    """Gives an interface's commands their time, source, operator and running number."""

    def __init__(self, source: str) -> None:
        """Starts counting the commands of interface `source`."""
        self._source = source
        self._sequence = 0

    def __call__(self, command: OperatorCommand, time: float, context: OperatorContext) -> OperatorCommand:
        """`command` as given at session `time` [s]."""
        sequence = self._sequence
        self._sequence += 1
        return replace(command, time=time, source=self._source, operator=context.operator, sequence=sequence)
