"""Causal streaming filters: a band pass, and notches at the mains frequency and its harmonics."""
# SciPy's filters have no types.
# pyright: reportUnknownVariableType=false

from typing import Any

import numpy as np
from scipy.signal import butter, iirnotch, sosfilt, sosfilt_zi, tf2sos

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError

_TOP = 0.45  # highest frequency used, as a share of the sampling rate
_NOTCH_Q = 20.0  # at 60 Hz: +- 1.5 Hz
_MOST_NOTCHES = 4


class Conditioner:
    """Filters the samples (n, c) of a stream chunk by chunk; missing samples repeat the last one."""

    def __init__(self, rate: float, low: float, high: float, mains: float, order: int = 4) -> None:
        """Design a Butterworth band pass and notches.

        Args:
            rate: sampling rate [Hz].
            low: lower band edge [Hz].
            high: upper band edge [Hz]; limited to 0.45 `rate`.
            mains: mains frequency [Hz]; 0 for no notches.
            order: order of the band pass.

        Raises:
            InputError: If the rate is too low for the band.
        """
        top = min(high, _TOP * rate)
        if top < 1.5 * low:
            raise InputError(f"a rate of {rate:g} Hz is too low for the decoder's band, which starts at {low:g} Hz")
        band: Any = butter(order, (low, top), btype="bandpass", fs=rate, output="sos")
        hums = [mains * k for k in range(1, _MOST_NOTCHES + 1) if mains > 0 and low < mains * k < top]
        notches = [tf2sos(*iirnotch(hum, _NOTCH_Q, fs=rate)) for hum in hums]
        self._sections = np.concatenate([band, *notches])
        self._at_rest = sosfilt_zi(self._sections)  # (s, 2)
        self.restart()

    def restart(self) -> None:
        """Clear the state."""
        self._state: Floats | None = None  # (s, 2, c)
        self._last: Floats | None = None  # (c,)

    def filtered(self, values: Floats) -> Floats:
        """Return the next samples (n, c), filtered."""
        if not len(values):
            return values
        if self._state is None or self._last is None:
            # An amplifier's offset is thousands of times its signal: start in the steady state of the first sample.
            self._last = np.where(np.isfinite(values[0]), values[0], 0.0)
            self._state = self._at_rest[:, :, None] * self._last
        whole = _held(values, self._last)
        self._last = whole[-1]
        filtered, self._state = sosfilt(self._sections, whole, axis=0, zi=self._state)
        return floats(filtered)


def _held(values: Floats, last: Floats) -> Floats:
    """Replace missing samples by the last one before them."""
    missing = ~np.isfinite(values)
    if not missing.any():
        return values
    padded = np.concatenate([last[None], values])
    rows = np.where(np.isfinite(padded), np.arange(len(padded))[:, None], 0)
    return np.take_along_axis(padded, np.maximum.accumulate(rows, axis=0), axis=0)[1:]
