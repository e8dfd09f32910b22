"""BIDS event tables (`*_events.tsv`): onset, duration [s] and label of each event."""

import math

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals.records import SignalRequest
from higvf_interfaces.formats.text import Column, TextFile, as_label, cell, number

NAME = "bids-events"
TITLE = "BIDS events.tsv (onset, duration, trial_type)"
_LABELS = ("trial_type", "event_type", "label", "value", "stim_type")
_CONFIDENCES = ("confidence", "probability")
_MISSING = {"", "n/a", "nan"}


def matches(file: TextFile) -> bool:
    """Return whether the header has onset and duration, which BIDS requires."""
    return file.find("onset") is not None and file.find("duration") is not None


def read_markers(file: TextFile, request: SignalRequest) -> CommandLog:  # noqa: ARG001 - needs no options
    """Read the events; `n/a` means missing.

    Raises:
        InputError: If there is no label column, or no event with onset and label.
    """
    onset, confidence = file.find("onset"), file.find(*_CONFIDENCES)
    labels = [column for name in _LABELS if (column := file.find(name)) is not None]
    if onset is None or not labels:
        raise InputError(
            f"{file.path}: an events table needs onset and one of {', '.join(_LABELS)}; has: {file.titles}"
        )
    notes: list[str] = []
    decisions: list[Decision] = []
    without = 0
    for row in file.rows(notes):
        time, label, trust = number(cell(row, onset)), _label(row, labels), number(cell(row, confidence))
        if math.isfinite(time) and label:
            decisions.append(Decision(time, label, trust if 0 <= trust <= 1 else None))
        else:
            without += 1
    if without:
        notes.append(f"{without} events without onset or label dropped")
    if not decisions:
        raise InputError(f"{file.path}: no event has both an onset and a label")
    return CommandLog(tuple(sorted(decisions, key=lambda decision: decision.time)), 0.0, NAME, tuple(notes))


def _label(row: list[str], columns: list[Column]) -> str:
    texts = (as_label(cell(row, column)) for column in columns)
    return next((text for text in texts if text.casefold() not in _MISSING), "")
