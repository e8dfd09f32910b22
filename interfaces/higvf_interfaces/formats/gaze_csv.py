"""Plain gaze tables, `time,x,y[,confidence][,valid]`: a header line, then one row a sample.

Delimiter comma, semicolon or tab. The time is in seconds unless the title carries a unit (`time [ms]`); a unit of x
settles the frame (`x [m]` arena, `x [px]` screen), which must be declared otherwise.
"""

import numpy as np

from higvf_console.arrays import bools, floats
from higvf_console.errors import InputError
from higvf_interfaces.formats.records import GazeRecording, gaze_clock
from higvf_interfaces.formats.text import TIME_UNITS, TextFile, cell, number

NAME = "gaze-csv"
TITLE = "plain gaze CSV (time,x,y[,confidence])"
TIMES = ("time", "timestamp", "t", "time_s", "time_ms")
_FRAMES = {"m": "arena", "px": "screen"}
_FALSE = ("0", "false", "no", "invalid")


def matches(file: TextFile) -> bool:
    """Whether the header names a time and a point."""
    return file.find(*TIMES) is not None and file.find("x") is not None and file.find("y") is not None


def read(file: TextFile) -> GazeRecording:
    """Reads the rows.

    Raises:
        InputError: no time column, no x and y columns, an unknown unit of time, or no row with a time.
    """
    time, x, y = file.find(*TIMES), file.find("x"), file.find("y")
    if time is None:
        raise InputError(f"{file.path}: no time column (one of {', '.join(TIMES)}); has: {file.titles}")
    if x is None or y is None:
        raise InputError(f"{file.path}: no gaze columns (x and y); has: {file.titles}")
    confidence, validity = file.find("confidence"), file.find("valid")
    scale = time_scale(file)
    notes: list[str] = []
    rows = [
        (number(cell(row, time)), number(cell(row, x)), number(cell(row, y)), number(cell(row, confidence)),
         cell(row, validity).casefold() not in _FALSE)
        for row in file.rows(notes)
    ]  # fmt: skip
    clock = gaze_clock(file.path, [row[0] * scale for row in rows], from_first=False)
    table = floats(rows)[clock.kept]
    points = floats(table[:, 1:3])
    valid = bools(np.isfinite(points).all(axis=1) & (table[:, 4] > 0))
    return GazeRecording(
        time=clock.time,
        points=points,
        valid=valid,
        confidence=floats(table[:, 3]) if confidence is not None else None,
        frame=_FRAMES.get(x.unit),
        screen=None,
        epoch=clock.epoch,
        format=NAME,
        notes=(*notes, *clock.notes),
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
