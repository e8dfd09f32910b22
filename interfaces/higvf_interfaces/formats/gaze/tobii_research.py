"""Tables of the Python SDK `tobii_research` and of Titta: the keys of the callback as columns, validity 1 = valid.

A point is one cell, "(0.51, 0.43)", as pandas writes a tuple, or two columns with suffixes such as `_x` and `_y`.
Coordinates are fractions of the display area, origin top left.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.gaze.binocular import NO_EYE, Eye, both, says_yes
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import Column, TextFile, cell, number

NAME = "tobii-research"
TITLE = "table of tobii_research gaze data (validity 1 = valid)"
_CLOCKS = ("device_time_stamp", "system_time_stamp")
_POINT = "{}_gaze_point_on_display_area"
_VALIDITIES = ("{}_gaze_point_validity", "{}_gaze_point_valid")  # of the SDK; of Titta since 2
_AVAILABLE = "{}_gaze_point_available"  # of Titta
_ENDINGS = (("",), ("_x", "_y"), ("_0", "_1"), ("[0]", "[1]"), (".x", ".y"), (" x", " y"))


class _EyeColumns(NamedTuple):
    points: tuple[Column, ...]  # one column of pairs, or two columns
    validity: tuple[Column, ...]  # all must mean valid


def matches(file: TextFile) -> bool:
    """Return whether the header has a time stamp and a gaze point of the SDK."""
    return file.find(*_CLOCKS) is not None and _find_eyes(file) != ()


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the table.

    Raises:
        InputError: If the time stamp or the gaze points are missing.
    """
    clock, eyes = file.find(*_CLOCKS), _find_eyes(file)
    if clock is None or not eyes:
        raise InputError(
            f"{file.path}: no {_CLOCKS[0]} or no left_gaze_point_on_display_area, in one column or as _x and _y; "
            f"has: {file.titles}"
        )
    unjudged = [eye.points[0].title for eye in eyes if not eye.validity]
    notes = [f"no validity column beside {title}: its gaze is valid where it is a number" for title in unjudged]

    def rows() -> Iterator[Row]:
        for row in file.rows(notes):
            x, y = both(_eye(file, row, eye) for eye in eyes)
            yield number(cell(row, clock)) * 1e-6, x, y, True, math.nan

    used = [clock, *(column for eye in eyes for column in (*eye.points, *eye.validity))]
    return GazeStream(NAME, tuple(column.title for column in used), "unit", blocks_of(rows()), notes)


def _find_eyes(file: TextFile) -> tuple[_EyeColumns, ...]:
    eyes: list[_EyeColumns] = []
    for side in ("left", "right"):
        point = _POINT.format(side)
        judged = (file.find(*(name.format(side) for name in _VALIDITIES)), file.find(_AVAILABLE.format(side)))
        validity = tuple(column for column in judged if column is not None)
        pairs = ([_titled(file, point + end) for end in ending] for ending in _ENDINGS)
        for pair in pairs:
            found = tuple(column for column in pair if column is not None)
            if found and len(found) == len(pair):
                eyes.append(_EyeColumns(found, validity))
                break
    return tuple(eyes)


def _titled(file: TextFile, title: str) -> Column | None:
    """Return the column with exactly this title; a suffix such as `[0]` is not a unit here."""
    return next((column for column in file.columns if column.title.casefold() == title), None)


def _eye(file: TextFile, row: list[str], eye: _EyeColumns) -> Eye:
    if not all(says_yes(file, row, column) for column in eye.validity):
        return NO_EYE
    texts = [cell(row, column) for column in eye.points]
    if len(texts) == 1:
        texts = texts[0].strip("()[] ").split(",")
    return (number(texts[0].strip()), number(texts[1].strip())) if len(texts) == 2 else NO_EYE
