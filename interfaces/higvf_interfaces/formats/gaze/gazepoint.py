"""Gazepoint tables: gaze in fractions of the screen, origin top left.

The last point is repeated while the eyes are lost, so the validity column is required: BPOGV for the best point of
gaze, FPOGV for the point of the fixation. The title of the time column contains the date,
`TIME(2016/11/09 10:05:22.333)`; its cells are in seconds.
"""

import math
from collections.abc import Iterator

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.gaze.binocular import says_yes
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import Column, TextFile, cell, number

NAME = "gazepoint"
TITLE = "Gazepoint table (BPOGX, BPOGY, BPOGV or FPOGX, FPOGY, FPOGV)"
_POINTS = (("bpogx", "bpogy", "bpogv"), ("fpogx", "fpogy", "fpogv"))


def matches(file: TextFile) -> bool:
    """Return whether the header has a time, a gaze point and its validity."""
    return file.find("time") is not None and _find(file) is not None


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the table.

    Raises:
        InputError: If the time, or a gaze point with its validity, is missing.
    """
    time, found = file.find("time"), _find(file)
    if time is None or found is None:
        raise InputError(f"{file.path}: needs TIME and BPOGX, BPOGY, BPOGV or FPOGX, FPOGY, FPOGV; has: {file.titles}")
    x, y, validity = found
    notes: list[str] = []

    def rows() -> Iterator[Row]:
        for row in file.rows(notes):
            point = number(cell(row, x)), number(cell(row, y))
            yield number(cell(row, time)), *point, says_yes(file, row, validity), math.nan

    used = tuple(column.title for column in (time, x, y, validity))
    return GazeStream(NAME, used, "unit", blocks_of(rows()), notes, start=None)


def _find(file: TextFile) -> tuple[Column, Column, Column] | None:
    for names in _POINTS:
        x, y, validity = (file.find(name) for name in names)
        if x is not None and y is not None and validity is not None:
            return x, y, validity
    return None
