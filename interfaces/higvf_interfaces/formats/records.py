"""What every reader yields: one record for gaze and one for decoded commands, on one clock that starts near 0."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from higvf_console.arrays import Bools, Floats, floats
from higvf_console.errors import InputError

FRAMES = ("arena", "screen", "unit")
MAX_HOLE = 10.0  # a longer hole between gaze samples is shortened to this [s]
_EPOCH_FROM = 3600.0  # a log that starts later counts from some epoch, not from the start of a run [s]
_SAME_TIME = 1e-5  # samples nearer in time are one, given twice [s]
_CLOCK_RESTART = 1.0  # a step back by more is a restarted clock, by less a row out of order [s]


class GazeRecording(NamedTuple):
    """Gaze samples of one operator.

    Attributes:
        time: (n,) strictly increasing [s].
        points: (n, 2) in `frame`; NaN where missing.
        valid: (n,) whether the tracker vouches for the sample; implies finite points.
        confidence: (n,) in [0, 1]; None where the format has none.
        frame: one of `FRAMES`: arena [m], screen [px, origin top left, y down], unit (0..1 of the screen, likewise);
            None where the file does not say.
        screen: width and height of the recording's screen [px]; None where the file does not say.
        epoch: the device's own time at `time` = 0 [s].
        format: name of the format.
        notes: what was repaired or assumed, in words.
    """

    time: Floats
    points: Floats
    valid: Bools
    confidence: Floats | None
    frame: str | None
    screen: tuple[float, float] | None
    epoch: float
    format: str
    notes: tuple[str, ...]


class Decision(NamedTuple):
    """One decoded label; `confidence` in [0, 1], or None where the log has none."""

    time: float
    label: str
    confidence: float | None


class CommandLog(NamedTuple):
    """Decisions of one channel in order of time, as `GazeRecording` describes `epoch`, `format` and `notes`."""

    decisions: tuple[Decision, ...]
    epoch: float
    format: str
    notes: tuple[str, ...]


class Clock(NamedTuple):
    """Repaired times.

    Attributes:
        time: (m,) strictly increasing, near 0 [s].
        kept: (m,) row of each time.
        epoch: device time of `time` = 0 [s].
        notes: what was repaired.
    """

    time: Floats
    kept: np.ndarray[tuple[int], np.dtype[np.intp]]
    epoch: float
    notes: tuple[str, ...]


def gaze_clock(path: Path, seconds: Sequence[float], from_first: bool) -> Clock:
    """Makes device times [s] one increasing clock.

    Rows without a time or out of order go; a clock that restarts is joined on; a hole over `MAX_HOLE` is shortened.

    Args:
        path: of the file, for messages.
        seconds: device times; NaN where missing.
        from_first: whether 0 is the first sample; else times below an hour are kept as they are.

    Raises:
        InputError: no row has a time.
    """
    raw = floats(seconds)
    timed = np.flatnonzero(np.isfinite(raw))
    if not len(timed):
        raise InputError(f"{path}: no row has a time")
    raw = raw[timed]
    notes = [f"{len(seconds) - len(timed)} rows without a time left out"] if len(timed) < len(seconds) else []
    start = raw[0] if from_first or raw[0] >= _EPOCH_FROM or raw[0] < 0 else 0.0
    with np.errstate(over="ignore"):  # a wild time makes an infinite step, which is then repaired
        steps = np.diff(raw)
    restarts = np.flatnonzero(steps < -_CLOCK_RESTART)
    if len(restarts):
        steps[restarts] = np.median(steps[steps > 0]) if np.any(steps > 0) else 1e-3
        notes.append(f"the clock restarts {len(restarts)} times: joined on")
    holes = np.flatnonzero(steps > MAX_HOLE)
    if len(holes):
        notes.append(f"{len(holes)} holes, the longest {steps[holes].max():.0f} s, shortened to {MAX_HOLE:.0f} s")
        steps[holes] = MAX_HOLE
    time = (raw[0] - start) + np.concatenate([[0.0], np.cumsum(steps)])
    advancing = np.concatenate([[True], time[1:] - np.maximum.accumulate(time)[:-1] > _SAME_TIME])
    if not advancing.all():
        notes.append(f"{np.count_nonzero(~advancing)} rows out of order or doubled left out")
    return Clock(time[advancing], timed[advancing], float(start), tuple(notes))


def log_start(first: float) -> float:
    """Device time that becomes 0 in a command log whose first decision is at `first` [s]."""
    return first if first >= _EPOCH_FROM or first < 0 else 0.0
