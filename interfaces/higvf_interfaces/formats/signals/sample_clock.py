"""Steady sample times from the stamps of a device that sends in bursts: a phase-locked loop, chunk after chunk.

Stamps of a radio link come in clumps, double and run backwards, while the converter behind it is steady. The loop

    t[k] = (1 - g) (t[k-1] + d[k] / rate) + g stamp[k]

follows the stamps' drift and not their jitter; d is 1, or more where a sample counter shows lost packets. A stamp
further away than `GAP` is a hole in the recording (or a clock that was set): the loop starts again there, and a hole
over `MAX_HOLE` is shortened to it.
"""

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_interfaces.formats.records import MAX_HOLE

GAP = 0.5  # stamps that far from the expected time are a hole [s]
_GAIN = 0.01  # of the loop, per sample
_LAG = 1024  # samples over which the rate is estimated: stamps in whole milliseconds are common


def estimate_rate(stamps: Floats) -> float:
    """Rate of bursty stamps (n,) [Hz]; NaN where they do not tell.

    Spans of bursty stamps are whole numbers of bursts, so their median is off by up to one; the mean of those near it
    is not. Spans that cross a hole are left out.
    """
    stamps = stamps[np.isfinite(stamps)]
    lag = min(_LAG, max(1, len(stamps) // 2), len(stamps) - 1)
    if lag < 1:
        return np.nan
    spans = np.sort(stamps[lag:] - stamps[:-lag])
    usual = float(spans[len(spans) // 2])
    if not 0 < usual < np.inf:
        return np.nan
    reach = min(GAP, 0.5 * usual)
    return lag / float(np.mean(spans[(spans >= usual - reach) & (spans <= usual + reach)]))


class SampleClock:
    """Turns stamps into strictly increasing times that start at 0."""

    def __init__(self, rate: float) -> None:
        """A clock of a signal of `rate` [Hz]."""
        self._period = 1.0 / rate
        self._origin = np.nan  # what is subtracted from the stamps; moves with every repair
        self._last = 0.0
        self._holes: list[float] = []
        self._set_back = 0

    def times(self, stamps: Floats, steps: Floats) -> Floats:
        """Times (n,) [s] of the next samples, of which there are at most some thousands.

        Args:
            stamps: (n,) the device's [s]; NaN where it gave none.
            steps: (n,) sampling periods since the sample before, at least 1.
        """
        times = np.empty(len(stamps))
        start = 0
        while start < len(stamps):
            start = self._run(stamps, steps, times, start)
        return times

    def _run(self, stamps: Floats, steps: Floats, times: Floats, start: int) -> int:
        """Fills `times` up to the next hole; where that is."""
        if np.isnan(self._origin):
            self._origin = stamps[start] if np.isfinite(stamps[start]) else 0.0
            self._last = -steps[start] * self._period
        expected = self._last + np.cumsum(steps[start:]) * self._period
        raw = stamps[start:] - self._origin
        raw = np.where(np.isfinite(raw), raw, expected)
        # The recursion in closed form; a chunk is short enough for the powers of 1 - g.
        decay = (1 - _GAIN) ** np.arange(1, len(raw) + 1)
        pull = _GAIN * raw + (1 - _GAIN) * steps[start:] * self._period
        smooth = decay * (self._last + np.cumsum(pull / decay))
        far = np.flatnonzero(np.abs(raw - smooth) > GAP)
        stop = int(far[0]) if len(far) else len(raw)
        if stop == 0:
            self._jump(float(raw[0]), float(expected[0]))
            times[start] = self._last
            return start + 1
        times[start : start + stop] = smooth[:stop]
        self._last = float(smooth[stop - 1])
        return start + stop

    def _jump(self, raw: float, expected: float) -> None:
        if raw > expected:
            self._holes.append(raw - expected)
            self._last += min(raw - self._last, MAX_HOLE)
        else:
            self._set_back += 1  # joined on: time in a recording never runs backwards
            self._last = expected
        self._origin += raw - self._last

    def notes(self) -> list[str]:
        """What was repaired, in words."""
        said: list[str] = []
        if self._holes:
            cut = f", cut to {MAX_HOLE:.0f} s" if max(self._holes) > MAX_HOLE else ""
            said.append(f"{len(self._holes)} holes, the longest {max(self._holes):.1f} s{cut}")
        if self._set_back:
            said.append(f"the clock was set back {self._set_back} times: joined on")
        return said
