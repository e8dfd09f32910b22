"""Plain gaze tables, `time,x,y[,confidence][,valid][,blink]`: a header line, then one row per sample.

The delimiter is comma, semicolon or tab. Times are in seconds unless the title has a unit (`time [ms]`, `time_ms`). x
and y may also be called `gaze_x`, `GazeX`, `eye_x` and the like. Their unit gives the frame (`x [m]` arena, `x [px]` or
`x_px` screen, `x [norm]` unit); without a known one the option `frame` is required.
"""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import unit_by_steps
from higvf_interfaces.formats.coordinates import Coordinates, stated_frame, stated_origin
from higvf_interfaces.formats.gaze.binocular import says_yes
from higvf_interfaces.formats.records import TOP_LEFT, Doubt, GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, Column, TextFile, cell, epoch_seconds, number

NAME = "gaze-csv"
TITLE = "plain gaze CSV (time,x,y[,confidence])"
TIMES = ("time", "timestamp", "t", "time_s", "time_ms", "datetime")
STAMPS = (
    *TIMES, "timestamps", "timestamp_s", "timestamp_ms", "time_stamp", "lsl_timestamp", "lsl_ts", "unix_ts", "lsl time",
)  # fmt: skip
_IN_NAMES = {"time_s": "s", "time_ms": "ms", "timestamp_s": "s", "timestamp_ms": "ms"}  # units
_POINTS = tuple(  # names of x and y, without blanks and signs
    (f"{stem}x{end}", f"{stem}y{end}")
    for stem, end in (
        ("", ""), ("gaze", ""), ("", "gaze"), ("gazepoint", ""), ("gazeposition", ""), ("gazepos", ""), ("eye", ""),
        ("por", ""),
    )
)  # fmt: skip
_SIGNS = re.compile(r"[\W_]+")
_AXIS_UNIT = re.compile(r"[ _](px|pix|pixels?|norm|normali[sz]ed|m|mm|cm|deg)$")  # at the end of a name
_VALIDITIES = ("valid", "is_valid", "gaze_valid", "validity")
_METRES = ("m", "metres", "meters")
_LOOKED_AT = 2000  # rows
_TELLING = 10  # more times than this are needed to infer their unit


def matches(file: TextFile) -> bool:
    """Return whether the header has a time, x and y."""
    return file.find(*STAMPS) is not None and find_point(file) is not None


def find_point(file: TextFile) -> tuple[Column, Column] | None:
    """Return the columns of x and y, with the unit that is joined to a name (`gaze_x_px`) as unit; None without."""
    axes: dict[str, Column] = {}
    for column in file.columns:
        joined = None if column.unit else _AXIS_UNIT.search(column.name)
        name = column.name if joined is None else column.name[: joined.start()]
        axes.setdefault(_SIGNS.sub("", name), column if joined is None else column._replace(unit=joined[1]))
    return next(((axes[x], axes[y]) for x, y in _POINTS if x in axes and y in axes), None)


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the table.

    Raises:
        InputError: If the time, x or y column is missing, a title stands twice, or the unit of time is unknown or
            cannot be seconds.
    """
    time, point_columns = file.find(*STAMPS), find_point(file)
    if time is None:
        raise InputError(f"{file.path}: no time column (one of {', '.join(STAMPS)}); has: {file.titles}")
    if point_columns is None:
        raise InputError(f"{file.path}: no gaze columns (x and y, or gaze_x and gaze_y); has: {file.titles}")
    x, y = point_columns
    confidence, validity, blink = file.find("confidence"), file.find(*_VALIDITIES), file.find("blink")
    file.check_single(time, x, y, confidence, validity, blink)
    if confidence is not None and confidence.unit:
        raise InputError(
            f"{file.path}: the unit {confidence.unit[:40]!r} of the confidence is not understood; write a share from 0 "
            "to 1 under the title confidence"
        )
    seconds = seconds_of(file.path, time)
    if seconds is epoch_seconds:
        _check_steps(file, time)
    stated = Coordinates("arena") if x.unit in _METRES and y.unit in _METRES else stated_frame((x.unit, y.unit))
    origin, doubts = _stated_origin(file)
    assumed = validity is not None and validity.name == "validity"
    notes = [f"{validity.title}: 1 taken as valid, 0 as invalid"] if validity is not None and assumed else []

    def rows() -> Iterator[Row]:
        nowhere = 0  # samples at the origin, which trackers write when they see no eye
        for row in file.rows(notes):
            valid = validity is None or says_yes(file, row, validity, empty=True)
            valid = valid and not (blink is not None and says_yes(file, row, blink))
            point = number(cell(row, x)), number(cell(row, y))
            if point == (0, 0) and stated.frame != "arena":
                nowhere += 1
                valid = False
            yield seconds(cell(row, time)), *point, valid, number(cell(row, confidence))
        if nowhere:
            notes.append(f"{nowhere} samples at exactly 0, 0 taken as lost gaze")

    return GazeStream(
        format=NAME,
        columns=tuple(column.title for column in (time, x, y, confidence, validity, blink) if column is not None),
        frame=stated.frame,
        blocks=blocks_of(rows()),
        notes=notes,
        start=None,
        has_confidence=confidence is not None,
        doubts=(*stated.doubts, *doubts),
        origin=origin,
    )


def seconds_of(path: Path, time: Column | None) -> Callable[[str], float]:
    """Return a function that parses cells of a time column to seconds, by the unit of its title.

    Without a unit, the function is `epoch_seconds`.

    Raises:
        InputError: If the title has an unknown unit of time; the message begins with `path`.
    """
    unit = "" if time is None else _IN_NAMES.get(time.name, time.unit)
    if not unit:
        return epoch_seconds
    if unit not in TIME_UNITS:
        raise InputError(f"{path}: {unit[:80]!r} is not a unit of time; known units: {', '.join(TIME_UNITS)}")
    return lambda text: number(text) * TIME_UNITS[unit]


def _stated_origin(file: TextFile) -> tuple[str, tuple[Doubt, ...]]:
    """Return the origin that a column `origin` states in the first rows, top left without one, and doubts about it."""
    column = file.find("origin")
    words = {cell(row, column) for row in file.first_rows(_LOOKED_AT)} - {""} if column is not None else set[str]()
    return stated_origin(" ".join(sorted(words)), "the column origin") if words else (TOP_LEFT, ())


def _check_steps(file: TextFile, time: Column) -> None:
    """Reject a time column without unit whose time steps cannot be seconds."""
    times = floats([epoch_seconds(cell(row, time)) for row in file.first_rows(_LOOKED_AT)])
    unit = unit_by_steps(times)
    if np.count_nonzero(np.isfinite(times)) > _TELLING and unit != "s":
        raise InputError(
            f"{file.path}: {time.title} has no unit, and its steps are too long for gaze in seconds; write the unit "
            f"into that title, perhaps {time.title} [{unit}]"
        )
