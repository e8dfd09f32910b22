"""XDF streams of samples (EEG, EMG, ...) as signals."""

from collections.abc import Iterator

from higvf_console.arrays import floats
from higvf_console.errors import InputError
from higvf_interfaces.formats import xdf_streams
from higvf_interfaces.formats.sample_clock import estimate_rate
from higvf_interfaces.formats.signal_records import SignalChunk, SignalRecord, SignalRequest, sliced, unique_names
from higvf_interfaces.formats.text import TextFile

NAME = "xdf-signals"
TITLE = "XDF stream of samples (Lab Streaming Layer)"
matches = xdf_streams.matches


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Reads the chosen stream of numbers.

    Raises:
        InputError: not an XDF file, no or several streams of samples fit, or the stream is empty.
    """
    content = xdf_streams.load(file.path)
    stream = xdf_streams.choose(content.streams, request.stream, False, file.path)
    times, values = stream.times, floats(stream.samples)
    rate = request.rate or estimate_rate(times)
    if not len(times) or not rate > 0:
        raise InputError(f"{file.path}: the stream {stream.name} has too few samples ({len(times)})")

    def chunks() -> Iterator[SignalChunk]:
        return sliced(times, values)

    notes = xdf_streams.cut_off(stream)
    return SignalRecord(unique_names(stream.names), stream.units, rate, content.epoch, NAME, notes, chunks)
