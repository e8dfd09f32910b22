"""European Data Format (EDF, EDF+) and BioSemi's BDF: channels as signals, annotations and triggers as decisions.

The channels of one sampling rate are read: that of the named channels, else the rate with the most samples. A trigger
channel, such as BioSemi's Status, is no signal; a channel without a physical range is left out. Units come from the
header, even if a BIDS channel table contradicts it. EDF is read in slices, BDF as a whole.
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
from higvf_interfaces.formats.signals.edf_annotations import Annotations, read_annotations
from higvf_interfaces.formats.signals.records import (
    CHUNK,
    SignalChunk,
    SignalRecord,
    SignalRequest,
    is_trigger,
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


_CODE = 0xFFFF  # bits of BioSemi's Status that hold the trigger; those above tell the state of the device


class _Content(NamedTuple):
    data: Any  # edfio.Edf or Bdf
    annotations: Annotations
    notes: list[str]


class _Channel(NamedTuple):
    name: str
    signal: Any  # edfio.EdfSignal or BdfSignal
    rate: float  # [Hz]


def matches(file: TextFile) -> bool:
    """Return whether the file begins with the version field of EDF or BDF."""
    return _version(file.path) in (_EDF, _BDF)


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the channels of one rate.

    Raises:
        InputError: If the file is not EDF or BDF, has no samples, or the named channels have different rates or unknown
            values.
    """
    data, _, notes = _load(file.path)
    try:
        channels = _chosen(file.path, _usable(file.path, data, request, notes), request, notes)
        rate, signals = channels[0].rate, [channel.signal for channel in channels]
        count = int(data.num_data_records) * min(signal.samples_per_data_record for signal in signals)
        names, units = [channel.name for channel in channels], [str(signal.physical_dimension) for signal in signals]
        signals[0].get_data_slice(0.0, min(1, count) / rate)
    except _BROKEN as problem:
        raise InputError(f"{file.path}: the file has no readable signals: {str(problem)[:200]}") from problem
    if count < 1 or not rate > 0:
        raise InputError(f"{file.path}: the file has no samples")
    notes += _by_bids(file.path, names, units)
    notes += unused_rate(request.rate, rate)

    def chunks() -> Iterator[SignalChunk]:
        for start in range(0, count, CHUNK):
            stop = min(start + CHUNK, count)
            values = np.column_stack([signal.get_data_slice(start / rate, stop / rate) for signal in signals])
            yield SignalChunk(floats(np.arange(start, stop) / rate), floats(values))

    return SignalRecord(tuple(names), tuple(units), rate, 0.0, NAME, notes, chunks)


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:  # noqa: ARG001 - annotations carry their times
    """Read the annotations and the changes of trigger channels.

    Raises:
        InputError: If the file is not EDF or BDF, or has neither annotations nor triggers.
    """
    data, annotations, notes = _load(file.path)
    found = list(annotations.texts)
    try:
        for signal in data.signals:
            if is_trigger(str(signal.label)):
                codes = _triggers(signal, _version(file.path) == _BDF)
                found += codes
                notes.append(f"{len(codes)} triggers of the channel {signal.label}")
    except _BROKEN as problem:
        raise InputError(f"{file.path}: the triggers cannot be read: {str(problem)[:200]}") from problem
    labelled = sorted((time, label) for time, label in found if label and is_time(time))  # two lists made one
    if not labelled:
        raise InputError(f"{file.path}: the file has neither annotations nor triggers, so it holds no decisions")
    order, times, epoch, repaired = event_times(floats([time for time, _ in labelled]), from_epoch=False)
    decisions = tuple(Decision(time, labelled[row][1], None) for row, time in zip(order, times.tolist(), strict=True))
    return CommandLog(decisions, epoch, MARKED_NAME, (*notes, *repaired))


def _usable(path: Path, data: Any, request: SignalRequest, notes: list[str]) -> list[_Channel]:
    """Return the channels that hold a signal, and note the others.

    Raises:
        InputError: If a named channel has no physical range, or no channel is left.
    """
    names = unique_names([str(signal.label) for signal in data.signals])
    known = [_Channel(name, s, float(s.sampling_frequency)) for name, s in zip(names, data.signals, strict=True)]
    wanted = {name.casefold() for name in request.channels}
    flat = [channel for channel in known if not _has_range(channel.signal)]
    refused = [channel.name for channel in flat if channel.name.casefold() in wanted]
    if refused:
        raise InputError(
            f"{path}: channel {refused[0]} has no physical range (its minimum equals its maximum), so its values are "
            "unknown; leave it out of channels="
        )
    triggers = [c for c in known if is_trigger(str(c.signal.label)) and c.name.casefold() not in wanted]
    if flat:
        notes.append(f"without a physical range, left out: {', '.join(channel.name for channel in flat)}")
    if triggers:
        notes.append(f"triggers, no signal: {', '.join(channel.name for channel in triggers)}")
    left = [channel for channel in known if channel not in flat and channel not in triggers]
    if not left:
        raise InputError(f"{path}: the file has no channel with a signal; it has: {', '.join(names)}")
    return left


def _chosen(path: Path, channels: list[_Channel], request: SignalRequest, notes: list[str]) -> list[_Channel]:
    """Return the channels of the rate of the named ones, else of the rate with the most samples a second.

    Raises:
        InputError: If a named channel is missing, or the named channels have different rates.
    """
    counts = Counter(channel.rate for channel in channels)
    rate = max(counts, key=lambda rate: rate * counts[rate])
    wanted = [name.casefold() for name in request.channels]
    if wanted:
        named = [channel for channel in channels if channel.name.casefold() in wanted]
        missing = set(wanted) - {channel.name.casefold() for channel in named}
        if missing or len({channel.rate for channel in named}) != 1:
            listed = ", ".join(f"{channel.name} ({channel.rate:g} Hz)" for channel in channels)
            problem = f"there is no channel {min(missing)!r}" if missing else "the named channels have different rates"
            raise InputError(f"{path}: channels: {problem}; choose channels of one rate; the file has: {listed}")
        rate = named[0].rate
    dropped = [channel for channel in channels if channel.rate != rate]
    if dropped and not wanted:
        listed = ", ".join(f"{channel.name} ({channel.rate:g} Hz)" for channel in dropped)
        notes.append(f"other rates than {rate:g} Hz, left out: {listed}; choose them by channels=")
    return [channel for channel in channels if channel.rate == rate]


def _has_range(signal: Any) -> bool:
    return signal.physical_min != signal.physical_max and signal.digital_min != signal.digital_max


def _triggers(signal: Any, coded: bool) -> list[tuple[float, str]]:
    """Return time [s] and code of each change of a trigger channel to another value than its resting one."""
    values = np.asarray(signal.digital).astype(np.int64) & _CODE if coded else np.rint(signal.data).astype(np.int64)
    if not len(values):
        return []
    kinds, counts = np.unique(values, return_counts=True)
    resting = int(kinds[np.argmax(counts)])
    changed = np.flatnonzero(np.diff(values, prepend=resting))
    rate = float(signal.sampling_frequency)
    return [(int(k) / rate, str(values[k])) for k in changed if values[k] not in (0, resting)]


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
            annotations = read_annotations(path, 3 if version == _BDF else 2)
        except _BROKEN as problem:
            raise InputError(f"{path}: the file cannot be read: {str(problem)[:200]}") from problem
    if not annotations.continuous:
        raise InputError(f"{path}: the recording has gaps (EDF+D), which is not supported; export it as EDF+C")
    cut = [f"the recording was cut off: {warning.message}" for warning in caught if "records" in str(warning.message)]
    latin = ["an annotation is not UTF-8: read as Latin-1"] if annotations.repaired else []
    return _Content(data, annotations, [*cut, *latin])


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
