"""Signal streams (EEG, EMG, ...) of XDF files."""

from collections.abc import Iterator

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import Repairs
from higvf_interfaces.formats.signals.records import (
    SignalChunk,
    SignalRecord,
    SignalRequest,
    plain_unit,
    sliced,
    unique_names,
    unused_rate,
)
from higvf_interfaces.formats.signals.sample_clock import estimate_rate
from higvf_interfaces.formats.text import TextFile
from higvf_interfaces.formats.xdf import file as xdf_file
from higvf_interfaces.formats.xdf.samples import cut_off, load

NAME = "xdf-signals"
TITLE = "XDF stream of samples (Lab Streaming Layer)"
matches = xdf_file.matches


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the selected signal stream.

    Raises:
        InputError: If the file is not XDF, no signal stream or several match, or the stream is too short.
    """
    found = xdf_file.survey(file.path)
    signals = [stream for stream in found.streams if not stream.marks]
    stream = xdf_file.choose(file.path, found.streams, request.stream, signals, "signal streams", request.stream_option)
    samples = load(file.path, stream, found)
    times, values = samples.time - samples.earliest, floats(samples.values)
    rate, order = estimate_rate(times), Repairs()
    order.advancing(floats(times[np.isfinite(times)]))
    if not len(times) or not rate > 0:
        raise InputError(f"{file.path}: the {len(times)} samples of stream {stream.info.name} have no increasing times")

    def chunks() -> Iterator[SignalChunk]:
        return sliced(times, values)

    names, units = (xdf_file.channel_texts(stream.header, key, stream.info.channels) for key in ("label", "unit"))
    notes = [*cut_off(stream, len(times)), *samples.notes, *order.notes, *unused_rate(request.rate, rate)]
    return SignalRecord(unique_names(names), tuple(map(plain_unit, units)), rate, samples.earliest, NAME, notes, chunks)
