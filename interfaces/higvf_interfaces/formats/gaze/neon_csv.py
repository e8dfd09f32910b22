"""Pupil Labs Neon and Invisible CSV tables: gaze in the scene, on a surface, or on a reference image.

Times are nanoseconds since 1970, which exceed the precision of a float, so the first time is subtracted as an integer.
Gaze stays finite during blinks; these are cut by the column "blink id", or else by the table `blinks.csv` in the same
folder. Samples with the tracker not worn are invalid.
"""

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import NamedTuple

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.gaze.binocular import says_yes
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import Column, TextFile, cell, look, number

NAME = "neon-csv"
TITLE = "Pupil Labs Neon or Invisible CSV (gaze in the scene, on a surface or on a reference image)"
BLINKS = "blinks.csv"
_POINTS = (
    ("unit", "gaze position on surface {} [normalized]"),
    ("scene", "gaze position in reference image {} [px]"),
    ("scene", "gaze {} [px]"),
)
_SEEN = ("gaze detected on surface", "gaze detected in reference image", "worn")


class _Columns(NamedTuple):
    time: Column
    x: Column
    y: Column
    seen: tuple[Column, ...]
    blink: Column | None
    frame: str


def matches(file: TextFile) -> bool:
    """Return whether the header has times in nanoseconds and a gaze point in one of the three frames."""
    return _find(file) is not None


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the table.

    Raises:
        InputError: If a column is missing.
    """
    columns = _find(file)
    if columns is None:
        points = ", ".join(title.format("x") for _, title in _POINTS)
        raise InputError(f"{file.path}: needs timestamp [ns] and x and y of one of {points}; has: {file.titles}")
    notes: list[str] = []
    starts, ends = _blinks(file, notes) if columns.blink is None else ((), ())
    first = next((cell(row, columns.time) for row in file.rows([]) if nanoseconds(cell(row, columns.time))), "")
    epoch = nanoseconds(first) or 0

    def rows() -> Iterator[Row]:
        for row in file.rows(notes):
            time = nanoseconds(cell(row, columns.time))
            shut = bool(cell(row, columns.blink)) or _inside(time, starts, ends)
            seen = not shut and all(says_yes(file, row, column) for column in columns.seen)
            seconds = math.nan if time is None else (time - epoch) * 1e-9
            yield seconds, number(cell(row, columns.x)), number(cell(row, columns.y)), seen, math.nan

    used = (columns.time, columns.x, columns.y, *columns.seen, columns.blink)
    return GazeStream(
        format=NAME,
        columns=tuple(column.title for column in used if column is not None),
        frame=columns.frame,
        blocks=blocks_of(rows()),
        notes=notes,
        epoch=epoch * 1e-9,
    )


def nanoseconds(text: str) -> int | None:
    """Parse a count of nanoseconds, exactly if it is an integer; None if invalid."""
    if text.isascii() and text.lstrip("-").isdigit() and len(text) <= 20:
        return int(text)
    value = number(text)
    return int(value) if abs(value) < 1e20 else None


def _find(file: TextFile) -> _Columns | None:
    time = file.find("timestamp", units=("ns",))
    titles = {column.title.strip().casefold(): column for column in file.columns}
    for frame, title in _POINTS:
        x, y = titles.get(title.format("x")), titles.get(title.format("y"))
        if time is not None and x is not None and y is not None:
            seen = tuple(titles[name] for name in _SEEN if name in titles)
            return _Columns(time, x, y, seen, titles.get("blink id"), frame)
    return None


def _blinks(file: TextFile, notes: list[str]) -> tuple[Sequence[int], Sequence[int]]:
    """Return starts and ends of the blinks in `blinks.csv` [ns], in order of time."""
    path = file.path.parent / BLINKS
    if not path.is_file():
        notes.append(f"no column 'blink id' and no {BLINKS} beside the file: blinks are not cut")
        return (), ()
    table = look(str(path))
    start, end = table.find("start timestamp"), table.find("end timestamp")
    pairs: list[tuple[int, int]] = []
    for row in islice(table.rows([]), 1_000_000):
        begun, over = nanoseconds(cell(row, start)), nanoseconds(cell(row, end))
        if begun is not None and over is not None:
            pairs.append((begun, over))
    pairs.sort()
    notes.append(f"{len(pairs)} blinks listed in {BLINKS} cut")
    return [pair[0] for pair in pairs], [pair[1] for pair in pairs]


def _inside(time: int | None, starts: Sequence[int], ends: Sequence[int]) -> bool:
    if time is None or not starts:
        return False
    latest = bisect_right(starts, time) - 1
    return latest >= 0 and time <= ends[latest]
