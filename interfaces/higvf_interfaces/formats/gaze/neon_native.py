"""Recording folders of Pupil Labs Neon and Invisible: binary samples, their times, and text files with the data types.

    gaze ps1.raw    x, y, typed by gaze.dtype (default two float32): pixels of the scene camera, origin top left
    gaze ps1.time   one int64 per sample: nanoseconds since 1970; further parts are numbered ps2, ps3, ...
    blinks ps1.raw  records with start_timestamp_ns and end_timestamp_ns, typed by blinks.dtype
    worn ps1.raw    one byte per sample: 0 = not worn

Gaze stays finite during blinks, so the listed blinks are cut.
"""

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Bools, bools, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import BLOCK, GazeBlock, GazeStream, Wanted, block_of
from higvf_interfaces.formats.text import TextFile

NAME = "neon-native"
TITLE = "recording folder of Pupil Labs Neon or Invisible (gaze ps1.raw, gaze ps1.time)"
_GAZE = np.dtype([("x", "<f4"), ("y", "<f4")])
_NANOSECONDS = np.dtype("<i8")
_WORN = np.dtype("u1")
_SCENES = {"module_serial_number": (1600.0, 1200.0), "scene_camera_serial_number": (1088.0, 1080.0)}  # Neon, Invisible


class _Part(NamedTuple):
    raw: Path
    time: Path
    worn: Path | None
    samples: int


def matches(file: TextFile) -> bool:
    """Return whether the path is a folder with raw gaze files."""
    return not file.head and file.path.is_dir() and bool(_raw_files(file.path))


def stream(file: TextFile, _: Wanted) -> GazeStream:
    """Open the recording.

    Raises:
        InputError: If the path is not such a folder, or its gaze, times or data types are missing or invalid.
    """
    folder = file.path
    if not matches(file):
        raise InputError(f"{folder}: is not a folder with 'gaze ps1.raw' and 'gaze ps1.time'; give the folder itself")
    try:
        types = _types(folder / "gaze.dtype", _GAZE)
        if not {"x", "y"} <= set(types.names or ()):
            raise InputError(f"{folder / 'gaze.dtype'}: has no x and y; has: {', '.join(types.names or ())}")
        notes: list[str] = []
        parts = [_part(raw, types, notes) for raw in _raw_files(folder)]
        if not sum(part.samples for part in parts):
            raise InputError(f"{folder}: the gaze files are empty")
        blinks = _blinks(folder, notes)
        epoch = int(next(np.fromfile(part.time, _NANOSECONDS, 1)[0] for part in parts if part.samples))
        screen = _scene(folder)
    except OSError as problem:
        raise InputError(f"{folder}: cannot be read: {problem}") from problem
    return GazeStream(
        format=NAME,
        columns=tuple(path.name for part in parts for path in part[:3] if path is not None),
        frame="scene",
        blocks=_blocks(parts, types, blinks, epoch),
        notes=notes,
        screen=screen,
        epoch=epoch * 1e-9,
    )


def _raw_files(folder: Path) -> list[Path]:
    numbered = [(re.fullmatch(r"gaze ps(\d{1,6})\.raw", path.name), path) for path in folder.glob("gaze ps*.raw")]
    return [path for _, path in sorted((int(match[1]), path) for match, path in numbered if match)]


def _part(raw: Path, types: np.dtype[Any], notes: list[str]) -> _Part:
    time, worn = raw.with_suffix(".time"), raw.with_name(raw.name.replace("gaze", "worn"))
    if not time.is_file():
        raise InputError(f"{raw}: the file of its time stamps, {time.name}, is missing")
    points, times = raw.stat().st_size / types.itemsize, time.stat().st_size / _NANOSECONDS.itemsize
    samples = int(min(points, times))
    if points != times:
        notes.append(f"{raw.name} is cut off: {points:g} points for {times:g} times, {samples} used")
    complete = worn.is_file() and worn.stat().st_size >= samples
    return _Part(raw, time, worn if complete else None, samples)


def _blocks(parts: list[_Part], types: np.dtype[Any], blinks: NDArray[np.int64], epoch: int) -> Iterator[GazeBlock]:
    try:
        for part in parts:
            for first in range(0, part.samples, BLOCK):
                count = min(BLOCK, part.samples - first)
                gaze = np.fromfile(part.raw, types, count, offset=first * types.itemsize)
                time = np.fromfile(part.time, _NANOSECONDS, count, offset=first * _NANOSECONDS.itemsize)
                count = min(len(gaze), len(time))
                valid = ~_shut(time[:count], blinks)
                if part.worn is not None:
                    valid &= np.fromfile(part.worn, _WORN, count, offset=first) > 0
                with np.errstate(invalid="ignore"):  # damaged data may contain signalling NaNs
                    points = np.stack([gaze["x"][:count], gaze["y"][:count]], axis=1).astype(np.float64)
                points[~np.isfinite(points)] = np.nan
                yield block_of(floats((time[:count] - epoch) * 1e-9), floats(points), bools(valid))
    except (OSError, ValueError) as problem:
        raise InputError(f"{parts[0].raw.parent}: cannot be read: {problem}") from problem


def _shut(time: NDArray[np.int64], blinks: NDArray[np.int64]) -> Bools:
    """Return whether each time (n,) lies in one of the ordered blinks (k, 2)."""
    latest = np.searchsorted(blinks[:, 0], time, side="right") - 1
    return bools((latest >= 0) & (time <= blinks[latest, 1])) if len(blinks) else np.zeros(len(time), dtype=np.bool_)


def _blinks(folder: Path, notes: list[str]) -> NDArray[np.int64]:
    """Return starts and ends of the blinks (k, 2) [ns], in order of time; the ends are made non-decreasing."""
    usual = np.dtype([("event_type", "<i4"), ("start_timestamp_ns", "<i8"), ("end_timestamp_ns", "<i8")])
    types = _types(folder / "blinks.dtype", usual)
    files = sorted(folder.glob("blinks ps*.raw"))
    if not files or not {"start_timestamp_ns", "end_timestamp_ns"} <= set(types.names or ()):
        notes.append("no list of blinks in the folder: blinks are not cut")
        return np.zeros((0, 2), dtype=np.int64)
    found = np.concatenate([np.fromfile(path, types) for path in files])
    pairs = np.stack([found["start_timestamp_ns"], found["end_timestamp_ns"]], axis=1).astype(np.int64)
    pairs = pairs[np.argsort(pairs[:, 0], kind="stable")]
    pairs[:, 1] = np.maximum.accumulate(pairs[:, 1]) if len(pairs) else pairs[:, 1]
    notes.append(f"{len(pairs)} blinks listed by the device cut")
    return pairs


def _types(path: Path, usual: np.dtype[Any]) -> np.dtype[Any]:
    """Return the data types in a .dtype file, or `usual` if there is no such file."""
    if not path.is_file():
        return usual
    try:
        named = ast.literal_eval(path.read_text(encoding="utf-8").strip())
        types = np.dtype([(str(name), str(kind)) for name, kind in named])
    except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError) as problem:
        raise InputError(f"{path}: is not a list of (name, type): {problem}") from problem
    if not types.itemsize or types.hasobject or any(types[name].kind not in "iuf" for name in types.names or ()):
        raise InputError(f"{path}: has other types than numbers: {types}")
    return types


def _scene(folder: Path) -> tuple[float, float] | None:
    """Return the image size of the scene camera [px] by the device's model, or None if unknown."""
    try:
        info: object = json.loads((folder / "info.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    known = cast(dict[str, object], info) if isinstance(info, dict) else {}
    return next((size for key, size in _SCENES.items() if known.get(key)), None)
