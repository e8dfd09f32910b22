"""Signal tables of Muse and Lab Streaming Layer tools: a time column, channels, and optionally a marker column.

    timestamps,TP9,AF7,AF8,TP10,Right AUX,Marker0

Every other column with numbers in its first rows is a channel. The time stamps may repeat and run backwards.
"""

import math
import re
from collections.abc import Iterator

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.gaze.plain import STAMPS, find_point, seconds_of
from higvf_interfaces.formats.records import CommandLog
from higvf_interfaces.formats.signals.records import SignalRecord, SignalRequest, plain_unit
from higvf_interfaces.formats.signals.table import SampleTable, table_markers, table_signals
from higvf_interfaces.formats.text import Column, TextFile, cell, epoch_seconds, number

NAME = "signal-csv"
TITLE = "table of samples (timestamps, one column a channel[, Marker0])"
MARKED_NAME = "signal-csv-markers"
MARKED_TITLE = "marker column of a table of samples (timestamps,...,Marker0)"
_MARKERS = ("marker0", "marker", "markers", "stim", "trigger", "status", "event")
_UNMARKED = ("", "0", "0.0")
_NO_CHANNEL = {"x", "y", "confidence", "valid", "label", "command"}
_LOOKED_AT = 5  # rows
_UNIT = re.compile(r"[\[(][^\[\]()]*[\])]\s*$")  # at the end of a title
_SLOWEST = 5.0  # below it, times without unit are hardly seconds [Hz]


def matches(file: TextFile) -> bool:
    """Return whether there is a time column and a channel, and the table is neither gaze nor a command log."""
    is_gaze = find_point(file) is not None or any("gaze" in column.name for column in file.columns)
    return file.find(*STAMPS) is not None and bool(_channels(file)) and not is_gaze and not _NO_CHANNEL & _names(file)


def matches_marked(file: TextFile) -> bool:
    """Return whether there is also a marker column that is unmarked in the first row."""
    marker = file.find(*_MARKERS)
    return matches(file) and marker is not None and cell(file.first_rows(1)[0], marker) in _UNMARKED


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the channels.

    Raises:
        InputError: If there are no channels, no samples, or neither times nor a rate, or the unit of time is unknown or
            cannot be seconds.
    """
    record = table_signals(_table(file, NAME), request)
    time = file.find(*STAMPS)
    if time is not None and seconds_of(file.path, time) is epoch_seconds and record.rate < _SLOWEST:
        raise InputError(
            f"{file.path}: {time.title} has no unit, and in seconds its rate is {record.rate:.3g} Hz, too slow for a "
            f"signal; write the unit into that title, such as {time.title} [ms], or [s] if it is right"
        )
    return record


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:
    """Read the events of the marker column.

    Raises:
        InputError: If there is no event, no samples, or neither times nor a rate, or the unit of time is unknown.
    """
    return table_markers(_table(file, MARKED_NAME), request)


def _table(file: TextFile, name: str) -> SampleTable:
    time, channels = file.find(*STAMPS), _channels(file)
    if not channels:
        raise InputError(f"{file.path}: no column of numbers beside the time; has: {file.titles}")

    def rows(notes: list[str]) -> Iterator[list[str]]:
        return file.rows(notes)

    marker = file.find(*_MARKERS)
    return SampleTable(
        path=file.path,
        format=name,
        rows=rows,
        channels=tuple(c.place for c in channels),
        names=tuple(_UNIT.sub("", c.title).strip() for c in channels),
        units=tuple(plain_unit(c.unit) for c in channels),
        time=None if time is None else time.place,
        seconds=seconds_of(file.path, time),
        counter=None,
        marker=None if marker is None else marker.place,
        rate=None,
    )


def _channels(file: TextFile) -> list[Column]:
    rows = file.first_rows(_LOOKED_AT)
    skipped = {*STAMPS, *_MARKERS}
    candidates = [c for c in file.columns if c.name not in skipped and c.name]
    return [c for c in candidates if any(math.isfinite(number(cell(row, c))) for row in rows)]


def _names(file: TextFile) -> set[str]:
    return {column.name for column in file.columns}
