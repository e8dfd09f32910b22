"""Replay of raw signals through a decoder on the session clock: `decoder=lda` or `decoder=ssvep`."""

import math
from collections.abc import Sequence
from copy import deepcopy
from itertools import islice, takewhile
from typing import NamedTuple

import numpy as np

from higvf_interfaces.decisions.feeds import Due
from higvf_interfaces.decisions.options import DECODERS, signal_request, word
from higvf_interfaces.decoding.contract import Decoder, Trial
from higvf_interfaces.decoding.emg_lda import EmgDecoder, EmgFrontEnd, EmgModel, fit
from higvf_interfaces.decoding.ssvep import HOP, WINDOW, SsvepDecoder
from higvf_interfaces.decoding.trials import shift_to, trials_of
from higvf_interfaces.fields import Fields, is_number, shown
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalChunk, SignalRecord, SignalRequest, plain_unit
from higvf_interfaces.formats.text import look
from higvf_interfaces.formats.xdf import file as xdf_file
from higvf_interfaces.paths import named
from higvf_interfaces.streams import CLOCK_GRAIN, RunClock

_MAINS = 50.0  # [Hz]


class Labelled(NamedTuple):
    """Trials on the clock of their recording, and notes on the alignment."""

    trials: list[Trial]
    notes: Sequence[str]


class DecoderFeed:
    """Feed of the decisions of a decoder on a recording."""

    def __init__(self, record: SignalRecord, decoder: Decoder, notes: Sequence[str], start: float) -> None:
        """Play `record` shifted by `start` [s]; decisions before session time 0 are dropped.

        The chunks before session time 0 may last minutes; they are decoded here, once for all replays.
        """
        self._record, self._start, self._decoder_notes = record, start, tuple(notes)
        self.labels: Sequence[str] = decoder.labels
        self._skipped = 0
        for chunk in takewhile(lambda chunk: chunk.times[-1] + start < 0, record.chunks()):
            decoder.push(self._shifted(chunk))
            self._skipped += 1
        self._settled = decoder
        self._clock = RunClock()
        self._restart()

    @property
    def notes(self) -> Sequence[str]:
        """Notes on the decoder's calibration and the repairs of the recording."""
        return (*self._decoder_notes, *self._record.notes)

    @property
    def started(self) -> bool:
        """Whether a decision has been made."""
        return self._count > 0

    @property
    def ended(self) -> bool:
        """Whether all samples have been played."""
        return self._chunk is None

    def due(self, now: float) -> list[Due]:
        """Return the decisions completed by the samples up to session time `now` [s]."""
        if self._clock.was_reset(now):
            self._restart()
        given: list[Due] = []
        while self._chunk is not None:
            times, values = self._shifted(self._chunk)
            ready = int(np.searchsorted(times, now + CLOCK_GRAIN, side="right"))
            for decision in self._decoder.push(SignalChunk(times[:ready], values[:ready])):
                if decision.time >= 0:
                    given.append(Due(self._count, decision))
                    self._count += 1
            if ready < len(times):
                self._chunk = SignalChunk(self._chunk.times[ready:], self._chunk.values[ready:])
                break
            self._chunk = next(self._chunks, None)
        return given

    def _shifted(self, chunk: SignalChunk) -> SignalChunk:
        """Return a chunk on the session clock."""
        return SignalChunk(chunk.times + self._start, chunk.values)

    def _restart(self) -> None:
        self._decoder = deepcopy(self._settled)
        self._chunks = islice(self._record.chunks(), self._skipped, None)
        self._chunk: SignalChunk | None = next(self._chunks, None)
        self._count = 0


def decoder_feed(source: str, options: Fields, start: float) -> DecoderFeed:
    """Open the feed that an input's options describe.

    Raises:
        InputError: If the recording, its calibration or an option is invalid.
    """
    beside = options.text("calibration") if options.has("calibration") else ""
    record = read_signals(source, _request_of(source, beside, options))
    return DecoderFeed(record, *make_decoder(source, record, options), start)


def make_decoder(source: str, record: SignalRecord, options: Fields) -> tuple[Decoder, Sequence[str]]:
    """Return the decoder that an input's options describe, and notes on its calibration.

    Args:
        source: file of `record`; empty for a live stream.
        record: signal to decode; only its channels and rate are used.
        options: options of the input.

    Raises:
        InputError: If the calibration or an option is invalid.
    """
    kind = options.choice("decoder", "", tuple(DECODERS))
    mains = options.number("mains", _MAINS, 0.0, 1000.0, "Hz")
    if kind == "ssvep":
        return ssvep_decoder(record, options, mains), ()
    return _lda(source, record, options, mains)


def ssvep_decoder(record: SignalRecord, options: Fields, mains: float) -> SsvepDecoder:
    """Return the SSVEP decoder of `record` that the options describe.

    Raises:
        InputError: If an option is invalid.
    """
    window, hop = options.number("window", WINDOW, 0.2, 10.0, "s"), options.number("hop", HOP, 0.02, 10.0, "s")
    return SsvepDecoder(_targets(options), record.rate, mains, window, hop)


def labelled(source: str, record: SignalRecord, options: Fields) -> Labelled:
    """Read the trials of a labelled recording; options `markers`, `marker_stream` and `trial_s`.

    Args:
        source: file of the recording.
        record: its signal, which defines the clock of the trials.
        options: options of the input.

    Raises:
        InputError: If there are no markers, they define no trials, or none lies within the recording.
    """
    length = options.number("trial_s", None, 0.1, 3600.0, "s") if options.has("trial_s") else None
    marked = options.text("markers") if options.has("markers") else source
    stream = word(options, "marker_stream") if options.has("marker_stream") else None
    log = read_decisions(marked, SignalRequest(None, stream, signal_request(options).rate, (), "marker_stream"))
    kept = _same(marked, source) and log.epoch == record.epoch
    shift = 0.0 if kept else shift_to(record, log, marked)
    notes = (f"the markers were shifted by {shift:+.3f} s to the clock of the recording",) if shift else ()
    return Labelled(trials_of([d._replace(time=d.time + shift) for d in log.decisions], length), notes)


def calibrated(
    source: str, request: SignalRequest, options: Fields, mains: float, units: Sequence[str] = ()
) -> tuple[EmgModel, Sequence[str]]:
    """Fit the EMG model to a labelled recording.

    Args:
        source: file of the recording.
        request: how to read it.
        options: options of the input.
        mains: mains frequency [Hz].
        units: units of the channels to be decoded; empty where unknown.

    Returns:
        The model, and notes on the markers.

    Raises:
        InputError: If the recording lacks a requested channel, has other units, or has too few trials.
    """
    record = read_signals(source, request)
    for name, own, other in zip(record.names, record.units, units, strict=False):
        if own and other and plain_unit(own) != plain_unit(other):
            options.fail(
                f"calibration: {name} of {source} is in {own[:20]} and the signal to decode in {other[:20]}; record "
                "both in one unit"
            )
    trials, notes = labelled(source, record, options)
    until = options.number("calibrate_to", math.inf, 0.0, math.inf, "s")
    front = EmgFrontEnd(record.rate, mains)
    windows = [window for chunk in record.chunks() for window in front.windows(chunk)]
    return fit(windows, [trial for trial in trials if trial.end <= until]), notes


def _lda(source: str, record: SignalRecord, options: Fields, mains: float) -> tuple[EmgDecoder, list[str]]:
    calibration = options.text("calibration")
    own, request = _same(calibration, source), _request_of(calibration, source, options)
    model, moved = calibrated(
        calibration, request if own else request._replace(format=None), options, mains, record.units
    )
    if len(model.deadband) != len(record.names):
        options.fail(
            f"calibration: {calibration} has {len(model.deadband)} channels and the recording {len(record.names)}; "
            "choose the same channels by channels=NAME+NAME"
        )
    overlap = " of the recording that it decodes, so its accuracy is overestimated" if own else ""
    until = f" up to {options.values['calibrate_to']} s" if options.has("calibrate_to") else ""
    notes = [f"calibrated on {len(model.labels)} labels{overlap}{until}", *moved]
    return EmgDecoder(model, record.rate, mains), notes


def _request_of(file: str, beside: str, options: Fields) -> SignalRequest:
    """Return how to read `file`; the option `stream` is dropped if only the other file, `beside`, is XDF."""
    request = signal_request(options)
    elsewhere = request.stream is not None and bool(beside) and not _is_xdf(file) and _is_xdf(beside)
    return request._replace(stream=None) if elsewhere else request


def _is_xdf(source: str) -> bool:
    return xdf_file.matches(look(source))


def _same(one: str, other: str) -> bool:
    """Return whether two names refer to the same file; False for the empty name of a live stream."""
    return bool(other) and named(one).resolve() == named(other).resolve()


def _targets(options: Fields) -> dict[str, float]:
    """Return frequency [Hz] by label: `targets=robot1@30+robot2@20`, or a mapping in a scenario."""
    if isinstance(options.values.get("targets"), dict):
        given = list(options.mapping("targets").items())
    else:
        parts = [part.rpartition("@") for part in word(options, "targets").split("+")] if options.has("targets") else []
        given = [(label.strip() or value.strip(), _float(value)) for label, _, value in parts]
    targets = {str(label): float(value) for label, value in given if is_number(value)}
    if not targets or len(targets) < len(given):
        options.fail(f"targets: {shown(options.values.get('targets'))} is not LABEL@HZ+LABEL@HZ, such as 1@30+2@20")
    return targets


def _float(text: str) -> object:
    try:
        return float(text)
    except ValueError:
        return text
