"""Repair of device times: converts them to strictly increasing times, block by block, and counts the repairs."""

import math
from pathlib import Path

import numpy as np

from higvf_console.core.arrays import Floats, Ints, floats, ints
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import MAX_GAP, log_start

_SAME_TIME = 1e-5  # samples closer in time are duplicates [s]
_RESTART = 1.0  # a larger step back is a clock restart, a smaller one a row out of order [s]
_USUAL_STEP = 1e-3  # assumed time between samples until it is known [s]
_COARSEST = (("s", 0.5), ("ms", 500.0), ("μs", 5e5))  # upper bound of the time step between gaze samples in each unit


class GazeClock:
    """Repairs device times: drops rows without time or out of order, joins clock restarts, shortens long gaps."""

    def __init__(self, path: Path, start: float | None, longest_gap: float = MAX_GAP) -> None:
        """Start at the beginning of a recording.

        Args:
            path: path of the file, for messages.
            start: session time of the first sample [s]; None means its own time if below one hour, otherwise 0.
            longest_gap: longer gaps are shortened to this [s].
        """
        self._path = path
        self._start, self._limit = start, longest_gap
        self._raw = math.nan  # newest device time [s]
        self._now = 0.0  # the same instant on the repaired clock [s]
        self._reached = -np.inf  # newest time kept [s]
        self._step = _USUAL_STEP
        self._untimed = self._restarts = self._gaps = self._late = 0
        self._longest = 0.0
        self.epoch = 0.0  # device time at time 0 [s]

    def repair(self, seconds: Floats) -> tuple[Floats, Ints]:
        """Repair a block of device times.

        Args:
            seconds: device times (n,) [s]; NaN if missing.

        Returns:
            Strictly increasing times (m,) [s] that start near 0, and the row of each (m,).
        """
        timed = np.flatnonzero(np.isfinite(seconds))
        self._untimed += len(seconds) - len(timed)
        if not len(timed):
            return floats([]), ints([])
        raw = seconds[timed]
        if math.isnan(self._raw):
            first = float(raw[0])
            self.epoch = log_start(first) if self._start is None else first - self._start
            self._raw, self._now = first, first - self.epoch
        time = self._now + np.cumsum(self._steps(raw))
        reached = np.maximum.accumulate(np.concatenate([[self._reached], time]))
        advancing = time - reached[:-1] > _SAME_TIME
        self._late += int(np.count_nonzero(~advancing))
        self._raw, self._now, self._reached = float(raw[-1]), float(time[-1]), float(reached[-1])
        return time[advancing], ints(timed[advancing])

    def check(self) -> None:
        """Check at the end of the recording that it had times.

        Raises:
            InputError: If no row had a time.
        """
        if math.isnan(self._raw):
            raise InputError(f"{self._path}: no row has a time")

    @property
    def notes(self) -> tuple[str, ...]:
        """Repairs so far."""
        repairs = (
            (self._untimed, f"{self._untimed} rows without a time dropped"),
            (self._restarts, f"{self._restarts} clock restarts joined"),
            (self._gaps, f"{self._gaps} gaps shortened to {self._limit:.0f} s, the longest {self._longest:.0f} s"),
            (self._late, f"{self._late} rows out of order or duplicate dropped"),
        )
        return tuple(text for count, text in repairs if count)

    def _steps(self, raw: Floats) -> Floats:
        with np.errstate(over="ignore"):  # an extreme time gives an infinite step, which is repaired below
            steps = np.diff(raw, prepend=self._raw)
        forward = steps[(steps > 0) & (steps <= MAX_GAP)]
        self._step = float(np.median(forward)) if len(forward) else self._step
        restarts = steps < -_RESTART
        steps[restarts] = self._step
        gaps = steps > self._limit
        if gaps.any():
            self._longest = max(self._longest, float(steps[gaps].max()))
            steps[gaps] = self._limit
        self._restarts += int(np.count_nonzero(restarts))
        self._gaps += int(np.count_nonzero(gaps))
        return floats(steps)


def unit_by_steps(times: Floats) -> str:
    """Infer the unit of device times (n,) from their median step, assuming an eye tracker: s, ms, μs or ns."""
    steps = np.diff(times[np.isfinite(times)])
    steps = steps[steps > 0]
    typical = float(np.median(steps)) if len(steps) else 1.0
    return next((unit for unit, coarsest in _COARSEST if typical <= coarsest), "ns")
