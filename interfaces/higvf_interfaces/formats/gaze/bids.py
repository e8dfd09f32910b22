"""BIDS eye tracking: a table without header, `..._physio.tsv.gz`, with a JSON sidecar that names the columns.

    {"SamplingFrequency": 500, "StartTime": 0, "Columns": ["timestamp", "x_coordinate", "y_coordinate", "pupil_size"],
     "PhysioType": "eyetrack", "x_coordinate": {"Units": "pixel"}, "timestamp": {"Units": "ms"}}

StartTime is the time of the first sample on the clock of the events' onsets. Without a time column, sample k has the
time StartTime + k / SamplingFrequency. The events' JSON sidecar (`StimulusPresentation`) gives size and origin of the
screen. Sidecars are inherited from the folders above. "n/a" means missing.
"""

import math
from collections.abc import Iterator, Mapping
from itertools import count, islice
from pathlib import Path
from typing import NamedTuple, cast

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.fields import is_number
from higvf_interfaces.formats.bids_files import merged_json, stem_of
from higvf_interfaces.formats.clock import unit_by_steps
from higvf_interfaces.formats.coordinates import stated_frame, stated_origin
from higvf_interfaces.formats.records import TOP_LEFT, Doubt, GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, TextFile, number

NAME = "bids"
TITLE = "BIDS eye tracking (tsv.gz or tsv, with its JSON beside it)"
_TIMES = ("timestamp", "eye1_timestamp", "time")
_LONG_UNITS = {"seconds": "s", "second": "s", "milliseconds": "ms", "microseconds": "μs", "nanoseconds": "ns"}
_FIRST_ROWS = 2000


class _Presentation(NamedTuple):
    """Size [px] and origin of the screen, and the statements that are not understood."""

    screen: tuple[float, float] | None = None
    origin: str = TOP_LEFT
    doubts: tuple[Doubt, ...] = ()


class _Table(NamedTuple):
    columns: tuple[str, ...]
    x: int
    y: int
    time: int | None
    sidecar: Mapping[str, object]


def matches(file: TextFile) -> bool:
    """Return whether the file has a JSON sidecar with gaze columns."""
    sidecar = _sidecar(file.path)
    return sidecar is not None and _table(sidecar) is not None


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the table.

    Raises:
        InputError: If the sidecar or its gaze columns are missing, there are neither times nor a sampling frequency,
            the unit of time is unknown, or StartTime is not a number.
    """
    sidecar = _sidecar(file.path)
    table = _table(sidecar) if sidecar is not None else None
    if table is None:
        raise InputError(
            f"{file.path}: a BIDS table has no header; put {stem_of(file.path)}.json beside it, whose "
            '"Columns" include x_coordinate and y_coordinate'
        )
    notes: list[str] = []
    times, start = _times(file, table, notes), table.sidecar.get("StartTime", 0)
    if not is_number(start):
        raise InputError(f"{file.path}: StartTime in its JSON is not a number of seconds")
    common = _text(table.sidecar, "SampleCoordinateUnits")
    units = [_text(table.sidecar.get(table.columns[axis]), "Units") or common for axis in (table.x, table.y)]
    stated = stated_frame(units, [_text(table.sidecar, "SampleCoordinateSystem")])
    screen, origin, doubts = _presentation(file.path)

    def rows() -> Iterator[Row]:
        for cells in _cells(file, table, notes):
            yield times(cells), number(cells[table.x]), number(cells[table.y]), True, math.nan

    used = [table.columns[place] for place in (table.time, table.x, table.y) if place is not None]
    return GazeStream(
        format=NAME,
        columns=tuple(used),
        frame=stated.frame,
        blocks=blocks_of(rows()),
        notes=notes,
        origin=origin,
        screen=screen,
        start=float(start),
        in_step=True,
        doubts=(*stated.doubts, *doubts),
    )


def _times(file: TextFile, table: _Table, notes: list[str]) -> "_Times":
    """Return the source of the row times: the time column, or the row count."""
    if table.time is None:
        rate = table.sidecar.get("SamplingFrequency")
        if not is_number(rate) or rate <= 0:
            raise InputError(f"{file.path}: its JSON has neither a column timestamp nor a SamplingFrequency in Hz")
        return _Times(None, 1 / float(rate))
    unit = _text(table.sidecar.get(table.columns[table.time]), "Units")
    unit = _LONG_UNITS.get(unit.casefold(), unit)
    if unit and unit not in TIME_UNITS:
        raise InputError(
            f"{file.path}: {unit[:80]!r}, the unit of {table.columns[table.time]} in its JSON, is not a unit of time; "
            f"known units: {', '.join(TIME_UNITS)}"
        )
    if not unit:
        place = table.time
        unit = unit_by_steps(floats([number(c[place]) for c in islice(_cells(file, table, []), _FIRST_ROWS)]))
        notes.append(f"{table.columns[place]} has no unit in the JSON: {unit} inferred from its steps")
    return _Times(table.time, TIME_UNITS[unit])


class _Times:
    """Device times of rows [s], from the column at `place`, or from the row count if `place` is None."""

    def __init__(self, place: int | None, scale: float) -> None:
        """Set the scale: seconds per unit of the column, or per row."""
        self._place, self._scale = place, scale
        self._count = count()

    def __call__(self, cells: list[str]) -> float:
        """Return the time of the next row [s]."""
        if self._place is None:
            return next(self._count) * self._scale
        return number(cells[self._place]) * self._scale


def _cells(file: TextFile, table: _Table, notes: list[str]) -> Iterator[list[str]]:
    """Yield the cells of every line, short lines included, so that they do not shift times from the row count."""
    short = 0
    for line in file.lines(notes, blank=table.time is None):
        cells = line.split("\t")
        whole = len(cells) >= len(table.columns)
        short += not whole
        yield cells if whole else [""] * len(table.columns)
    if short:
        notes.append(f"{short} rows with too few cells: gaze missing")


def _table(sidecar: Mapping[str, object]) -> _Table | None:
    listed = sidecar.get("Columns")
    if not isinstance(listed, list):
        return None
    columns = tuple(str(name) for name in cast(list[object], listed))
    for prefix in ("", "eye1_"):
        x, y = f"{prefix}x_coordinate", f"{prefix}y_coordinate"
        if x in columns and y in columns:
            time = next((columns.index(name) for name in _TIMES if name in columns), None)
            return _Table(columns, columns.index(x), columns.index(y), time, sidecar)
    return None


def _sidecar(path: Path) -> Mapping[str, object] | None:
    if not path.name.endswith((".tsv", ".tsv.gz")):
        return None
    return merged_json(path, stem_of(path).rsplit("_", 1)[-1])


def _presentation(path: Path) -> _Presentation:
    """Return the screen by the events' JSON sidecar."""
    found = (merged_json(path, "events") or {}).get("StimulusPresentation")
    if not isinstance(found, dict):
        return _Presentation()
    shown = cast(dict[str, object], found)
    corner, size = shown.get("ScreenOrigin"), shown.get("ScreenResolution")
    words = ", ".join(map(str, cast(list[object], corner))) if isinstance(corner, list) else str(corner)
    origin, doubts = (TOP_LEFT, ()) if corner is None else stated_origin(words, "ScreenOrigin")
    sides = [float(s) for s in cast(list[object], size) if is_number(s)] if isinstance(size, list) else []
    if len(sides) == 2 and min(sides) >= 1:
        return _Presentation((sides[0], sides[1]), origin, doubts)
    unknown = () if size is None else (Doubt("screen", f"ScreenResolution {str(size)[:60]}"),)  # pyright: ignore[reportUnknownArgumentType]
    return _Presentation(None, origin, (*doubts, *unknown))


def _text(mapping: object, key: str) -> str:
    value = cast(dict[str, object], mapping).get(key, "") if isinstance(mapping, dict) else ""
    return value if isinstance(value, str) else ""
