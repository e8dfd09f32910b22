"""Marker streams of XDF files: plain labels, intervals "0s" ... "0e", or JSON objects with a label."""

import json
from collections.abc import Sequence
from typing import cast

import numpy as np

from higvf_console.core.errors import InputError
from higvf_interfaces.fields import is_number, shown
from higvf_interfaces.formats.command_log import LABELS
from higvf_interfaces.formats.labels import joined_label
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals.records import SignalRequest
from higvf_interfaces.formats.text import TextFile, as_label
from higvf_interfaces.formats.xdf import file as xdf_file
from higvf_interfaces.formats.xdf.samples import cut_off, load

NAME = "xdf-markers"
TITLE = "XDF marker stream (Lab Streaming Layer)"
matches = xdf_file.matches


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:
    """Read the selected marker stream.

    Raises:
        InputError: If the file is not XDF, no marker stream or several match, or the stream is empty.
    """
    found = xdf_file.survey(file.path)
    marks = [stream for stream in found.streams if stream.marks]
    stream = xdf_file.choose(file.path, found.streams, request.stream, marks, "event streams", request.stream_option)
    samples = load(file.path, stream, found)
    times = (samples.time - samples.earliest).tolist()
    given = [decision_of(time, label_of(sample)) for time, sample in zip(times, samples.values, strict=True)]
    decisions = tuple(decision for decision in given if decision is not None)
    if not decisions:
        raise InputError(f"{file.path}: the marker stream {stream.info.name} holds no label")
    notes = (*cut_off(stream, len(times)), *samples.notes, *several_texts(stream.info.channels))
    return CommandLog(decisions, samples.earliest, NAME, notes)


def decision_of(time: float, text: str) -> Decision | None:
    """Parse a marker; a confidence outside [0, 1] is dropped and the label kept; None for an empty marker."""
    try:
        content: object = json.loads(text) if text.startswith("{") else None
    except (ValueError, RecursionError):
        content = None
    if not isinstance(content, dict):
        return Decision(time, text, None) if text else None
    fields = cast(dict[str, object], content)
    label = next((fields[key] for key in LABELS if key in fields), None)
    trust = fields.get("confidence", fields.get("probability"))
    confidence = float(trust) if is_number(trust) and 0 <= trust <= 1 else None
    return Decision(time, known, confidence) if (known := as_label(label)) else None


def label_of(sample: object) -> str:
    """Return a marker as text: all its channels, joined by `/`; of JSON the first channel alone."""
    values = cast(Sequence[object], sample) if isinstance(sample, list | np.ndarray) else [sample]
    texts = [_text(value) for value in values]
    return texts[0] if texts and texts[0].startswith("{") else joined_label(texts)


def several_texts(channels: int) -> list[str]:
    """Return a note if a marker has more than one channel."""
    read = "its label is all of them, joined by /, or the first alone if that is JSON"
    return [f"each marker has {channels} channels: {read}"] if channels > 1 else []


def _text(value: object) -> str:
    if isinstance(value, float | np.floating):
        return as_label(float(value))  # pyright: ignore[reportUnknownArgumentType]
    return as_label(value) if isinstance(value, str) else shown(value)
