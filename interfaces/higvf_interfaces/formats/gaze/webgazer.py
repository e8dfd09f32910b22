"""WebGazer predictions as JSON: a list or lines of `{"x": 512.3, "y": 400.1, "t": 33}`, or the data of jsPsych.

    [{"trial_type": "...", "time_elapsed": 5200, "webgazer_data": [{"x": 512, "y": 400, "t": 12}, ...]}, ...]

`x` and `y` are pixels from the top left corner of the browser's window, whose size is that of the first entry with
`width` and `height`, as written by jsPsych's browser check. `t` is in milliseconds, in jsPsych from the start of its
trial, which ended at `time_elapsed`. A file is loaded whole.
"""

import itertools
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import cast

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.fields import is_number
from higvf_interfaces.formats.clock import unit_by_steps
from higvf_interfaces.formats.records import GazeStream, Row, Wanted, blocks_of
from higvf_interfaces.formats.text import TIME_UNITS, TextFile

NAME = "webgazer-json"
TITLE = "WebGazer JSON (x, y, t, or webgazer_data of jsPsych)"
_TIMES = ("t", "time", "timestamp", "elapsedtime", "elapsed_time")
_DATA = "webgazer_data"
_POINT = re.compile(rb'\{[^{}]*"x"\s*:[^{}]*"y"\s*:[^{}]*\}')
_TIMED = re.compile(rb'"(t|time|timestamp|elapsed_?time)"\s*:', re.IGNORECASE)
_LARGEST = 200_000_000  # bytes

_Object = Mapping[str, object]


def matches(file: TextFile) -> bool:
    """Return whether the first bytes are JSON with gaze points and times, or with `webgazer_data`."""
    head = file.head.lstrip()
    if not head.startswith((b"[", b"{")):
        return False
    point = _POINT.search(head)
    return b'"webgazer_data"' in head or (point is not None and _TIMED.search(point[0]) is not None)


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Load the file.

    Raises:
        InputError: If it is not JSON, too large, or has no gaze points.
    """
    notes: list[str] = []
    content = _content(file, notes)
    rows = [row for entry in content for row in _rows(entry)]
    if not rows:
        raise InputError(f"{file.path}: no object has x, y and one of {', '.join(_TIMES)}")
    unit = unit_by_steps(floats([row[0] for row in rows]))
    if unit != "ms":
        notes.append(f"the times are in {unit} by their steps, not in ms")
    rows = [(row[0] * TIME_UNITS[unit], *row[1:]) for row in rows]
    size = next((size for entry in content if (size := _size(entry)) is not None), None)
    notes.append(
        "x and y are pixels of the browser's window" + ("" if size else "; if it did not fill the screen, give screen=")
    )
    return GazeStream(
        format=NAME, columns=("t", "x", "y"), frame="screen", blocks=blocks_of(rows), notes=notes, screen=size
    )


def _content(file: TextFile, notes: list[str]) -> list[_Object]:
    """Return the objects of a JSON document or of JSON lines."""
    if not file.packed and file.path.stat().st_size > _LARGEST:
        raise InputError(f"{file.path}: is larger than {_LARGEST // 1_000_000} MB; split it")
    lines = list(file.lines(notes))
    try:
        document: object = json.loads("\n".join(lines))
    except (ValueError, RecursionError):
        document = None
    if document is None:
        document, broken = [], 0
        for line in lines:
            try:
                document.append(json.loads(line))  # pyright: ignore[reportUnknownMemberType]
            except (ValueError, RecursionError):
                broken += 1
        if broken:
            notes.append(f"{broken} lines that are not JSON dropped")
    entries = cast(list[object], document if isinstance(document, list) else [document])
    flat = itertools.chain.from_iterable(cast(list[object], e) if isinstance(e, list) else [e] for e in entries)
    return [cast(_Object, entry) for entry in flat if isinstance(entry, dict)]


def _rows(entry: _Object) -> Iterator[Row]:
    """Yield the samples of a trial of jsPsych, or the one of a plain object."""
    data = entry.get(_DATA)
    if isinstance(data, str):
        try:
            data = cast(object, json.loads(data))
        except (ValueError, RecursionError):
            data = []
    if not isinstance(data, list):
        if "x" in entry and "y" in entry:
            yield _row(entry, 0.0)
        return
    samples = [cast(_Object, sample) for sample in cast(Sequence[object], data) if isinstance(sample, dict)]
    lasts = [time for sample in samples if math.isfinite(time := _time(sample))]
    ended, response = _number(entry.get("time_elapsed")), _number(entry.get("rt"))
    begun = ended - max([*lasts, response if math.isfinite(response) else 0.0]) if math.isfinite(ended) else 0.0
    for sample in samples:
        yield _row(sample, begun)


def _row(sample: _Object, begun: float) -> Row:
    x, y = _number(sample.get("x")), _number(sample.get("y"))
    return begun + _time(sample), x, y, True, math.nan


def _time(sample: _Object) -> float:
    """Return the time of a sample [ms]."""
    return next((_number(value) for key, value in sample.items() if key.casefold() in _TIMES), math.nan)


def _number(value: object) -> float:
    return float(value) if is_number(value) and math.isfinite(value) else math.nan


def _size(entry: _Object) -> tuple[float, float] | None:
    width, height = _number(entry.get("width")), _number(entry.get("height"))
    return (width, height) if min(width, height) >= 1 else None
