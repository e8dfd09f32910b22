"""EMG decoder `lda`: gestures by time-domain features and linear discriminant analysis.

    raw -> band pass from 20 Hz, mains notches -> 0.25 s windows every 0.1 s -> features -> LDA -> posterior

Electrode positions and skin impedance change between sessions, so the model is fitted to a labelled recording of the
same session.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.decoding.conditioning import Conditioner
from higvf_interfaces.decoding.contract import SlidingWindow, Trial, Window
from higvf_interfaces.decoding.emg_features import deadband_of, features
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import SignalChunk

BAND = (20.0, 450.0)  # band of surface EMG [Hz]
WINDOW, HOP = 0.25, 0.1  # [s]
_FEWEST_WINDOWS = 5  # minimum number of windows per label


class EmgModel(NamedTuple):
    """A fitted classifier: its labels, the deadband (c,) of its features, and the discriminant."""

    labels: tuple[str, ...]
    deadband: Floats
    discriminant: Any  # sklearn's LinearDiscriminantAnalysis

    def posterior(self, window: Floats) -> Floats:
        """Return the probability of each label (k,) for a filtered window (n, c)."""
        return floats(self.discriminant.predict_proba(features(window, self.deadband)[None])[0])


class EmgFrontEnd:
    """Filters and windows of an EMG stream, for calibration and decoding."""

    def __init__(self, rate: float, mains: float) -> None:
        """Set the sampling rate [Hz] and the mains frequency [Hz].

        Raises:
            InputError: If the rate is too low for EMG.
        """
        self._filter = Conditioner(rate, *BAND, mains)
        self._window = SlidingWindow(max(3, round(WINDOW * rate)), max(1, round(HOP * rate)))

    def restart(self) -> None:
        """Forgets the samples."""
        self._filter.restart()
        self._window.restart()

    def windows(self, chunk: SignalChunk) -> list[Window]:
        """Return the filtered windows completed by the next samples."""
        return list(self._window.push(chunk._replace(values=self._filter.filtered(chunk.values))))


class EmgDecoder:
    """Decides the gesture of each window, with the posterior as confidence."""

    def __init__(self, model: EmgModel, rate: float, mains: float) -> None:
        """Decode a stream at `rate` [Hz] that has the channels of `model`; `mains` is the mains frequency [Hz]."""
        self._model = model
        self._front = EmgFrontEnd(rate, mains)
        self.labels: Sequence[str] = model.labels

    def restart(self) -> None:
        """Forgets the samples."""
        self._front.restart()

    def push(self, chunk: SignalChunk) -> list[Decision]:
        """Return one decision per window completed by the next samples."""
        return [decided(self._model, window) for window in self._front.windows(chunk)]


def decided(model: EmgModel, window: Window) -> Decision:
    """Return the most probable label of a filtered window."""
    posterior = model.posterior(window.values)
    best = int(np.argmax(posterior))
    return Decision(window.time, model.labels[best], float(posterior[best]))


def fit(windows: Sequence[Window], trials: Sequence[Trial]) -> EmgModel:
    """Fit the model to the windows that lie entirely within a trial.

    Raises:
        InputError: If scikit-learn is not installed, or there are too few windows or labels.
    """
    analysis = _linear_discriminant_analysis()
    labelled = [(window, label) for window in windows if (label := label_at(window, trials)) is not None]
    labels = tuple(sorted({label for _, label in labelled}))
    counts = {label: sum(other == label for _, other in labelled) for label in labels}
    if len(labels) < 2 or min(counts.values()) < _FEWEST_WINDOWS:
        raise InputError(
            f"calibration needs at least two labels with {_FEWEST_WINDOWS} windows of {WINDOW:g} s each; "
            f"it has {counts or 'none'}"
        )
    deadband = deadband_of(np.concatenate([window.values for window, _ in labelled]))
    discriminant = analysis(solver="lsqr", shrinkage="auto", priors=np.full(len(labels), 1 / len(labels)))
    discriminant.fit([features(window.values, deadband) for window, _ in labelled], [label for _, label in labelled])
    return EmgModel(labels, deadband, discriminant)


def label_at(window: Window, trials: Sequence[Trial]) -> str | None:
    """Return the label of the trial that contains the whole window, if any."""
    inside = (t.label for t in trials if t.start <= window.time - WINDOW and window.time <= t.end)
    return next(inside, None)


def _linear_discriminant_analysis() -> Any:
    try:
        from sklearn.discriminant_analysis import (  # noqa: PLC0415 - an extra, and slow to import
            LinearDiscriminantAnalysis,
        )
    except ImportError as problem:
        raise InputError("decoder=lda needs scikit-learn: pip install 'higvf-console[signals]'") from problem
    return LinearDiscriminantAnalysis
