"""Mind Monitor CSV (Muse head bands): raw signals, and events in the column `Elements`.

    TimeStamp,Delta_TP9,...,RAW_TP9,RAW_AF7,RAW_AF8,RAW_TP10,AUX_RIGHT,...,HeadBandOn,HSI_TP9,...,Battery,Elements
    2025-07-01 14:56:05.592,0.498,...,843.5,...,1,1.0,1.0,1.0,1.0,85.0,
    2025-07-01 14:56:06.010,,,,...,,/muse/elements/blink

The channels are the raw electrodes and the auxiliary ones [uV]; the band powers are no signals. Rows of events have no
samples. While the head band is off (`HeadBandOn` = 0), samples are missing. `HSI` tells the fit of an electrode: 1
good, 2 medium, 4 bad; badly fitted samples are counted in a note. Time stamps are local times.
"""

import math
from collections import Counter
from collections.abc import Iterator

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import event_times
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals.records import SignalRecord, SignalRequest
from higvf_interfaces.formats.signals.table import SampleTable, table_signals
from higvf_interfaces.formats.text import Column, TextFile, cell, epoch_seconds

NAME = "mind-monitor"
TITLE = "Mind Monitor CSV (TimeStamp, RAW_TP9, ...)"
MARKED_NAME = "mind-monitor-elements"
MARKED_TITLE = "events of a Mind Monitor CSV (column Elements)"
_EVENTS = ("elements", "marker")
_PREFIXES = ("/muse/elements/", "/muse/event/", "/")
_LOOSE = 4.0  # value of HSI for a bad fit
_SLOWEST = 100.0  # a Muse samples at 220 or 256; at less the app recorded averages [Hz]


def matches(file: TextFile) -> bool:
    """Return whether the header has a time stamp and a raw electrode."""
    return file.find("timestamp") is not None and any(column.name.startswith("raw_") for column in file.columns)


def matches_marked(file: TextFile) -> bool:
    """Return whether there is also a column of events."""
    return matches(file) and file.find(*_EVENTS) is not None


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the raw electrodes and the auxiliary channels.

    Raises:
        InputError: If there is no time stamp, no raw electrode, or no sample.
    """
    time = file.find("timestamp")
    channels = _channels(file)
    if time is None or not channels:
        raise InputError(f"{file.path}: needs the columns TimeStamp and RAW_TP9; has: {file.titles}")

    def rows(notes: list[str]) -> Iterator[list[str]]:
        return _samples(file, channels, notes)

    table = SampleTable(
        path=file.path,
        format=NAME,
        rows=rows,
        channels=tuple(column.place for column in channels),
        names=tuple(column.title.strip() for column in channels),
        units=("uV",) * len(channels),
        time=time.place,
        seconds=epoch_seconds,
        counter=None,
        marker=None,
        rate=None,
    )
    record = table_signals(table, request)
    if record.rate < _SLOWEST:
        raise InputError(
            f"{file.path}: recorded at {record.rate:.3g} Hz, too slow for EEG; set the recording interval of Mind "
            "Monitor to Constant"
        )
    return record


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:  # noqa: ARG001 - needs no options
    """Read the events, such as `blink`, `jaw_clench` and `Marker/1`.

    Raises:
        InputError: If there is no event, or no row has a time.
    """
    time, column, channels = file.find("timestamp"), file.find(*_EVENTS), _channels(file)
    notes: list[str] = []
    begun = math.nan  # time of the first sample, time 0 of the signals
    events: list[tuple[float, str]] = []
    for row in file.rows(notes):
        at, label = epoch_seconds(cell(row, time)), _label(cell(row, column))
        if math.isnan(begun) and any(cell(row, channel) for channel in channels):
            begun = at
        if label:
            events.append((at, label))
    begun = begun if math.isfinite(begun) else next((at for at, _ in events if math.isfinite(at)), 0.0)
    order, times, shift, repaired = event_times(floats([at - begun for at, _ in events]), from_epoch=False)
    if not len(order):
        raise InputError(f"{file.path}: no event in a column {' or '.join(_EVENTS)}, so it holds no decisions")
    decisions = tuple(Decision(t, events[k][1], None) for k, t in zip(order.tolist(), times.tolist(), strict=True))
    return CommandLog(decisions, begun + shift, MARKED_NAME, (*notes, *repaired))


def _channels(file: TextFile) -> list[Column]:
    return [column for column in file.columns if column.name.startswith(("raw_", "aux"))]


def _samples(file: TextFile, channels: list[Column], notes: list[str]) -> Iterator[list[str]]:
    """Yield the rows with samples; empty cells while the head band is off."""
    worn = file.find("headbandon")
    fits = [(c.title, file.find(f"hsi_{c.name.removeprefix('raw_')}")) for c in channels]
    off = 0
    loose = Counter[str]()
    for row in file.rows(notes):
        if not any(cell(row, column) for column in channels):
            continue
        if cell(row, worn) in ("0", "0.0"):
            off += 1
            row = [*row]  # noqa: PLW2901 - the cells of this row are emptied
            for column in channels:
                row[column.place] = ""
        loose.update(title for title, fit in fits if epoch_seconds(cell(row, fit)) >= _LOOSE)
        yield row
    if off:
        notes.append(f"{off} samples with the head band off are missing")
    notes += [f"{count} samples of {title} with a bad fit (HSI)" for title, count in sorted(loose.items())]


def _label(text: str) -> str:
    for prefix in _PREFIXES:
        if text.startswith(prefix):
            return text.removeprefix(prefix)
    return text
