"""Tables of Tobii Studio, E-Prime and Tobii SDKs before 3, with validity codes from 0 (found) to 4 (lost).

Low codes mean good data, the opposite of later SDKs. A missing point is -1 and must not enter the mean of both eyes.
Codes from 2 may belong to the other eye; like Tobii's own filters, the reader treats them as missing. An export without
the points of the eyes has their combined one, `GazePointX (ADCSpx)`, which is valid if that of one eye is.
"""

import math
from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import unit_by_steps
from higvf_interfaces.formats.gaze.binocular import NO_EYE, Eye, both
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, Column, TextFile, cell, number, seconds_per

NAME = "tobii-old"
TITLE = "Tobii Studio, E-Prime or old Tobii SDK table (validity 0 to 4)"
_FOUND = 1  # highest validity code accepted
_MISSING = -1.0
_PIXELS = ("adcspx", "adcs px", "px", "pixels", "")
_FIRST_ROWS = 2000
_TIMES = ("eyetrackertimestamp", "time", "recordingtimestamp", "tettime", "timestamp")
_DIALECTS = (
    ("unit", "{0}gazepos2dx", "{0}gazepos2dy", "{0}validity", ("l", "r")),  # SDK
    ("unit", "xgazepos{0}eye", "ygazepos{0}eye", "validity{0}eye", ("left", "right")),  # E-Prime
    ("screen", "gazepoint{0}x", "gazepoint{0}y", "validity{0}", ("left", "right")),  # Studio 3
    ("screen", "gazepointx{0}", "gazepointy{0}", "validity{0}", ("left", "right")),  # Studio 2
)
_COMBINED = ("gazepointx", "gazepointy")  # Studio
_SYSTEMS = ("adcs", "mcs")  # coordinate systems by which Studio is known


class _EyeColumns(NamedTuple):
    x: Column
    y: Column
    validity: tuple[Column, ...]  # one must mean found; none if the export has none


def matches(file: TextFile) -> bool:
    """Return whether the header has a time, and gaze point and validity of an eye in one of the dialects."""
    return file.find(*_TIMES) is not None and _find_eyes(file)[1] != ()


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the table.

    Raises:
        InputError: If the time, or an eye with point and validity, is missing.
    """
    frame, eyes = _find_eyes(file)
    clocks = [column for column in (file.find(name) for name in _TIMES) if column is not None]
    if not eyes:
        raise InputError(
            f"{file.path}: no gaze columns (LGazePos2dx, LGazePos2dy and LValidity; GazePointLeftX, GazePointLeftY and "
            f"ValidityLeft; or GazePointX (ADCSpx) and GazePointY (ADCSpx)); has: {file.titles}"
        )
    if not clocks:
        raise InputError(f"{file.path}: no time column (one of {', '.join(_TIMES)}); has: {file.titles}")
    odd = next((eye.x for eye in eyes if frame == "screen" and eye.x.unit not in _PIXELS), None)
    if odd is not None:
        raise InputError(
            f"{file.path}: {odd.title} is in {odd.unit[:20]!r}, not in pixels of the screen; include the columns in "
            "ADCSpx in the export"
        )
    judged = all(eye.validity for eye in eyes)
    notes = [] if judged else ["no validity columns: every sample with coordinates counts as valid"]
    clock = clocks[0]
    scale = seconds_per(file, clock) if clock.unit else 0.0
    if not scale:
        first = floats([number(cell(row, clock)) for row in islice(file.rows([]), _FIRST_ROWS)])
        unit = unit_by_steps(first)
        scale = TIME_UNITS[unit]
        notes.append(f"{clock.title} has no unit: {unit} inferred from its steps")

    def rows() -> Iterator[Row]:
        for row in file.rows(notes):
            x, y = both(_eye(row, eye) for eye in eyes)
            yield number(cell(row, clock)) * scale, x, y, True, math.nan

    columns = (clock, *(column for eye in eyes for column in (eye.x, eye.y, *eye.validity)))
    return GazeStream(NAME, tuple(column.title for column in columns), frame, blocks_of(rows()), notes)


def _find_eyes(file: TextFile) -> tuple[str, tuple[_EyeColumns, ...]]:
    """Return the frame and the eyes of the first dialect found; the combined point counts as one eye."""
    for frame, x, y, validity, names in _DIALECTS:
        eyes: list[_EyeColumns] = []
        for name in names:
            point, judged = _point(file, x.format(name), y.format(name)), file.find(validity.format(name))
            if point is not None and judged is not None:
                eyes.append(_EyeColumns(*point, (judged,)))
        if eyes:
            return frame, tuple(eyes)
    point = _point(file, *_COMBINED)
    either = tuple(c for c in (file.find(f"validity{eye}") for eye in ("left", "right")) if c is not None)
    if point is not None and (either or point[0].unit.startswith(_SYSTEMS)):
        return "screen", (_EyeColumns(*point, either),)
    return "", ()


def _point(file: TextFile, *names: str) -> tuple[Column, Column] | None:
    """Return the columns of x and y, in pixels if there are such; None if one is missing."""
    x, y = (file.find(name, units=_PIXELS) or file.find(name) for name in names)
    return None if x is None or y is None else (x, y)


def _eye(row: list[str], eye: _EyeColumns) -> Eye:
    x, y = number(cell(row, eye.x)), number(cell(row, eye.y))
    found = not eye.validity or any(0 <= number(cell(row, code)) <= _FOUND for code in eye.validity)
    return (x, y) if found and not x == y == _MISSING else NO_EYE
