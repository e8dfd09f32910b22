"""Plausibility of device times: the one gate of every format, recorded or live.

    range    a time that is not finite, or later than `LATEST`, is missing; so is a lone stamp far from its neighbours
    order    a small step back is a row out of order, a larger one a clock that was restarted: joined
    gaps     a longer gap than the reader allows is shortened; a longer one than any recording has is a clock that was
             set: joined

Every repair is counted by `Repairs`, which has the wording of the notes; `common_clock` compares clocks with each
other.
"""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, Ints, bools, floats, ints
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import EPOCH_FROM, MAX_GAP, log_start

LATEST = 1e11  # no device time is later, in seconds since any epoch [s]
RESTART = 1.0  # a larger step back between samples is a clock restart, a smaller one a row out of order [s]
LONGEST_STEP = 86_400.0  # no recording pauses longer: the clock was set [s]
_SAME_TIME = 1e-5  # samples closer in time are duplicates [s]
_USUAL_STEP = 1e-3  # assumed time between samples until it is known [s]
_USUAL_PAUSE = 1.0  # likewise between events [s]
_SINCE_1970 = 1e8  # larger times count from an epoch [s]
_FAR_APART = 100.0  # usual time between commands, if it were in milliseconds [s]
_DAYS = (36526.0, 73051.0)  # of a spreadsheet, in which dates of this century are days since 1899
_COARSEST = (("s", 0.5), ("ms", 500.0), ("μs", 5e5))  # upper bound of the time step between gaze samples in each unit


def is_time(seconds: float) -> bool:
    """Return whether a number can be a device time [s]; False for NaN."""
    return abs(seconds) <= LATEST


class ClockNote(str):
    """A note that a clock is not what it seems, of which a run warns when it opens the input."""

    __slots__ = ()


def clock_warnings(notes: Iterable[str]) -> tuple[str, ...]:
    """Return the notes of which a run warns."""
    return tuple(note for note in notes if isinstance(note, ClockNote))


class Repairs:
    """Counts the repairs of one clock.

    Attributes:
        untimed: rows without a time.
        late: rows out of order, or at the time of another row.
    """

    def __init__(self, longest_gap: float = MAX_GAP, restart: float = RESTART) -> None:
        """Start without repairs.

        Args:
            longest_gap: longer gaps are shortened to this [s].
            restart: a larger step back is a clock restart [s].
        """
        self.untimed = self.late = 0
        self._limit, self._restart = min(longest_gap, LONGEST_STEP), restart
        self._odd = self._restarts = self._gaps = self._set = 0
        self._longest = self._farthest = self._waits = 0.0

    def plausible(self, seconds: Floats, before: float = math.nan) -> Floats:
        """Return device times (n,) [s] with NaN in place of those out of range and of lone ones.

        A lone stamp deviates from both neighbours, which follow each other closely.

        Args:
            seconds: device times (n,) [s]; NaN if missing.
            before: the last device time before these [s]; NaN if none.
        """
        with np.errstate(invalid="ignore"):
            odd = ~np.isnan(seconds) & ~(np.abs(seconds) <= LATEST)
        times = floats(np.where(odd, np.nan, seconds))
        self._odd += int(np.count_nonzero(odd))
        timed = np.flatnonzero(np.isfinite(times))
        if len(timed) > 1:
            stamps = np.concatenate([[before], times[timed]]) if math.isfinite(before) else times[timed]
            there, back = np.diff(stamps)[:-1], np.diff(stamps)[1:]
            far = (np.abs(there) > self._restart) & (np.abs(back) > self._restart) & (there * back < 0)
            lone = far & (there + back >= 0) & (there + back <= self._restart)
            times[timed[len(timed) - len(stamps) + 1 + np.flatnonzero(lone)]] = np.nan
            self._odd += int(np.count_nonzero(lone))
        return times

    def bridged(self, steps: Floats, usual: float) -> Floats:
        """Return steps of time (n,) [s] without those that no recording makes, and count these.

        Args:
            steps: from each time to the next (n,) [s].
            usual: step that joins a clock on after it was set or restarted [s].
        """
        restarts, jumps = steps < -self._restart, steps > LONGEST_STEP
        gaps = (steps > self._limit) & ~jumps
        self._restarts += int(np.count_nonzero(restarts))
        self._set += int(np.count_nonzero(jumps))
        self._gaps += int(np.count_nonzero(gaps))
        self._farthest = max(self._farthest, float(steps[jumps].max(initial=0.0)))
        self._longest = max(self._longest, float(steps[gaps].max(initial=0.0)))
        self._waits = max(self._waits, float(steps[~jumps & ~gaps].max(initial=0.0)))
        return floats(np.where(restarts | jumps, usual, np.where(gaps, self._limit, steps)))

    def restarted(self) -> None:
        """Count a clock restart that the caller joins."""
        self._restarts += 1

    def advancing(self, times: Floats, reached: float = -math.inf, least: float = 0.0) -> Bools:
        """Return which times (n,) [s] are later than all before them, and count the others as late.

        Args:
            times: repaired times.
            reached: newest time before these [s].
            least: smallest difference of two times [s].
        """
        newest = np.maximum.accumulate(np.concatenate([[reached], times]))
        kept = bools(times - newest[:-1] > least)
        self.late += int(np.count_nonzero(~kept))
        return kept

    @property
    def notes(self) -> tuple[str, ...]:
        """The repairs so far, one sentence each."""
        repairs = (
            (self.untimed, f"{counted(self.untimed, 'row')} without a time dropped"),
            (self._odd, f"{counted(self._odd, 'implausible time stamp')} ignored"),
            (self._restarts, ClockNote(f"{counted(self._restarts, 'clock restart')} joined")),
            (
                self._set,
                ClockNote(f"the clock was set {counted(self._set, 'time')}, by up to {self._farthest:.0f} s: joined"),
            ),
            (
                self._gaps,
                f"{counted(self._gaps, 'gap')} shortened to {self._limit:.0f} s, the longest {self._longest:.0f} s",
            ),
            (self._waits > EPOCH_FROM, ClockNote(f"a gap of {self._waits:.0f} s is waited for")),
            (self.late, f"{counted(self.late, 'row')} out of order or duplicate dropped"),
        )
        return tuple(text for count, text in repairs if count)


def counted(count: int, what: str) -> str:
    """Return a count with its noun, `1 gap`, `2 gaps`."""
    return f"{count} {what}{'' if count == 1 else 's'}"


class DeviceClock:
    """Repairs the times of samples, block by block: rows out of order are dropped."""

    def __init__(self, path: Path, start: float | None, longest_gap: float = MAX_GAP) -> None:
        """Start at the beginning of a recording.

        Args:
            path: path of the file, for messages.
            start: session time of the first sample [s]; None means its own time if below one hour, otherwise 0.
            longest_gap: longer gaps are shortened to this [s].
        """
        self._path, self._start = path, start
        self.repairs = Repairs(longest_gap)
        self._raw = math.nan  # newest device time [s]
        self._now = 0.0  # the same instant on the repaired clock [s]
        self._reached = -np.inf  # newest time kept [s]
        self._step = _USUAL_STEP
        self.epoch = 0.0  # device time at time 0 [s]

    def repair(self, seconds: Floats) -> tuple[Floats, Ints]:
        """Repair a block of device times.

        Args:
            seconds: device times (n,) [s]; NaN if missing.

        Returns:
            Strictly increasing times (m,) [s] that start near 0, and the row of each (m,).
        """
        self.repairs.untimed += int(np.count_nonzero(np.isnan(seconds)))
        seconds = self.repairs.plausible(seconds, self._raw)
        timed = np.flatnonzero(np.isfinite(seconds))
        if not len(timed):
            return floats([]), ints([])
        raw = seconds[timed]
        if math.isnan(self._raw):
            first = float(raw[0])
            self.epoch = log_start(first) if self._start is None else first - self._start
            self._raw, self._now = first, first - self.epoch
        steps = np.diff(raw, prepend=self._raw)
        self._step = _usual(steps, MAX_GAP, self._step)
        time = self._now + np.cumsum(self.repairs.bridged(floats(steps), self._step))
        set_at = np.flatnonzero(steps > LONGEST_STEP)
        if len(set_at):  # what counted from an epoch does so from here on
            self.epoch = float(raw[set_at[-1]] - time[set_at[-1]])
        advancing = self.repairs.advancing(floats(time), self._reached, _SAME_TIME)
        self._raw, self._now, self._reached = float(raw[-1]), float(time[-1]), max(self._reached, float(time.max()))
        return time[advancing], ints(timed[advancing])

    def check(self) -> None:
        """Check at the end of the recording that it had times.

        Raises:
            InputError: If no row had a time.
        """
        if math.isnan(self._raw):
            raise InputError(f"{self._path}: no row has a time")


def joined(seconds: Floats) -> tuple[Floats, Repairs]:
    """Repair the times of a whole sampled stream that must stay in step with others.

    Args:
        seconds: device times (n,) [s]; NaN if missing.

    Returns:
        Times (n,) [s] that start at the first device time, NaN if missing; and the repairs. Only the steps that no
        recording has are repaired; rows out of order stay.
    """
    repairs = Repairs(LONGEST_STEP)
    times = repairs.plausible(seconds)
    timed = np.flatnonzero(np.isfinite(times))
    if len(timed):
        steps = floats(np.diff(times[timed]))
        times[timed[1:]] = times[timed[0]] + np.cumsum(repairs.bridged(steps, _usual(steps, MAX_GAP, 0.0)))
    return times, repairs


class EventTimes(NamedTuple):
    """Times of events.

    Attributes:
        order: (m,) row of each event, in order of time.
        times: (m,) non-decreasing [s].
        epoch: device time at time 0 [s].
        notes: repairs and assumptions.
    """

    order: Ints
    times: Floats
    epoch: float
    notes: tuple[str, ...]


def event_times(seconds: Floats, *, from_epoch: bool) -> EventTimes:
    """Repair the times of events, which are kept and sorted; events without a time are left out.

    Args:
        seconds: device times (n,) [s]; NaN if missing.
        from_epoch: whether a log that starts later than one hour counts from an epoch; otherwise time 0 is known.
    """
    repairs = Repairs(LONGEST_STEP, LONGEST_STEP)
    with np.errstate(invalid="ignore"):
        given = np.flatnonzero(np.abs(seconds) <= LATEST)
    times = repairs.plausible(floats(seconds[given]))
    for place in np.flatnonzero(np.isnan(times)):
        times[place] = times[place - 1]  # a lone stamp has neighbours
    if not len(times):
        return EventTimes(ints([]), floats([]), 0.0, ())
    steps = np.diff(times)
    usual = _usual(steps, LONGEST_STEP, _USUAL_PAUSE)
    raw, times = times, floats(times[0] + np.concatenate([[0.0], np.cumsum(repairs.bridged(floats(steps), usual))]))
    order = np.argsort(times, kind="stable")
    start = log_start(float(times[order[0]])) if from_epoch else 0.0
    set_at = np.flatnonzero(np.abs(steps) > LONGEST_STEP)
    shift = float(raw[set_at[-1] + 1] - times[set_at[-1] + 1]) if len(set_at) else 0.0
    notes = [*repairs.notes, *_disorder(floats(np.diff(times)))]
    if start:
        notes.append(f"times count from an epoch: shifted by {-start:.3f} s")
    return EventTimes(ints(given[order]), floats(times[order] - start), start + shift, tuple(notes))


def like_milliseconds(stamps: Floats) -> bool:
    """Return whether stamps (n,) without unit could be milliseconds: whole numbers, most of them far apart."""
    whole = bool(((stamps == np.round(stamps)) & (stamps < _SINCE_1970)).all())
    return whole and len(stamps) > 1 and float(np.median(np.diff(stamps))) >= _FAR_APART


def like_days(stamps: Floats) -> bool:
    """Return whether stamps (n,) without unit could be dates of a spreadsheet: days with a fraction, within a day."""
    within = bool(((stamps > _DAYS[0]) & (stamps < _DAYS[1])).all())
    return len(stamps) > 1 and within and 0.0 < float(np.ptp(stamps)) < 1.0


def _disorder(steps: Floats) -> list[str]:
    """Return a note if a step (n,) [s] goes back: a warning, if it could be a clock that restarted."""
    back = -float(steps.min(initial=0.0))
    if back > RESTART:
        return [ClockNote(f"entries out of order by up to {back:.0f} s: sorted by time")]
    return ["entries out of order: sorted by time"] if back > 0 else []


def _usual(steps: Floats, longest: float, default: float) -> float:
    """Return the median of the steps (n,) that are positive and at most `longest` [s], or `default` without one."""
    forward = steps[(steps > 0) & (steps <= longest)]
    return float(np.median(forward)) if len(forward) else default


def unit_by_steps(times: Floats) -> str:
    """Infer the unit of device times (n,) from their median step, assuming an eye tracker: s, ms, μs or ns."""
    steps = np.diff(times[np.isfinite(times)])
    steps = steps[steps > 0]
    typical = float(np.median(steps)) if len(steps) else 1.0
    return next((unit for unit, coarsest in _COARSEST if typical <= coarsest), "ns")
