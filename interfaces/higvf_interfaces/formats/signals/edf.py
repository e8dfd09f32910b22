"""European Data Format (EDF, EDF+) and BioSemi's BDF: channels as signals, annotations as decisions.

Only the channels of the most common sampling rate are read. Units come from the header, even if a BIDS channel table
contradicts it. EDF is read in slices, BDF as a whole.
"""

import struct
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_console.core.optional import optional
from higvf_interfaces.formats.clock import event_times, is_time
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals import bids_channels
from higvf_interfaces.formats.signals.records import (
    CHUNK,
    SignalChunk,
    SignalRecord,
    SignalRequest,
    unique_names,
    unused_rate,
)
from higvf_interfaces.formats.text import TextFile

if TYPE_CHECKING:
    import edfio
else:
    edfio = optional("edfio", "devices")

NAME = "edf"
TITLE = "EDF or BDF"
MARKED_NAME = "edf-annotations"
MARKED_TITLE = "annotations of an EDF+ or BDF+ file"
_EDF, _BDF = b"0       ", b"\xffBIOSEMI"
_BROKEN = (ValueError, KeyError, IndexError, TypeError, AttributeError, OSError, EOFError, StopIteration, MemoryError,
           ArithmeticError, UnicodeError, AssertionError, struct.error)  # fmt: skip


class _Content(NamedTuple):
    data: Any  # edfio.Edf or Bdf
    notes: list[str]


def matches(file: TextFile) -> bool:
    """Return whether the file begins with the version field of EDF or BDF."""
    return _version(file.path) in (_EDF, _BDF)


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the channels of the most common rate.

    Raises:
        InputError: If the file is not EDF or BDF, or has no samples.
    """
    data, notes = _load(file.path)
    try:
        rates = Counter(float(signal.sampling_frequency) for signal in data.signals)
        (rate, _), *others = rates.most_common()
        signals = [signal for signal in data.signals if float(signal.sampling_frequency) == rate]
        count = int(data.num_data_records) * min(signal.samples_per_data_record for signal in signals)
        names, units = [str(signal.label) for signal in signals], [str(signal.physical_dimension) for signal in signals]
        signals[0].get_data_slice(0.0, min(1, count) / rate)
    except _BROKEN as problem:
        raise InputError(f"{file.path}: the file has no readable signals: {str(problem)[:200]}") from problem
    if count < 1 or not rate > 0:
        raise InputError(f"{file.path}: the file has no samples")
    if others:
        notes.append(f"{sum(n for _, n in others)} channels with other rates than {rate:g} Hz dropped")
    notes += _by_bids(file.path, names, units)
    notes += unused_rate(request.rate, rate)

    def chunks() -> Iterator[SignalChunk]:
        for start in range(0, count, CHUNK):
            stop = min(start + CHUNK, count)
            values = np.column_stack([signal.get_data_slice(start / rate, stop / rate) for signal in signals])
            yield SignalChunk(floats(np.arange(start, stop) / rate), floats(values))

    return SignalRecord(unique_names(names), tuple(units), rate, 0.0, NAME, notes, chunks)


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:  # noqa: ARG001 - annotations carry their times
    """Read the annotations.

    Raises:
        InputError: If the file is not EDF or BDF, or has no annotations.
    """
    data, notes = _load(file.path)
    try:
        found = [(float(a.onset), str(a.text).strip()) for a in data.annotations]
    except _BROKEN as problem:
        raise InputError(f"{file.path}: the annotations cannot be read: {str(problem)[:200]}") from problem
    labelled = [(time, label) for time, label in found if label and is_time(time)]
    if not labelled:
        raise InputError(f"{file.path}: the file has no annotations, so it holds no decisions")
    order, times, epoch, repaired = event_times(floats([time for time, _ in labelled]), from_epoch=False)
    decisions = tuple(Decision(time, labelled[row][1], None) for row, time in zip(order, times.tolist(), strict=True))
    return CommandLog(decisions, epoch, MARKED_NAME, (*notes, *repaired))


def _version(path: Path) -> bytes:
    try:
        with path.open("rb") as stream:
            return stream.read(8)
    except OSError:
        return b""


def _load(path: Path) -> _Content:
    version = _version(path)
    if version not in (_EDF, _BDF):
        raise InputError(f"{path}: is neither an EDF nor a BDF file")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            data = edfio.read_bdf(path) if version == _BDF else edfio.read_edf(path)
            continuous = data.is_continuous
        except _BROKEN as problem:
            raise InputError(f"{path}: the file cannot be read: {str(problem)[:200]}") from problem
    if not continuous:
        raise InputError(f"{path}: the recording has gaps (EDF+D), which is not supported; export it as EDF+C")
    cut = [f"the recording was cut off: {warning.message}" for warning in caught if "records" in str(warning.message)]
    return _Content(data, cut)


def _by_bids(path: Path, names: list[str], units: list[str]) -> list[str]:
    """Return notes on the BIDS channel table: bad channels, and units that contradict the header."""
    table = bids_channels.beside(path)
    known = [(name, unit, table[name]) for name, unit in zip(names, units, strict=True) if name in table]
    bad = [name for name, _, note in known if note.bad]
    other = [name for name, unit, note in known if note.unit not in ("", "n/a", unit)]
    notes = [f"marked bad in channels.tsv: {', '.join(bad)}"] if bad else []
    if other:
        notes.append(f"channels.tsv contradicts the header in the units of {len(other)} channels: the header is used")
    return notes
