"""Time-domain features of EMG after Hudgins (1993): amplitudes, waveform length, zero crossings, slope sign changes."""

import numpy as np

from higvf_console.core.arrays import Floats, floats

PER_CHANNEL = 5
_DEADBAND = 0.1  # noise threshold of the counts, as a share of a channel's standard deviation
_TINY = 1e-12


def features(window: Floats, deadband: Floats) -> Floats:
    """Compute log MAV, log RMS, log WL, ZC and SSC of each channel.

        MAV = mean |x|    RMS = sqrt(mean x^2)    WL = mean |x[k+1] - x[k]|
        ZC: share of steps that cross zero    SSC: share of samples at which the slope changes sign

    The logarithms of the amplitudes are nearly normally distributed, as linear discriminant analysis assumes.

    Args:
        window: (n, c) band-passed samples, n >= 3.
        deadband: (c,) smaller steps count neither as a zero crossing nor as a slope sign change.

        Returns:
            Features (5 c,).
    """
    steps = np.diff(window, axis=0)
    crossing = (window[:-1] * window[1:] < 0) & (np.abs(steps) > deadband)
    turning = (steps[:-1] * steps[1:] < 0) & (np.maximum(np.abs(steps[:-1]), np.abs(steps[1:])) > deadband)
    amplitudes = [np.mean(np.abs(window), axis=0), np.sqrt(np.mean(window**2, axis=0)), np.mean(np.abs(steps), axis=0)]
    counts = [np.mean(crossing, axis=0), np.mean(turning, axis=0)]
    return floats(np.concatenate([*(np.log(amplitude + _TINY) for amplitude in amplitudes), *counts]))


def deadband_of(samples: Floats) -> Floats:
    """Return the deadband (c,) for calibration samples (n, c)."""
    return floats(_DEADBAND * samples.std(axis=0))
