"""BrainFlow streamer files, such as `BrainFlow-RAW_*.csv` beside every recording of the OpenBCI GUI.

Rows of numbers without header, delimited by tabs: counter, channels [uV], other sensors, seconds since 1970, marker.
Only the number of columns tells the board, and with it the channels; on other boards they are chosen by
`channels=column 2+column 3`.
"""

import math
from collections.abc import Iterator
from itertools import islice

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import CommandLog
from higvf_interfaces.formats.signals.records import SignalRecord, SignalRequest
from higvf_interfaces.formats.signals.table import SampleTable, table_markers, table_signals
from higvf_interfaces.formats.text import TextFile, number

NAME = "brainflow-csv"
TITLE = "BrainFlow streamer file (numbers without header, seconds since 1970 in the last column but one)"
_BOARDS = {  # columns: channels, board
    7: (4, "Muse 2016"),
    8: (4, "Muse 2 or Muse S"),
    15: (4, "OpenBCI Ganglion"),
    24: (8, "OpenBCI Cyton"),
    32: (16, "OpenBCI Cyton with Daisy"),
}
_FEWEST = 6  # columns
_LOOKED_AT = 20  # rows
_EPOCH = (1e9, 4e9)  # times since 1970 [s]
_COLUMN = "column "


def matches(file: TextFile) -> bool:
    """Return whether the first rows are numbers, with times since 1970 before the last."""
    if len(file.columns) < _FEWEST or not math.isfinite(number(file.columns[0].title)):
        return False
    lines = list(islice(file.lines(), _LOOKED_AT))
    rows = [_cells(file, line) for line in (lines[:-1] if len(lines) < _LOOKED_AT and not file.complete else lines)]
    if not rows or any(len(row) != len(file.columns) for row in rows):
        return False
    table = floats([[number(cell) for cell in row] for row in rows])
    stamps = table[:, -2]
    return bool(np.isfinite(table).all() and (stamps >= _EPOCH[0]).all() and (stamps <= _EPOCH[1]).all())


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the channels of the board [uV], or those chosen by their columns.

    Raises:
        InputError: If the board is unknown and no channels are chosen, or there are no samples.
    """
    return table_signals(_table(file, request), request)


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:
    """Read the events of the marker column, the last one.

    Raises:
        InputError: If there is no event, or no samples.
    """
    return table_markers(_table(file, request._replace(channels=(f"{_COLUMN}1",))), request)


def _table(file: TextFile, request: SignalRequest) -> SampleTable:
    width = len(file.columns)
    by_column = any(name.casefold().startswith(_COLUMN) for name in request.channels)
    if not by_column and width not in _BOARDS:
        known = "; ".join(f"{columns}: {board}" for columns, (_, board) in _BOARDS.items())
        raise InputError(
            f"{file.path}: a BrainFlow file of {width} columns is of no known board ({known}); choose its channels by "
            f"channels={_COLUMN}2+{_COLUMN}3 (numbers from 1 to {width})"
        )
    count, board = (width, "") if by_column else _BOARDS[width]
    channels = tuple(range(width)) if by_column else tuple(range(1, count + 1))

    def rows(notes: list[str]) -> Iterator[list[str]]:
        dropped = 0
        if board:
            notes.append(f"{width} columns: read as those of {board}, {count} channels")
        for line in file.lines():
            row = _cells(file, line)
            if len(row) == width:
                yield row
            else:
                dropped += 1
        if dropped:
            notes.append(f"{dropped} truncated rows dropped")

    return SampleTable(
        path=file.path,
        format=NAME,
        rows=rows,
        channels=channels,
        names=tuple(f"{_COLUMN}{k + 1}" if by_column else f"EXG Channel {k - 1}" for k in channels),
        units=("" if by_column else "uV",) * len(channels),
        time=width - 2,
        seconds=number,
        counter=0,
        marker=width - 1,
        rate=None,
    )


def _cells(file: TextFile, line: str) -> list[str]:
    return [part.strip() for part in line.rstrip("\t ").split(file.delimiter)]
