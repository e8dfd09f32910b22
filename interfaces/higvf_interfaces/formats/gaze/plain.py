"""Plain gaze tables, `time,x,y[,confidence][,valid]`: a header line, then one row a sample.

Delimiter comma, semicolon or tab. The time is in seconds unless the title carries a unit (`time [ms]`); a unit of x
settles the frame (`x [m]` arena, `x [px]` screen), which must be declared otherwise.
"""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import unit_by_steps
from higvf_interfaces.formats.gaze.binocular import says_no
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, Column, TextFile, cell, epoch_seconds, number

NAME = "gaze-csv"
TITLE = "plain gaze CSV (time,x,y[,confidence])"
TIMES = ("time", "timestamp", "t", "time_s", "time_ms")
_FRAMES = {"m": "arena", "px": "screen"}
_LOOKED_AT = 2000  # rows
_TELLING = 10  # so many times tell their unit


def matches(file: TextFile) -> bool:
    """Whether the header names a time and a point."""
    return file.find(*TIMES) is not None and file.find("x") is not None and file.find("y") is not None


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Begins to read.

    Raises:
        InputError: no time column, no x and y columns, or a unit of time that is unknown or cannot be seconds.
    """
    time, x, y = file.find(*TIMES), file.find("x"), file.find("y")
    if time is None:
        raise InputError(f"{file.path}: no time column (one of {', '.join(TIMES)}); has: {file.titles}")
    if x is None or y is None:
        raise InputError(f"{file.path}: no gaze columns (x and y); has: {file.titles}")
    confidence, validity = file.find("confidence"), file.find("valid")
    seconds = seconds_of(file.path, time)
    if seconds is epoch_seconds:
        _check_steps(file, time)
    notes: list[str] = []

    def rows() -> Iterator[Row]:
        for row in file.rows(notes):
            vouched = not says_no(cell(row, validity))
            point = number(cell(row, x)), number(cell(row, y))
            yield seconds(cell(row, time)), *point, vouched, number(cell(row, confidence))

    return GazeStream(
        format=NAME,
        columns=tuple(column.title for column in (time, x, y, confidence, validity) if column is not None),
        frame=_FRAMES.get(x.unit),
        blocks=blocks_of(rows()),
        notes=notes,
        start=None,
        has_confidence=confidence is not None,
    )


def seconds_of(path: Path, time: Column | None) -> Callable[[str], float]:
    """What reads cells of a column of times as seconds: by the unit of its title, or by `epoch_seconds` without one.

    Raises:
        InputError: the title carries a unit that is none of time; the message begins with `path`.
    """
    unit = "" if time is None else {"time_s": "s", "time_ms": "ms"}.get(time.name, time.unit)
    if not unit:
        return epoch_seconds
    if unit not in TIME_UNITS:
        raise InputError(f"{path}: {unit[:80]!r} is not a unit of time; known units: {', '.join(TIME_UNITS)}")
    return lambda text: number(text) * TIME_UNITS[unit]


def _check_steps(file: TextFile, time: Column) -> None:
    """Refuses a column without unit whose times cannot be seconds of gaze."""
    times = floats([epoch_seconds(cell(row, time)) for row in file.first_rows(_LOOKED_AT)])
    unit = unit_by_steps(times)
    if np.count_nonzero(np.isfinite(times)) > _TELLING and unit != "s":
        raise InputError(
            f"{file.path}: {time.title} names no unit, and its steps are too long for gaze in seconds; write the unit "
            f"into that title, perhaps {time.title} [{unit}]"
        )
