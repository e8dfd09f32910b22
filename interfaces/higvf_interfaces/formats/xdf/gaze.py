"""Gaze streams of XDF files (LabRecorder, Lab Streaming Layer).

The stream is the only one of type Gaze, or the one that `stream=` selects. All streams of a file share one clock, whose
time 0 is the earliest sample of any stream. The channels are found by their labels, or selected by `x=` and `y=`
(labels or numbers from 1). The unit pixels sets the frame to screen. Unlike other formats, XDF is loaded whole.
"""

import re
from collections.abc import Iterator
from xml.etree import ElementTree as ET

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import (
    BLOCK,
    BOTTOM_LEFT,
    TOP_LEFT,
    GazeBlock,
    GazeStream,
    Wanted,
    block_of,
)
from higvf_interfaces.formats.text import TextFile
from higvf_interfaces.formats.xdf import file as xdf_file
from higvf_interfaces.formats.xdf.file import XdfStream, channel_texts, choose, survey
from higvf_interfaces.formats.xdf.samples import load

NAME = "xdf"
TITLE = "XDF (LabRecorder) with a gaze stream"
TYPES = ("gaze", "eyetracking", "eyetracker", "eye tracking")
_LABELS = (
    ("norm_pos_x", "norm_pos_y", BOTTOM_LEFT),  # Pupil Capture's LSL relay
    ("x", "y", TOP_LEFT),
    ("gaze_x", "gaze_y", TOP_LEFT),
    ("pos_x", "pos_y", TOP_LEFT),
    ("screen_x", "screen_y", TOP_LEFT),
    ("screenx", "screeny", TOP_LEFT),
    ("xpos", "ypos", TOP_LEFT),
)
_PIXELS = ("px", "pixel", "pixels")


matches = xdf_file.matches  # `stream` checks whether the file has a gaze stream


def has_gaze(file: TextFile) -> bool:
    """Return whether an XDF file has a stream of a gaze type.

    Raises:
        InputError: If the file is damaged.
    """
    return any(map(_is_gaze, survey(file.path).streams))


def _is_gaze(stream: XdfStream) -> bool:
    return stream.info.type.strip().casefold() in TYPES


def stream(file: TextFile, wanted: Wanted) -> GazeStream:
    """Load the selected stream.

    Raises:
        InputError: If the file is not XDF or is damaged, no stream or several match, or the gaze channels are unknown.
    """
    found = survey(file.path)
    meant = found.streams if wanted.stream else [stream for stream in found.streams if _is_gaze(stream)]
    what = "streams" if wanted.stream else f"streams of type {' or '.join(TYPES)}"
    chosen = choose(file.path, found.streams, wanted.stream, meant, what)
    labels, units = described_channels(chosen.header, chosen.info.channels)
    x, y, origin = point_channels(str(file.path), labels, wanted.x, wanted.y)
    confidence = labels.index("confidence") if "confidence" in labels else None
    if chosen.texts:
        raise InputError(f"{file.path}: stream {chosen.info.name!r} holds text, not numbers")
    samples = load(file.path, chosen, found, sampled=True)
    values = floats(samples.values)
    start = _first(samples.time) - samples.earliest
    truncated = ["the file is truncated: only its readable part is used"] if found.truncated else []
    return GazeStream(
        format=NAME,
        columns=tuple(labels[place] or f"channel {place + 1}" for place in (x, y, confidence) if place is not None),
        frame=frame_of(units[x], origin),
        blocks=_blocks(samples.time, values[:, [x, y]], None if confidence is None else values[:, confidence]),
        notes=[*truncated, *samples.notes],
        origin=origin,
        start=start,
        in_step=True,
        has_confidence=confidence is not None,
        streams=tuple(stream.info for stream in found.streams),
    )


def frame_of(unit: str, origin: str) -> str | None:
    """Infer the frame from a channel's unit and origin; None if unknown."""
    return "screen" if unit in _PIXELS else "scene-unit" if origin == BOTTOM_LEFT else None


def described_channels(header: ET.Element, count: int) -> tuple[list[str], list[str]]:
    """Return label and unit of each of `count` channels from a stream's XML header; empty where missing."""
    labels, units = ([text.casefold() for text in channel_texts(header, key, count)] for key in ("label", "unit"))
    return [re.sub(r"[\s-]+", "_", label) for label in labels], units


def point_channels(place: str, labels: list[str], x: str | None, y: str | None) -> tuple[int, int, str]:
    """Return the indices of the channels x and y, by the options or the labels, and the origin.

    Raises:
        InputError: If the channels are unknown, or only one option is given; the message begins with `place` and lists
            the channels.
    """
    if (x is None) != (y is None):
        given, missing = ("x", "y") if y is None else ("y", "x")
        raise InputError(f"{place}: {given}= is given without {missing}=; channels: {_listed(labels)}")
    if x is not None and y is not None:
        return _place(place, labels, x, "x"), _place(place, labels, y, "y"), TOP_LEFT
    for left, right, origin in _LABELS:
        if left in labels and right in labels:
            return labels.index(left), labels.index(right), origin
    raise InputError(f"{place}: no channels with known gaze labels; give x= and y=; channels: {_listed(labels)}")


def _place(where: str, labels: list[str], text: str, option: str) -> int:
    key = re.sub(r"[\s-]+", "_", text.strip().casefold())
    if key in labels:
        return labels.index(key)
    number = key.removesuffix(".0")
    if number.isdecimal() and 1 <= int(number[:6]) <= len(labels):
        return int(number[:6]) - 1
    raise InputError(f"{where}: {option}={text[:80]} is not a channel; channels: {_listed(labels)}")


def _listed(labels: list[str]) -> str:
    return ", ".join(f"{place} {label}".rstrip() for place, label in enumerate(labels[:40], start=1))


def _first(time: Floats) -> float:
    """Return the first finite time [s], or 0 without one."""
    return float(next(iter(time[np.isfinite(time)]), 0.0))


def _blocks(time: Floats, points: Floats, confidence: Floats | None) -> Iterator[GazeBlock]:
    for first in range(0, len(time), BLOCK):
        part = slice(first, first + BLOCK)
        known = points[part]
        known[~np.isfinite(known)] = np.nan
        trusted = None if confidence is None else confidence[part]
        yield block_of(time[part], known, np.ones(len(known), dtype=np.bool_), trusted)
