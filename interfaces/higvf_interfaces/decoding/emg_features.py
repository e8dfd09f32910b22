"""Time-domain features of a window of EMG after Hudgins (1993): amplitude, waveform length and counts of its turns."""

import numpy as np

from higvf_console.core.arrays import Floats, floats

PER_CHANNEL = 5
_DEADBAND = 0.1  # of a channel's standard deviation: what the counts take for noise
_TINY = 1e-12


def features(window: Floats, deadband: Floats) -> Floats:
    """Log MAV, log RMS, log WL, ZC and SSC of each channel, shape (5 c,).

        MAV = mean |x|    RMS = sqrt(mean x^2)    WL = mean |x[k+1] - x[k]|
        ZC: share of steps that cross zero    SSC: share of samples at which the slope changes its sign

    Amplitudes are taken in logarithms, in which they are nearly normal, as linear discriminant analysis assumes.

    Args:
        window: (n, c) band-passed samples, n >= 3.
        deadband: (c,) smaller steps count neither as crossing nor as turn.
    """
    steps = np.diff(window, axis=0)
    crossing = (window[:-1] * window[1:] < 0) & (np.abs(steps) > deadband)
    turning = (steps[:-1] * steps[1:] < 0) & (np.maximum(np.abs(steps[:-1]), np.abs(steps[1:])) > deadband)
    amplitudes = [np.mean(np.abs(window), axis=0), np.sqrt(np.mean(window**2, axis=0)), np.mean(np.abs(steps), axis=0)]
    counts = [np.mean(crossing, axis=0), np.mean(turning, axis=0)]
    return floats(np.concatenate([*(np.log(amplitude + _TINY) for amplitude in amplitudes), *counts]))


def deadband_of(samples: Floats) -> Floats:
    """Deadband (c,) of calibration samples (n, c)."""
    return floats(_DEADBAND * samples.std(axis=0))
