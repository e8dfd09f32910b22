"""Plain gaze tables, `time,x,y[,confidence][,valid]`: a header line, then one row a sample.

Delimiter comma, semicolon or tab. The time is in seconds unless the title carries a unit (`time [ms]`); a unit of x
settles the frame (`x [m]` arena, `x [px]` screen), which must be declared otherwise.
"""

from collections.abc import Iterator

from higvf_console.errors import InputError
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, TextFile, cell, number

NAME = "gaze-csv"
TITLE = "plain gaze CSV (time,x,y[,confidence])"
TIMES = ("time", "timestamp", "t", "time_s", "time_ms")
_FRAMES = {"m": "arena", "px": "screen"}
_FALSE = ("0", "false", "no", "invalid")


def matches(file: TextFile) -> bool:
    """Whether the header names a time and a point."""
    return file.find(*TIMES) is not None and file.find("x") is not None and file.find("y") is not None


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Begins to read.

    Raises:
        InputError: no time column, no x and y columns, or an unknown unit of time.
    """
    time, x, y = file.find(*TIMES), file.find("x"), file.find("y")
    if time is None:
        raise InputError(f"{file.path}: no time column (one of {', '.join(TIMES)}); has: {file.titles}")
    if x is None or y is None:
        raise InputError(f"{file.path}: no gaze columns (x and y); has: {file.titles}")
    confidence, validity = file.find("confidence"), file.find("valid")
    scale = time_scale(file)
    notes: list[str] = []

    def rows() -> Iterator[Row]:
        for row in file.rows(notes):
            vouched = cell(row, validity).casefold() not in _FALSE
            point = number(cell(row, x)), number(cell(row, y))
            yield number(cell(row, time)) * scale, *point, vouched, number(cell(row, confidence))

    return GazeStream(
        format=NAME,
        columns=tuple(column.title for column in (time, x, y, confidence, validity) if column is not None),
        frame=_FRAMES.get(x.unit),
        blocks=blocks_of(rows()),
        notes=notes,
        start=None,
        has_confidence=confidence is not None,
    )


def time_scale(file: TextFile) -> float:
    """Seconds in one unit of the time column.

    Raises:
        InputError: the title carries a unit that is none of time.
    """
    time = file.find(*TIMES)
    unit = "" if time is None else "ms" if time.name == "time_ms" else time.unit
    if unit and unit not in TIME_UNITS:
        raise InputError(f"{file.path}: {unit[:80]!r} is not a unit of time; known units: {', '.join(TIME_UNITS)}")
    return TIME_UNITS[unit or "s"]
