"""Sample clock: a phase-locked loop that turns bursty time stamps into steady sample times, chunk by chunk.

Time stamps of a radio link come in bursts, repeat and run backwards, although the converter samples steadily. The loop

    t[k] = (1 - g) (t[k-1] + d[k] / rate) + g stamp[k]

follows the drift of the stamps but not their jitter; d is 1, or more if a sample counter shows lost packets. A stamp
that deviates by more than `GAP` marks a gap in the recording or a clock that was set: the loop restarts there, and a
gap is repaired as every other clock's (`formats.clock`).
"""

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_interfaces.formats.clock import Repairs, joined

GAP = 0.5  # a larger deviation of a stamp from its expected time is a gap [s]
_GAIN = 0.01  # gain of the loop per sample
_LAG = 1024  # samples over which the rate is estimated, because stamps are often in whole milliseconds


def estimate_rate(stamps: Floats) -> float:
    """Estimate the sampling rate [Hz] from bursty time stamps (n,) [s]; NaN if undetermined.

    A span of `_LAG` stamps covers a whole number of bursts, so the median span is off by up to one burst; the mean of
    the spans near the median is not. Spans across a gap are excluded; a clock that was set is joined first.
    """
    stamps, _ = joined(stamps)
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
    """Turns time stamps into strictly increasing times that start at 0."""

    def __init__(self, rate: float) -> None:
        """Start a clock for a signal of `rate` [Hz]."""
        self._period = 1.0 / rate
        self._origin = np.nan  # offset subtracted from the stamps; changes with every repair
        self._last = 0.0
        self.repairs = Repairs()

    def times(self, stamps: Floats, steps: Floats) -> Floats:
        """Return the times (n,) [s] of the next samples, at most some thousands.

        Args:
            stamps: (n,) device times [s]; NaN where missing.
            steps: (n,) sampling periods since the previous sample, at least 1.
        """
        stamps = self.repairs.plausible(stamps)
        times = np.empty(len(stamps))
        start = 0
        while start < len(stamps):
            start = self._run(stamps, steps, times, start)
        return times

    def _run(self, stamps: Floats, steps: Floats, times: Floats, start: int) -> int:
        """Fill `times` up to the next gap and return the index of the first sample after it."""
        if np.isnan(self._origin):
            self._origin = stamps[start] if np.isfinite(stamps[start]) else 0.0
            self._last = -steps[start] * self._period
        expected = self._last + np.cumsum(steps[start:]) * self._period
        raw = stamps[start:] - self._origin
        raw = np.where(np.isfinite(raw), raw, expected)
        # The recursion in closed form; a chunk is short enough that the powers of 1 - g do not underflow.
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
            self._last += float(self.repairs.bridged(floats([raw - self._last]), expected - self._last)[0])
        else:
            self.repairs.restarted()
            self._last = expected
        self._origin += raw - self._last
