"""Tobii Pro Lab TSV exports, in any locale.

Rows of all sensors are interleaved; only those of the eye tracker are read. Gaze of a screen-based tracker is in
display pixels ("DACS px"), that of glasses in pixels of the scene camera ("MCS px"). Older exports state neither:
motion sensors then tell the glasses, and a screen resolution the screen. Each eye is "Valid" or "Invalid"; missing
values are empty cells. The clock of the eye tracker is preferred, because the recording clock is rounded to
milliseconds, too coarse for velocities. The first rows determine which clock is complete, its unit, and whether there
are validity words.
"""

import math
from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import unit_by_steps
from higvf_interfaces.formats.gaze.binocular import both, cut_word
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, Column, TextFile, cell, number, seconds_per

NAME = "tobii-prolab"
TITLE = "Tobii Pro Lab TSV"
_DISPLAY, _UNSTATED = ("dacs px", "dacspx"), ("px", "")
_MEDIA = ("mcs px", "mcspx")  # of glasses: of the scene video
_WORDS = ("valid", "invalid")
_MOTION = ("gyro", "accelerometer", "magnetometer")  # sensors that only glasses have
_CLOCKS = ("eyetracker timestamp", "recording timestamp", "computer timestamp")
_SCREENS = ("recording resolution width", "presented stimulus name", "presented media name", "mouse position x")
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
    frame: str | None


class _Sample(NamedTuple):
    times: tuple[float, ...]
    point: tuple[float, float]
    words: tuple[str, str]
    screen: tuple[float, float]


def matches(file: TextFile) -> bool:
    """Return whether the header has a time stamp and a gaze point of Pro Lab."""
    return file.find(*_CLOCKS) is not None and any(column.name.startswith("gaze point") for column in file.columns)


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the export.

    Raises:
        InputError: If the times, the gaze columns in display pixels, or the rows of an eye tracker are missing.
    """
    columns = _find_columns(file)
    notes: list[str] = []
    named = True
    first = list(islice(_samples(file, columns, named, []), _FIRST_ROWS))
    if not first:
        named = False
        first = list(islice(_samples(file, columns, named, []), _FIRST_ROWS))
        notes.append('no row has Sensor "Eye Tracker": rows with gaze or validity used')
    if not first:
        raise InputError(f"{file.path}: no row comes from an eye tracker")
    chosen, scale = _choose_clock(file, columns.clocks, floats([sample.times for sample in first]), notes)
    words = {word for sample in first for word in sample.words if word}
    unknown = sorted(word for word in words - set(_WORDS) if not cut_word(file, word, _WORDS))
    if unknown:
        raise InputError(f"{file.path}: validity {unknown[0][:40]!r} is not understood; known: Valid, Invalid")
    if not words:
        notes.append("no validity values: every sample with coordinates counts as valid")

    def rows() -> Iterator[Row]:
        for sample in _samples(file, columns, named, notes):
            yield sample.times[chosen] * scale, *sample.point, not words or "valid" in sample.words, math.nan

    return GazeStream(
        format=NAME,
        columns=_used(columns, chosen),
        frame=columns.frame,
        blocks=blocks_of(rows()),
        notes=notes,
        screen=next((sample.screen for sample in first if min(sample.screen) > 0), None),
    )


def _find_columns(file: TextFile) -> _Columns:
    def pair(text: str, units: tuple[str, ...] | None) -> _Pair:
        return file.find(text.format("x"), units=units), file.find(text.format("y"), units=units)

    worn = _worn(file)
    units = (*_DISPLAY, *_UNSTATED, *(_MEDIA if worn else ()))
    combined, left, right = (pair(f"gaze point {eye}{{}}", units) for eye in ("", "left ", "right "))
    if not any(None not in eye for eye in (combined, left, right)):
        raise InputError(
            f"{file.path}: no gaze columns in display pixels (Gaze point X [DACS px]); include them in the export; "
            f"has: {file.titles}"
        )
    used = next(column for eye in (combined, left, right) for column in eye if column is not None)
    size = (file.find(f"recording {'media' if worn else 'resolution'} {side}") for side in ("width", "height"))
    on_screen = used.unit in _DISPLAY or file.find(*_SCREENS) is not None
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
        screen=(next(size), next(size)),
        frame="scene" if worn and used.unit not in _DISPLAY else "screen" if on_screen else None,
    )


def _worn(file: TextFile) -> bool:
    """Return whether the recording is one of glasses: it has motion sensors, as columns or as names of sensors."""
    if any(column.name.startswith(_MOTION) or column.unit.startswith("hucs") for column in file.columns):
        return True
    sensor = file.find("sensor")
    return any(cell(row, sensor).casefold().startswith(_MOTION) for row in file.first_rows(_FIRST_ROWS))


def _samples(file: TextFile, columns: _Columns, named: bool, notes: list[str]) -> Iterator[_Sample]:
    """Yield the rows of the eye tracker: by the sensor's name, or those with gaze or validity."""
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
    """Return the combined gaze point, or the mean of both eyes [px]."""
    if None not in columns.both:
        return number(cell(row, columns.both[0])), number(cell(row, columns.both[1]))
    return both((number(cell(row, x)), number(cell(row, y))) for x, y in (columns.left, columns.right))


def _choose_clock(file: TextFile, clocks: tuple[Column, ...], times: Floats, notes: list[str]) -> tuple[int, float]:
    """Return the clock that most rows have, the first on a tie, and its scale to seconds."""
    chosen = int(np.argmax(np.isfinite(times).sum(axis=0)))
    clock = clocks[chosen]
    if clock.unit:
        return chosen, seconds_per(file, clock)
    unit = unit_by_steps(times[:, chosen])
    notes.append(f"{clock.title} has no unit: {unit} inferred from its steps")
    return chosen, TIME_UNITS[unit]


def _used(columns: _Columns, chosen: int) -> tuple[str, ...]:
    gaze = columns.both if None not in columns.both else (*columns.left, *columns.right)
    used = (columns.clocks[chosen], columns.sensor, *gaze, *columns.validity)
    return tuple(column.title for column in used if column is not None)
