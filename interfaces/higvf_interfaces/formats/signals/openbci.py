"""OpenBCI GUI text recordings, in the old format (no header row) and the new (`Sample Index, EXG Channel 0, ...`).

Lines that start with % describe the recording. The old format has the columns counter, channels, three accelerometer
channels, time of day and, in later versions, milliseconds since 1970; its channels are counted by the line
`%Number of channels`, or else by the columns. A recording converted from an SD card has no times, and the accelerometer
in every tenth row only. The Python library writes the time before the counter. The new format has duplicate titles
(`Not Used`, `Other`) and a `Timestamp` in seconds or milliseconds. Samples arrive in bursts, so their times are
smoothed; the wrapping counter reveals lost samples.
"""

import csv
import re
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import islice
from typing import NamedTuple

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import CommandLog
from higvf_interfaces.formats.signals.records import SignalRecord, SignalRequest
from higvf_interfaces.formats.signals.table import SampleTable, table_markers, table_signals
from higvf_interfaces.formats.text import TextFile, epoch_seconds, number

NAME = "openbci-txt"
TITLE = "OpenBCI GUI text (% lines, then Sample Index, channels in uV)"
_HEAD_LINES = 200
_CLOCK_TIME = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d+)?)")
_CHANNELS = re.compile(r"%\s*number of channels\s*=\s*(\d{1,3})", re.IGNORECASE)
_RATE = re.compile(r"%\s*sample rate\s*=\s*([\d.,]+)", re.IGNORECASE)
_FIRST = re.compile(r"%\s*first column\s*=\s*(.+)", re.IGNORECASE)
_DECIMAL_COMMA, _DECIMAL_POINT = re.compile(r"[+-]?\d+,\d+"), re.compile(r"[+-]?\d+\.\d+")
_BOARDS = (4, 8, 16)  # channels of a Ganglion, a Cyton, and a Cyton with Daisy
_ACCELEROMETER = 3  # columns

_Split = Callable[[str], list[str]]


class _Layout(NamedTuple):
    """Layout of the old format: columns of a row, and whether the accelerometer is in some rows only."""

    width: int
    interleaved: bool
    counter: int
    time: int | None
    channels: tuple[int, ...]
    notes: tuple[str, ...]


def matches(file: TextFile) -> bool:
    """Return whether the first line names OpenBCI."""
    line = file.first_line.casefold()
    return line.startswith("%") and ("openbci" in line or "obci sd" in line)


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the EXG channels [uV].

    Raises:
        InputError: If there are no samples, the channels are unknown, the numbers are cut by their decimal commas, or
            there are neither times nor a rate.
    """
    return table_signals(_table(file, request), request)


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:
    """Read the events of the column `Marker Channel`.

    Raises:
        InputError: As `read_signals`, or if there is no such column or no event.
    """
    return table_markers(_table(file, request), request)


def _table(file: TextFile, request: SignalRequest) -> SampleTable:
    head = list(islice(file.lines(), _HEAD_LINES))
    about = "\n".join(line for line in head if line.startswith("%"))
    table = [line for line in head if not line.startswith("%")]
    if not table:
        raise InputError(f"{file.path}: the OpenBCI recording has no samples")
    rate = _rate(about)
    split = _splitter(file, about, table)
    first = split(table[0])
    if first[0].casefold() == "sample index":
        channels = tuple(k for k, title in enumerate(first) if re.match(r"(exg|eeg|emg|ecg) channel", title.casefold()))

        def titled(notes: list[str]) -> Iterator[list[str]]:
            return _rows(file, split, 1, (len(first),), notes)

        return SampleTable(
            path=file.path,
            format=NAME,
            rows=titled,
            channels=channels,
            names=tuple(first[k] for k in channels),
            units=("uV",) * len(channels),
            time=_titled(first, "timestamp"),
            seconds=epoch_seconds,
            counter=0,
            marker=_titled(first, "marker channel"),
            rate=rate,
        )
    layout = _layout(file, about, [split(line) for line in table], request)

    def rows(notes: list[str]) -> Iterator[list[str]]:
        notes += layout.notes
        more = layout.width + _ACCELEROMETER if layout.interleaved else layout.width
        return _rows(file, split, 0, (layout.width, more), notes)

    return SampleTable(
        path=file.path,
        format=NAME,
        rows=rows,
        channels=layout.channels,
        names=tuple(f"EXG Channel {k}" for k in range(len(layout.channels))),
        units=("uV",) * len(layout.channels),
        time=layout.time,
        seconds=_old_seconds,
        counter=layout.counter,
        marker=None,
        rate=rate,
    )


def _layout(file: TextFile, about: str, rows: list[list[str]], request: SignalRequest) -> _Layout:
    """Return the layout of the old format by the lines that describe it and the first rows.

    Raises:
        InputError: If the channels cannot be told from the other columns.
    """
    widths = Counter(map(len, rows))
    width = widths.most_common(1)[0][0]
    interleaved = width + _ACCELEROMETER in widths
    row = next(row for row in rows if len(row) == width)
    stated = _FIRST.search(about)
    first = stated[1].strip().casefold().replace(" ", "") if stated else "sampleindex"
    if first not in ("sampleindex", "timeinsec"):
        raise InputError(
            f"{file.path}: %First Column = {first[:40]} is not understood; known: SampleIndex, Time in sec"
        )
    begin = 1 if first == "sampleindex" else 2
    times = [0] if begin == 2 else _times(row)
    kept = [k for k in range(begin, width) if k not in times and row[k] != ""]
    count = _CHANNELS.search(about)
    if count is not None and not 0 < int(count[1]) <= len(kept):
        raise InputError(
            f"{file.path}: the line %Number of channels = {count[1]} contradicts the {len(kept)} columns of its rows"
        )
    without = len(kept) if interleaved else len(kept) - _ACCELEROMETER
    notes: tuple[str, ...] = ()
    if count is not None:
        number_of = int(count[1])
    elif without in _BOARDS or len(kept) in _BOARDS:
        number_of = without if without in _BOARDS else len(kept)
        notes = (f"no line %Number of channels: {number_of} channels by the {width} columns of a row",)
    elif request.channels:
        number_of = len(kept)
    else:
        raise InputError(
            f"{file.path}: no line %Number of channels, and {width} columns fit no board with "
            f"{', '.join(map(str, _BOARDS))} channels; choose by channels=EXG Channel 0+EXG Channel 1 (to "
            f"{len(kept) - 1})"
        )
    return _Layout(width, interleaved, begin - 1, times[-1] if times else None, tuple(kept[:number_of]), notes)


def _splitter(file: TextFile, about: str, table: list[str]) -> _Split:
    """Return the function that splits a row into cells.

    With a decimal comma, numbers are whole only if another delimiter separates them, such as a comma and a blank.

    Raises:
        InputError: If decimal commas and delimiters cannot be told apart.
    """
    delimiter = next((mark for mark in "\t;" if mark in table[-1]), "")
    if delimiter:
        return lambda line: [cell.strip() for cell in line.split(delimiter)]
    spaced = [re.split(r",\s+", line.strip().rstrip(",")) for line in table]
    cells = [cell for row in spaced for cell in row]
    points = any(_DECIMAL_POINT.fullmatch(cell) for line in table for cell in _cells(line))
    rate = _RATE.search(about)
    stated = rate is not None and "," in rate[1].rstrip(",")
    torn = len(_cells(table[-1])) > len(_cells(table[0])) and table[0][:1].isalpha()  # more cells than titles
    if points or not (stated or torn or any(map(_DECIMAL_COMMA.fullmatch, cells))):
        return _cells
    if len(spaced[-1]) < 3 or any(cell.count(",") > 1 for cell in cells):
        raise InputError(
            f"{file.path}: the numbers have decimal commas and are separated by commas, so they cannot be told apart; "
            "record them with a decimal point (OpenBCI GUI on a computer set to English)"
        )
    return lambda line: re.split(r",\s+", line.strip().rstrip(","))


def _rows(file: TextFile, split: _Split, skip: int, widths: tuple[int, ...], notes: list[str]) -> Iterator[list[str]]:
    dropped = 0
    samples = (line for line in file.lines() if not line.startswith("%"))
    for line in islice(samples, skip, None):
        row = split(line)
        if len(row) in widths:
            yield row
        else:
            dropped += 1
    if dropped:
        notes.append(f"{dropped} truncated rows dropped")


def _cells(line: str) -> list[str]:
    try:
        return next(csv.reader([line], skipinitialspace=True))
    except (csv.Error, StopIteration):
        return [""]


def _rate(about: str) -> float | None:
    stated = _RATE.search(about)
    rate = number(stated[1].rstrip(".,")) if stated else 0.0
    return rate if rate > 0 else None


def _titled(titles: list[str], name: str) -> int | None:
    return next((k for k, title in enumerate(titles) if title.casefold() == name), None)


def _times(row: list[str]) -> list[int]:
    """Return the columns of a row that can be parsed as a time of day or since an epoch."""
    return [k for k, text in enumerate(row) if epoch_seconds(text) > 1e8 or _CLOCK_TIME.fullmatch(text)]


def _old_seconds(text: str) -> float:
    clock = _CLOCK_TIME.fullmatch(text.strip())
    if clock is None:
        return epoch_seconds(text)
    return 3600 * int(clock[1]) + 60 * int(clock[2]) + number(clock[3])
