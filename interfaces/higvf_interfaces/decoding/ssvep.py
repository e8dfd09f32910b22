"""SSVEP decoder `ssvep`: filter-bank CCA with sham targets to detect idleness.

Shams are frequencies near a target at which nothing flickers; they correlate with the background EEG as well as an
unattended target does. Under white noise of nu degrees of freedom the log-likelihood ratio of a frequency is
-nu/2 log(1 - R^2). The confidence is the posterior over targets and shams, where shams have the higher prior; the
posterior of all shams is the confidence of `idle`.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.decoding.conditioning import Conditioner
from higvf_interfaces.decoding.contract import SlidingWindow
from higvf_interfaces.decoding.fbcca import band_weights, basis, canonical_correlation, reference, usable_harmonics
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import SignalChunk

IDLE = "idle"
WINDOW, HOP = 1.0, 0.25  # [s]
HARMONICS = 2
IDLE_ODDS = 10.0  # prior odds of a sham against a target, because people mostly look elsewhere
_BAND_TOP = 88.0  # [Hz]
_BAND_EDGE = 2.0  # distance from the lower edge of a sub-band to the harmonic of the lowest target [Hz]
_SHAMS = (-3.0, -2.0, 2.0, 3.0)  # offsets of the shams from a target, in units of 1 / window


class SsvepDecoder:
    """Decides for each window which target is looked at, or `idle`."""

    def __init__(
        self, targets: Mapping[str, float], rate: float, mains: float, window: float = WINDOW, hop: float = HOP
    ) -> None:
        """Design filters and references.

        Args:
            targets: flicker frequency of each label [Hz].
            rate: sampling rate [Hz].
            mains: mains frequency [Hz]; 0 for none.
            window: duration of a window [s].
            hop: time between decisions [s].

        Raises:
            InputError: If there are fewer than two targets, two are too close for the window, or one has no usable
                harmonic.
        """
        self.labels: Sequence[str] = (*targets, IDLE)
        frequencies = list(targets.values())
        _check(targets, window)
        samples = round(window * rate)
        harmonics = usable_harmonics(frequencies, rate, mains, HARMONICS)
        if not harmonics[0]:
            raise InputError(f"a target of {frequencies} Hz has no harmonic below {0.45 * rate:g} Hz and off the mains")
        lowest = min(frequencies)
        starts = [max(1.0, k * lowest - _BAND_EDGE) for k in range(1, len(harmonics[0]) + 1)]
        self._bands = [Conditioner(rate, start, _BAND_TOP, mains) for start in starts]
        self._windows = [SlidingWindow(samples, max(1, round(hop * rate))) for _ in starts]
        self._weights = band_weights(len(starts))
        self._freedom = 2 * window * (min(_BAND_TOP, 0.45 * rate) - starts[0])
        taken = [k * f for f, multiples in zip(frequencies, harmonics, strict=True) for k in multiples]
        shams = [
            (f + d / window, multiples) for f, multiples in zip(frequencies, harmonics, strict=True) for d in _SHAMS
        ]
        free = [(f, multiples) for f, multiples in shams if f > 1 and all(abs(f - t) >= 1.5 / window for t in taken)]
        tried = [*zip(frequencies, harmonics, strict=True), *free]
        self._references = [reference(f, multiples, samples, rate) for f, multiples in tried]

    def restart(self) -> None:
        """Clear the state."""
        for part in (*self._bands, *self._windows):
            part.restart()

    def push(self, chunk: SignalChunk) -> list[Decision]:
        """Return one decision per window completed by the next samples."""
        bands = [
            list(window.push(chunk._replace(values=band.filtered(chunk.values))))
            for band, window in zip(self._bands, self._windows, strict=True)
        ]
        decisions: list[Decision] = []
        for parts in zip(*bands, strict=True):
            posterior = self.posterior([part.values for part in parts])
            best = int(np.argmax(posterior))
            decisions.append(Decision(parts[0].time, self.labels[best], float(posterior[best])))
        return decisions

    def posterior(self, bands: Sequence[Floats]) -> Floats:
        """Return the probability of each label (k + 1,) for a window in each sub-band, (n, c) each."""
        bases = [basis(band) for band in bands]
        shared = [
            sum(w * canonical_correlation(b, r) ** 2 for w, b in zip(self._weights, bases, strict=True))
            for r in self._references
        ]
        evidence = -0.5 * self._freedom * np.log1p(-np.clip(shared, 0.0, 1 - 1e-9))
        likelihood = np.exp(evidence - evidence.max())
        targets = len(self.labels) - 1
        joined = np.append(likelihood[:targets], IDLE_ODDS * likelihood[targets:].sum())
        return floats(joined / joined.sum())


def _check(targets: Mapping[str, float], window: float) -> None:
    if len(targets) < 2:
        raise InputError(f"targets: {dict(targets)}: SSVEP needs at least two flickers, such as targets=1@30+2@20")
    ordered = sorted(targets.values())
    nearest = float(np.min(np.diff(ordered)))
    if ordered[0] <= 3 or nearest < 1 / window:
        raise InputError(
            f"targets: {dict(targets)}: flickers must be above 3 Hz and, for a window of {window:g} s, "
            f"{1 / window:g} Hz apart"
        )
