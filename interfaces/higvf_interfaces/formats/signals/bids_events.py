"""BIDS event tables (`*_events.tsv`): onset, duration [s] and label of each event.

Events of one trial type that the column `value` tells apart are labelled TRIAL_TYPE/VALUE.
"""

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import ClockNote, event_times, is_time, like_milliseconds
from higvf_interfaces.formats.labels import told_apart
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals.records import SignalRequest
from higvf_interfaces.formats.text import Column, TextFile, as_label, cell, number

NAME = "bids-events"
TITLE = "BIDS events.tsv (onset, duration, trial_type)"
_LABELS = ("trial_type", "event_type", "label", "value", "stim_type")
_VALUE = "value"
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
    onset, sample, confidence = file.find("onset"), file.find("sample"), file.find(*_CONFIDENCES)
    labels = [column for name in _LABELS if (column := file.find(name)) is not None]
    if onset is None or not labels:
        raise InputError(
            f"{file.path}: an events table needs onset and one of {', '.join(_LABELS)}; has: {file.titles}"
        )
    notes: list[str] = []
    events: list[tuple[float, str, str, float | None]] = []
    samples: list[float] = []
    without = 0
    for row in file.rows(notes):
        time, trust = number(cell(row, onset)), number(cell(row, confidence))
        label, kind = _label(row, labels)
        if is_time(time) and label:
            events.append((time, label, kind, trust if 0 <= trust <= 1 else None))
            samples.append(number(cell(row, sample)))
        else:
            without += 1
    if without:
        notes.append(f"{without} events without onset or label dropped")
    if not events:
        raise InputError(f"{file.path}: no event has both an onset and a label")
    named, told = told_apart([(label, kind) for _, label, kind, _ in events], "{label}/{kind}")
    order, times, epoch, repaired = event_times(floats([event[0] for event in events]), from_epoch=False)
    onsets = floats([event[0] for event in events])
    lasts = f"onsets are seconds, as BIDS has it, so that the log lasts {times[-1] - times[0]:.0f} s"
    if len(onsets) > 1 and (onsets == floats(samples)).all():
        notes.append(ClockNote(f"{lasts}; they equal the column sample, so they may be samples"))
    elif like_milliseconds(onsets):
        notes.append(ClockNote(f"{lasts}; they may be milliseconds"))
    decisions = tuple(
        Decision(time, named[row], events[row][3]) for row, time in zip(order.tolist(), times.tolist(), strict=True)
    )
    return CommandLog(decisions, epoch, NAME, (*notes, *told, *repaired))


def _label(row: list[str], columns: list[Column]) -> tuple[str, str]:
    """Return the label, from the first column that has one, and the value that tells it apart, if another column."""
    texts = [(column.name, as_label(cell(row, column))) for column in columns]
    known = [(name, text) for name, text in texts if text.casefold() not in _MISSING]
    name, label = known[0] if known else ("", "")
    return label, next((text for other, text in known if other == _VALUE != name), "")
