"""Tobii Pro Lab's tab-separated export: units in the column titles, rows of all sensors interleaved, any locale.

One row a sample of any sensor; those of the eye tracker are kept. Gaze is in pixels of the display ("DACS px"), with
"Valid" or "Invalid" for each eye, and empty cells where there is nothing. Times come from the eye tracker's own clock
where every sample has it: the recording clock is rounded to milliseconds, too coarse for velocities.
"""

from typing import NamedTuple

import numpy as np

from higvf_console.arrays import Floats, bools, floats
from higvf_console.errors import InputError
from higvf_interfaces.formats.records import GazeRecording, gaze_clock
from higvf_interfaces.formats.text import TIME_UNITS, Column, TextFile, cell, number

NAME = "tobii-prolab"
TITLE = "Tobii Pro Lab TSV"
_PIXELS = ("dacs px", "dacspx", "px", "")
_CLOCKS = ("eyetracker timestamp", "recording timestamp", "computer timestamp")


class _Columns(NamedTuple):
    sensor: Column | None
    clocks: tuple[Column, ...]
    both: tuple[Column | None, Column | None]
    left: tuple[Column | None, Column | None]
    right: tuple[Column | None, Column | None]
    validity: tuple[Column | None, Column | None]
    screen: tuple[Column | None, Column | None]


class _Rows(NamedTuple):
    times: list[tuple[float, ...]]
    points: list[tuple[float, float]]
    words: list[tuple[str, str]]
    screen: tuple[float, float] | None


def matches(file: TextFile) -> bool:
    """Whether the header is Pro Lab's."""
    return file.find(*_CLOCKS) is not None and any(column.name.startswith("gaze point") for column in file.columns)


def read(file: TextFile) -> GazeRecording:
    """Reads the eye tracker's rows.

    Raises:
        InputError: no times, no gaze columns in display pixels, or no row of an eye tracker.
    """
    columns = _find_columns(file)
    notes: list[str] = []
    rows = _collect(file, columns, notes, only_tracker=True)
    if not rows.times:
        notes = []
        rows = _collect(file, columns, notes, only_tracker=False)
        notes.append('no row says Sensor "Eye Tracker": rows with gaze or validity taken')
    if not rows.times:
        raise InputError(f"{file.path}: no row comes from an eye tracker")
    seconds, clock_notes = _seconds(columns.clocks, floats(rows.times))
    clock = gaze_clock(file.path, [float(time) for time in seconds], from_first=True)
    points = floats(rows.points)[clock.kept]
    words = [rows.words[row] for row in clock.kept]
    finite = bools(np.isfinite(points).all(axis=1))
    vouched = bools(["valid" in pair for pair in words])
    if not vouched.any() and not any("invalid" in pair for pair in words):
        vouched = finite
        notes.append("no validity words: every sample with coordinates counts as valid")
    notes = [*notes, *clock_notes, *clock.notes]
    return GazeRecording(
        clock.time, points, bools(vouched & finite), None, "screen", rows.screen, clock.epoch, NAME, tuple(notes)
    )


def _find_columns(file: TextFile) -> _Columns:
    def pair(text: str, units: tuple[str, ...] | None) -> tuple[Column | None, Column | None]:
        return file.find(text.format("x"), units=units), file.find(text.format("y"), units=units)

    both, left, right = (pair(f"gaze point {eye}{{}}", _PIXELS) for eye in ("", "left ", "right "))
    if not any(None not in eye for eye in (both, left, right)):
        raise InputError(f"{file.path}: no gaze columns in display pixels (Gaze point X [DACS px]); has: {file.titles}")
    clocks = tuple(clock for clock in map(file.find, _CLOCKS) if clock is not None)
    if not clocks:
        raise InputError(f"{file.path}: no timestamp column (Recording timestamp [ms]); has: {file.titles}")
    return _Columns(
        sensor=file.find("sensor"),
        clocks=clocks,
        both=both,
        left=left,
        right=right,
        validity=(file.find("validity left"), file.find("validity right")),
        screen=(file.find("recording resolution width"), file.find("recording resolution height")),
    )


def _collect(file: TextFile, columns: _Columns, notes: list[str], only_tracker: bool) -> _Rows:
    times: list[tuple[float, ...]] = []
    points: list[tuple[float, float]] = []
    words: list[tuple[str, str]] = []
    screen = None
    for row in file.rows(notes):
        point = _gaze(row, columns)
        left, right = (cell(row, column).casefold() for column in columns.validity)
        if only_tracker and columns.sensor is not None:
            wanted = cell(row, columns.sensor).casefold() == "eye tracker"
        else:
            wanted = bool(left or right) or point[0] == point[0]
        if not wanted:
            continue
        times.append(tuple(number(cell(row, clock)) for clock in columns.clocks))
        points.append(point)
        words.append((left, right))
        if screen is None:
            width, height = (number(cell(row, column)) for column in columns.screen)
            screen = (width, height) if width > 0 and height > 0 else None
    return _Rows(times, points, words, screen)


def _gaze(row: list[str], columns: _Columns) -> tuple[float, float]:
    """The combined gaze point, or what the two eyes' points average to [px]."""
    if None not in columns.both:
        return number(cell(row, columns.both[0])), number(cell(row, columns.both[1]))
    eyes = [(number(cell(row, x)), number(cell(row, y))) for x, y in (columns.left, columns.right)]
    seen = [eye for eye in eyes if eye[0] == eye[0] and eye[1] == eye[1]]
    if not seen:
        return np.nan, np.nan
    return sum(eye[0] for eye in seen) / len(seen), sum(eye[1] for eye in seen) / len(seen)


def _seconds(clocks: tuple[Column, ...], times: Floats) -> tuple[Floats, list[str]]:
    """Times of the first clock that every row has, else of the one that most rows have [s]."""
    counts = np.isfinite(times).sum(axis=0)
    chosen = int(np.argmax(counts))
    clock, raw = clocks[chosen], times[:, chosen]
    if clock.unit in TIME_UNITS:
        return raw * TIME_UNITS[clock.unit], []
    steps = np.diff(raw[np.isfinite(raw)])
    unit = "μs" if len(steps) and np.median(steps) > 500 else "ms"
    return raw * TIME_UNITS[unit], [f"{clock.title} has no unit: taken as {unit} from its steps"]
