"""Gaze streams of XDF files (LabRecorder, Lab Streaming Layer).

The stream is the only one of type Gaze, or the one that `stream=` selects. All streams of a file share one clock, whose
time 0 is the earliest sample of any stream. The channels are found by their labels, or selected by `x=` and `y=`
(labels or numbers from 1). Their units and coordinate systems give the frame: pixels are those of a screen, or of a
scene camera if the coordinate system is `world`. Live streams are described by the same function. Unlike other formats,
XDF is loaded whole.
"""

import re
from collections.abc import Iterator
from typing import NamedTuple
from xml.etree import ElementTree as ET

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.coordinates import Coordinates, stated_frame
from higvf_interfaces.formats.records import (
    BLOCK,
    BOTTOM_LEFT,
    TOP_LEFT,
    Doubt,
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


_DESCRIBED = ("label", "unit", "coordinate_system")


class GazeChannels(NamedTuple):
    """The gaze channels of a stream.

    Attributes:
        labels: labels of all channels; empty where missing.
        x: index of the channel of x.
        y: index of the channel of y.
        confidence: index of the channel of the confidence; None without one.
        frame: as in `GazeRecording`.
        origin: as in `GazeRecording`.
        doubts: statements about the coordinates that are not understood.
        notes: assumptions.
    """

    labels: list[str]
    x: int
    y: int
    confidence: int | None
    frame: str | None
    origin: str
    doubts: tuple[Doubt, ...]
    notes: list[str]


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
    channels = gaze_channels(str(file.path), chosen.header, chosen.info.channels, wanted.x, wanted.y)
    labels, x, y, confidence = channels.labels, channels.x, channels.y, channels.confidence
    if chosen.texts:
        raise InputError(f"{file.path}: stream {chosen.info.name!r} holds text, not numbers")
    samples = load(file.path, chosen, found, sampled=True)
    values = floats(samples.values)
    start = _first(samples.time) - samples.earliest
    truncated = ["the file is truncated: only its readable part is used"] if found.truncated else []
    return GazeStream(
        format=NAME,
        columns=tuple(labels[place] or f"channel {place + 1}" for place in (x, y, confidence) if place is not None),
        frame=channels.frame,
        blocks=_blocks(samples.time, values[:, [x, y]], None if confidence is None else values[:, confidence]),
        notes=[*truncated, *samples.notes, *channels.notes],
        origin=channels.origin,
        start=start,
        in_step=True,
        has_confidence=confidence is not None,
        streams=tuple(stream.info for stream in found.streams),
        doubts=channels.doubts,
    )


def gaze_channels(place: str, header: ET.Element, count: int, x: str | None, y: str | None) -> GazeChannels:
    """Find the gaze channels in the header of a stream, recorded or live, and what it states about their coordinates.

    Args:
        place: prefix of error messages.
        header: XML header of the stream.
        count: number of channels.
        x: label or number from 1 of the channel of x; None to use the labels.
        y: likewise of y.

    Raises:
        InputError: If the channels are unknown, or only one option is given; the message lists the channels.
    """
    texts = {key: [text.casefold() for text in channel_texts(header, key, count)] for key in _DESCRIBED}
    labels = [re.sub(r"[\s-]+", "_", label) for label in texts["label"]]
    left, right, origin = point_channels(place, labels, x, y)
    units, systems = ([texts[key][axis] for axis in (left, right)] for key in ("unit", "coordinate_system"))
    stated = stated_frame(units, systems)
    if origin == BOTTOM_LEFT and stated in (Coordinates(None), Coordinates("unit")) and not any(systems):
        stated = Coordinates("scene-unit")  # Pupil Capture's usual gaze
    unused = [label for label in labels if "valid" in label]
    notes = [f"channels {', '.join(unused)[:200]} are not used: only a channel confidence is"] if unused else []
    return GazeChannels(
        labels=labels,
        x=left,
        y=right,
        confidence=labels.index("confidence") if "confidence" in labels else None,
        frame=stated.frame,
        origin=origin,
        doubts=stated.doubts,
        notes=notes,
    )


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
        left, right = _place(place, labels, x, "x"), _place(place, labels, y, "y")
        return left, right, next((o for a, b, o in _LABELS if (a, b) == (labels[left], labels[right])), TOP_LEFT)
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
