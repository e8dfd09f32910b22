"""Filter-bank canonical correlation analysis of steady-state visual evoked potentials (Chen et al. 2015).

A flicker at frequency f evokes oscillations at f and its harmonics. In each sub-band m, rho_m(f) is the largest
canonical correlation between the channels and the sines and cosines of the harmonics of f. The combined score is

    R(f)^2 = sum_m w_m rho_m(f)^2 / sum_m w_m,    w_m = m^-1.25 + 0.25
"""

import numpy as np

from higvf_console.core.arrays import Floats, floats

_HUM = 1.0  # harmonics closer than this to a mains harmonic are not used [Hz]


def usable_harmonics(frequencies: list[float], rate: float, mains: float, most: int) -> list[list[int]]:
    """Return for each frequency its harmonics below 0.45 `rate` and off the mains, the same number for each.

    A target with more references correlates better with any signal, so all targets use the smallest number available.

    Args:
        frequencies: frequencies of the targets [Hz].
        rate: sampling rate [Hz].
        mains: mains frequency [Hz]; 0 for none.
        most: highest harmonic considered.
    """

    def clean(frequency: float) -> bool:
        return not mains or abs(frequency - mains * round(frequency / mains)) > _HUM or frequency < mains / 2

    usable = [[k for k in range(1, most + 1) if k * f < 0.45 * rate and clean(k * f)] for f in frequencies]
    fewest = min(map(len, usable))
    return [harmonics[:fewest] for harmonics in usable]


def reference(frequency: float, harmonics: list[int], samples: int, rate: float) -> Floats:
    """Return an orthonormal basis (n, 2 h) of the mean-free sines and cosines of the harmonics."""
    phase = 2 * np.pi * frequency / rate * np.outer(np.arange(samples), harmonics)
    return basis(np.hstack([np.sin(phase), np.cos(phase)]))


def basis(samples: Floats) -> Floats:
    """Return an orthonormal basis of the mean-free columns (n, c)."""
    return floats(np.linalg.qr(samples - samples.mean(axis=0))[0])


def canonical_correlation(channels: Floats, references: Floats) -> float:
    """Return the largest canonical correlation of two orthonormal bases (n, a) and (n, b), in [0, 1]."""
    return float(min(1.0, np.linalg.svd(channels.T @ references, compute_uv=False)[0]))


def band_weights(count: int) -> Floats:
    """Return the weights (m,) of the sub-bands, with sum 1."""
    raw = np.arange(1, count + 1) ** -1.25 + 0.25
    return floats(raw / raw.sum())
