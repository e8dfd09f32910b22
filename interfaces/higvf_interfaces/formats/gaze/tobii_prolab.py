"""Tobii Pro Lab's tab-separated export: units in the column titles, rows of all sensors interleaved, any locale.

One row a sample of any sensor; those of the eye tracker are kept. Gaze is in pixels of the display ("DACS px"), with
"Valid" or "Invalid" for each eye, and empty cells where there is nothing. Times come from the eye tracker's own clock
where every sample has it: the recording clock is rounded to milliseconds, too coarse for velocities. What the export
leaves open (which clock is complete, its unit, the words of validity) is settled by the first rows.
"""

import math
from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import unit_by_steps
from higvf_interfaces.formats.gaze.binocular import both
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, Column, TextFile, cell, number

NAME = "tobii-prolab"
TITLE = "Tobii Pro Lab TSV"
_PIXELS = ("dacs px", "dacspx", "px", "")
_CLOCKS = ("eyetracker timestamp", "recording timestamp", "computer timestamp")
_FIRST_ROWS = 2000

_Pair = tuple[Column | None, Column | None]


class _Columns(NamedTuple):
    sensor: Column | None
    clocks: tuple[Column, ...]
    both: _Pair
    left: _Pair
    right: _Pair
    validity: _Pair
    screen: _Pair


class _Sample(NamedTuple):
    times: tuple[float, ...]
    point: tuple[float, float]
    words: tuple[str, str]
    screen: tuple[float, float]


def matches(file: TextFile) -> bool:
    """Whether the header is Pro Lab's."""
    return file.find(*_CLOCKS) is not None and any(column.name.startswith("gaze point") for column in file.columns)


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Begins to read the eye tracker's rows.

    Raises:
        InputError: no times, no gaze columns in display pixels, or no row of an eye tracker.
    """
    columns = _find_columns(file)
    notes: list[str] = []
    named = True
    first = list(islice(_samples(file, columns, named, []), _FIRST_ROWS))
    if not first:
        named = False
        first = list(islice(_samples(file, columns, named, []), _FIRST_ROWS))
        notes.append('no row says Sensor "Eye Tracker": rows with gaze or validity taken')
    if not first:
        raise InputError(f"{file.path}: no row comes from an eye tracker")
    chosen, scale = _choose_clock(columns.clocks, floats([sample.times for sample in first]), notes)
    worded = any(word in ("valid", "invalid") for sample in first for word in sample.words)
    if not worded:
        notes.append("no validity words: every sample with coordinates counts as valid")

    def rows() -> Iterator[Row]:
        for sample in _samples(file, columns, named, notes):
            yield sample.times[chosen] * scale, *sample.point, not worded or "valid" in sample.words, math.nan

    return GazeStream(
        format=NAME,
        columns=_used(columns, chosen),
        frame="screen",
        blocks=blocks_of(rows()),
        notes=notes,
        screen=next((sample.screen for sample in first if min(sample.screen) > 0), None),
    )


def _find_columns(file: TextFile) -> _Columns:
    def pair(text: str, units: tuple[str, ...] | None) -> _Pair:
        return file.find(text.format("x"), units=units), file.find(text.format("y"), units=units)

    combined, left, right = (pair(f"gaze point {eye}{{}}", _PIXELS) for eye in ("", "left ", "right "))
    if not any(None not in eye for eye in (combined, left, right)):
        raise InputError(
            f"{file.path}: no gaze columns in display pixels (Gaze point X [DACS px]): export them too; "
            f"has: {file.titles}"
        )
    clocks = tuple(clock for clock in map(file.find, _CLOCKS) if clock is not None)
    if not clocks:
        raise InputError(f"{file.path}: no timestamp column (Recording timestamp [ms]); has: {file.titles}")
    return _Columns(
        sensor=file.find("sensor"),
        clocks=clocks,
        both=combined,
        left=left,
        right=right,
        validity=(file.find("validity left"), file.find("validity right")),
        screen=(file.find("recording resolution width"), file.find("recording resolution height")),
    )


def _samples(file: TextFile, columns: _Columns, named: bool, notes: list[str]) -> Iterator[_Sample]:
    """Rows of the eye tracker: by the sensor's name, or those with gaze or validity."""
    for row in file.rows(notes):
        point = _gaze(row, columns)
        left, right = (cell(row, column).casefold() for column in columns.validity)
        if named and columns.sensor is not None:
            wanted = cell(row, columns.sensor).casefold() == "eye tracker"
        else:
            wanted = bool(left or right) or point[0] == point[0]
        if wanted:
            times = tuple(number(cell(row, clock)) for clock in columns.clocks)
            width, height = (number(cell(row, column)) for column in columns.screen)
            yield _Sample(times, point, (left, right), (width, height))


def _gaze(row: list[str], columns: _Columns) -> tuple[float, float]:
    """The combined gaze point, or what the two eyes' points average to [px]."""
    if None not in columns.both:
        return number(cell(row, columns.both[0])), number(cell(row, columns.both[1]))
    return both((number(cell(row, x)), number(cell(row, y))) for x, y in (columns.left, columns.right))


def _choose_clock(clocks: tuple[Column, ...], times: Floats, notes: list[str]) -> tuple[int, float]:
    """The first clock that every row has, else the one that most rows have; and the seconds in its unit."""
    chosen = int(np.argmax(np.isfinite(times).sum(axis=0)))
    clock = clocks[chosen]
    if clock.unit in TIME_UNITS:
        return chosen, TIME_UNITS[clock.unit]
    unit = unit_by_steps(times[:, chosen])
    notes.append(f"{clock.title} has no unit: taken as {unit} from its steps")
    return chosen, TIME_UNITS[unit]


def _used(columns: _Columns, chosen: int) -> tuple[str, ...]:
    gaze = columns.both if None not in columns.both else (*columns.left, *columns.right)
    used = (columns.clocks[chosen], columns.sensor, *gaze, *columns.validity)
    return tuple(column.title for column in used if column is not None)
