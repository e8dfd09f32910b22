"""BIDS eye tracking: a table without header, `..._physio.tsv.gz`, with a JSON sidecar that names the columns.

    {"SamplingFrequency": 500, "StartTime": 0, "Columns": ["timestamp", "x_coordinate", "y_coordinate", "pupil_size"],
     "PhysioType": "eyetrack", "x_coordinate": {"Units": "pixel"}, "timestamp": {"Units": "ms"}}

StartTime is the time of the first sample on the clock of the events' onsets. Without a time column, sample k has the
time StartTime + k / SamplingFrequency. The events' JSON sidecar (`StimulusPresentation`), if present in the same
folder, gives size and origin of the screen. "n/a" means missing.
"""

import json
import math
from collections.abc import Iterator, Mapping
from itertools import count, islice
from pathlib import Path
from typing import NamedTuple, cast

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.fields import is_number
from higvf_interfaces.formats.clock import unit_by_steps
from higvf_interfaces.formats.records import BOTTOM_LEFT, TOP_LEFT, GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, TextFile, number

NAME = "bids"
TITLE = "BIDS eye tracking (tsv.gz or tsv, with its JSON beside it)"
_TIMES = ("timestamp", "eye1_timestamp", "time")
_FRAMES = {"pixel": "screen", "pixels": "screen", "px": "screen", "normalized": "unit"}
_LONG_UNITS = {"seconds": "s", "second": "s", "milliseconds": "ms", "microseconds": "μs", "nanoseconds": "ns"}
_LARGEST = 1_000_000  # maximum size of a sidecar [bytes]
_FIRST_ROWS = 2000


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
        InputError: If the sidecar or its gaze columns are missing, there are neither times nor a sampling frequency, or
            StartTime is not a number.
    """
    sidecar = _sidecar(file.path)
    table = _table(sidecar) if sidecar is not None else None
    if table is None:
        raise InputError(
            f'{file.path}: a BIDS table has no header; put {_stem(file.path)}.json beside it, whose "Columns" include '
            "x_coordinate and y_coordinate"
        )
    notes: list[str] = []
    times, start = _times(file, table, notes), table.sidecar.get("StartTime", 0)
    if not is_number(start):
        raise InputError(f"{file.path}: StartTime in its JSON is not a number of seconds")
    units = _text(table.sidecar.get(table.columns[table.x]), "Units") or _text(table.sidecar, "SampleCoordinateUnits")
    screen, origin = _presentation(file.path)

    def rows() -> Iterator[Row]:
        for cells in _cells(file, table, notes):
            yield times(cells), number(cells[table.x]), number(cells[table.y]), True, math.nan

    used = [table.columns[place] for place in (table.time, table.x, table.y) if place is not None]
    return GazeStream(
        format=NAME,
        columns=tuple(used),
        frame=_FRAMES.get(units.casefold()),
        blocks=blocks_of(rows()),
        notes=notes,
        origin=origin,
        screen=screen,
        start=float(start),
        in_step=True,
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
    if unit not in TIME_UNITS:
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
    if path.name == _stem(path) or path.suffix == ".json":
        return None
    return _json(path.with_name(_stem(path) + ".json"))


def _presentation(path: Path) -> tuple[tuple[float, float] | None, str]:
    """Return size [px] and origin of the screen from the events' JSON sidecar."""
    entities = _stem(path).rsplit("_", 1)[0]
    for name in (entities + "_events.json", entities.split("_recording-")[0] + "_events.json"):
        found = (_json(path.with_name(name)) or {}).get("StimulusPresentation")
        if isinstance(found, dict):
            shown = cast(dict[str, object], found)
            corner = " ".join(map(str, cast(list[object], shown["ScreenOrigin"]))) if _listed(shown, 2) else TOP_LEFT
            size = shown.get("ScreenResolution")
            sides = [float(s) for s in cast(list[object], size) if is_number(s)] if isinstance(size, list) else []
            screen = (sides[0], sides[1]) if len(sides) == 2 and min(sides) >= 1 else None
            return screen, BOTTOM_LEFT if corner.casefold() == BOTTOM_LEFT else TOP_LEFT
    return None, TOP_LEFT


def _listed(mapping: Mapping[str, object], length: int) -> bool:
    value = mapping.get("ScreenOrigin")
    return isinstance(value, list) and len(cast(list[object], value)) == length


def _text(mapping: object, key: str) -> str:
    value = cast(dict[str, object], mapping).get(key, "") if isinstance(mapping, dict) else ""
    return value if isinstance(value, str) else ""


def _stem(path: Path) -> str:
    return path.name.removesuffix(".gz").removesuffix(".tsv")


def _json(path: Path) -> Mapping[str, object] | None:
    try:
        if path.stat().st_size > _LARGEST:
            return None
        content: object = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    return cast(dict[str, object], content) if isinstance(content, dict) else None
