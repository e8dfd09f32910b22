"""Myo armband samples as saved by common scripts: rows of eight integers from -128 to 127, without header.

The file has neither times nor units, so the option `rate` is required (a Myo armband has 200 Hz).
"""

from collections.abc import Iterator
from itertools import islice

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.signals.records import SignalRecord, SignalRequest
from higvf_interfaces.formats.signals.table import SampleTable, table_signals
from higvf_interfaces.formats.text import TextFile, number

NAME = "myo-csv"
TITLE = "Myo armband (8 whole numbers a row, no times)"
_CHANNELS = 8
_LOOKED_AT = 20  # rows


def matches(file: TextFile) -> bool:
    """Return whether the first rows are eight integers of one signed byte each."""
    head = list(islice(file.lines(), _LOOKED_AT))
    whole = head[:-1] if len(head) < _LOOKED_AT and not file.complete else head
    return bool(whole) and all(_is_sample(_cells(file, line)) for line in whole)


def read_signals(file: TextFile, request: SignalRequest) -> SignalRecord:
    """Read the eight electrodes, in device units.

    Raises:
        InputError: If no rate is given, or no row is a sample.
    """
    if request.rate is None:
        raise InputError(
            f"{file.path}: a {TITLE} cannot be replayed without times; give rate=200 (the rate of a Myo armband) or "
            "period=0.005"
        )
    names = tuple(f"EMG{k}" for k in range(1, _CHANNELS + 1))

    def rows(notes: list[str]) -> Iterator[list[str]]:
        dropped = 0
        for line in file.lines():
            row = _cells(file, line)
            if _is_sample(row):
                yield row
            else:
                dropped += 1
        if dropped:
            notes.append(f"{dropped} rows that are not eight signed bytes dropped")

    table = SampleTable(
        path=file.path,
        format=NAME,
        rows=rows,
        channels=tuple(range(_CHANNELS)),
        names=names,
        units=("",) * _CHANNELS,
        time=None,
        seconds=number,
        counter=None,
        marker=None,
        rate=None,
    )
    return table_signals(table, request)


def _cells(file: TextFile, line: str) -> list[str]:
    return [part.strip() for part in line.split(file.delimiter)]


def _is_sample(row: list[str]) -> bool:
    return len(row) == _CHANNELS and all(
        len(part) <= 4 and part.removeprefix("-").isdecimal() and -128 <= int(part) <= 127 for part in row
    )
