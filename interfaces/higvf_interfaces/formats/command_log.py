"""Command logs: CSV tables `time,label[,confidence]`, or JSON lines with the same keys.

A log without times is rejected unless the period between entries is given.
"""

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple, cast

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_interfaces.fields import is_number, shown
from higvf_interfaces.formats.clock import ClockNote, event_times, is_time, like_days, like_milliseconds
from higvf_interfaces.formats.gaze.plain import TIMES, seconds_of
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.text import TextFile, as_label, cell, epoch_seconds, number, without_unit

CSV_NAME, JSON_NAME = "command-csv", "command-jsonl"
CSV_TITLE = "command log CSV (time,label[,confidence])"
JSON_TITLE = 'command log JSON lines ({"time": 1.5, "label": "fist", "confidence": 0.9})'
LABELS = ("label", "command", "marker", "event")
_RECORDING = "recording"  # key in the first line of the console's own recordings
_POINTS = re.compile(r"\d{1,3}([.,]\d{3})+")  # a fraction, or groups of thousands
_GROUPED = re.compile(r"\d{1,3}(\.\d{3})+,\d+|\d{1,3}(,\d{3})+\.\d+")  # groups of thousands and a fraction
_WAY_OUT = "a log without times needs period=SECONDS"
_GAZE = "this looks like a table of gaze, which the channel gaze reads (gaze=FILE), not like a log of commands"


class _Entry(NamedTuple):
    place: str
    written: object  # time as in the file
    time: float
    label: str
    confidence: object  # as in the file; None or empty means unknown
    has_unit: bool  # whether the file states the unit of the time


def matches_labels(file: TextFile) -> bool:
    """Return whether the header has a label column; a time column is optional."""
    return not matches_jsonl(file) and file.find(*LABELS) is not None


def matches_jsonl(file: TextFile) -> bool:
    """Return whether the first line begins a JSON object."""
    return file.first_line.lstrip().startswith("{")


def read_csv(file: TextFile, period: float | None = None) -> CommandLog:
    """Read a CSV table.

    Args:
        file: file with a header row.
        period: time between rows, for a table without times [s].

    Raises:
        InputError: If a time or label column is missing, no row has both, or a confidence is outside [0, 1].
    """
    time, label, confidence = file.find(*TIMES), file.find(*LABELS), file.find("confidence")
    if time is None and period is None:
        way_out = _GAZE if "gaze" in file.titles.casefold() else _WAY_OUT
        raise InputError(f"{file.path}: no time column (one of {', '.join(TIMES)}); {way_out}; has: {file.titles}")
    if label is None:
        raise InputError(f"{file.path}: no label column (one of {', '.join(LABELS)}); has: {file.titles}")
    file.check_single(time, label, confidence)
    seconds = seconds_of(file.path, time)
    entries: list[_Entry] = []
    notes: list[str] = []
    for index, row in enumerate(file.rows(notes), start=1):
        content = as_label(cell(row, label)), cell(row, confidence)
        written = cell(row, time)
        entries.append(_Entry(f"row {index}", written, seconds(written), *content, seconds is not epoch_seconds))
    return _log(file, entries, CSV_NAME, notes, period)


def read_jsonl(file: TextFile, period: float | None = None) -> CommandLog:
    """Read JSON lines; lines that are not objects, such as a truncated last line, are dropped with a note.

    Args:
        file: file with one object per line.
        period: time between lines, for a log without times [s].

    Raises:
        InputError: If no line has a time and a label, a confidence is outside [0, 1], or the file is a recording of the
            console.
    """
    broken: list[int] = []
    entries = list(_objects(file, broken))
    notes = [f"{len(broken)} lines that are not JSON objects dropped, first: line {broken[0]}"] if broken else []
    return _log(file, entries, JSON_NAME, notes, period)


def _objects(file: TextFile, broken: list[int]) -> Iterator[_Entry]:
    for index, line in enumerate(file.lines(blank=True), start=1):
        if not line.strip():
            continue
        try:
            entry: object = json.loads(line)
        except (ValueError, RecursionError):
            entry = None
        if not isinstance(entry, dict):
            broken.append(index)
            continue
        fields = cast(dict[str, object], entry)
        if _RECORDING in fields and not any(key in fields for key in LABELS):
            raise InputError(f"{file.path}: is a recording of this console; play it with: higvf replay {file.path}")
        label = next((fields[key] for key in LABELS if key in fields), "")
        written = next((fields[key] for key in TIMES if key in fields), "")
        stated = next((key for key in TIMES if key in fields), "") == "time_ms"
        yield _Entry(f"line {index}", written, _time(fields), as_label(label), fields.get("confidence"), stated)


def _time(fields: Mapping[str, object]) -> float:
    """Return the time of an entry [s], a number or a text; NaN if it has none."""
    key = next((key for key in TIMES if key in fields), "")
    value = fields.get(key)
    if key == "time_ms":
        return (number(value) if isinstance(value, str) else _number(value)) * 1e-3
    return epoch_seconds(value.strip()) if isinstance(value, str) else without_unit(_number(value))


def _number(value: object) -> float:
    return float(value) if is_number(value) else math.nan


def _log(file: TextFile, entries: list[_Entry], name: str, notes: list[str], period: float | None) -> CommandLog:
    if not any(is_time(entry.time) for entry in entries):
        if period is None:
            written = next((entry.written for entry in entries if entry.written not in ("", None)), None)
            given = "" if written is None else f"; {shown(written)} is none"
            raise InputError(f"{file.path}: no entry has a time{given}; {_WAY_OUT}")
        entries = [entry._replace(time=number * period) for number, entry in enumerate(entries)]
        notes.append(f"no times in the file: entries spaced by the given period, {period:g} s")
    usable = [entry for entry in entries if is_time(entry.time) and entry.label]
    if not usable:
        raise InputError(f"{file.path}: no entry has both a time and a label")
    _check_numbers(file, usable)
    if len(usable) < len(entries):
        notes.append(f"{len(entries) - len(usable)} entries without time or label dropped")
    order, times, epoch, repaired = event_times(floats([entry.time for entry in usable]), from_epoch=True)
    decisions = tuple(
        Decision(time, usable[row].label, _confidence(file, usable[row]))  # pyright: ignore[reportUnknownArgumentType, reportUnknownMemberType]
        for row, time in zip(order.tolist(), times.tolist(), strict=True)
    )
    if like_milliseconds(floats([number(str(entry.written)) for entry in usable if not entry.has_unit])):
        lasts = f"times without unit are taken as seconds, so that the log lasts {times[-1] - times[0]:.0f} s"
        notes.append(ClockNote(f"{lasts}; if they are milliseconds, call them time_ms"))
    return CommandLog(decisions, epoch, name, (*notes, *repaired))


def _check_numbers(file: TextFile, entries: Sequence[_Entry]) -> None:
    """Refuse times that are dates of a spreadsheet, or in which a point or comma may part thousands or decimals.

    Raises:
        InputError: With the first such time and the way out.
    """
    texts = [str(entry.written).strip() for entry in entries]
    if like_days(floats([number(text) for text in texts])):
        raise InputError(
            f"{file.path}, {entries[0].place}: the time {shown(texts[0])} seems to be a spreadsheet's date (days since "
            "1899); format the column as seconds, or as yyyy-mm-dd hh:mm:ss.000, and export it again"
        )
    parted = next((k for k, text in enumerate(texts) if _POINTS.fullmatch(text)), None)
    if parted is not None and any(_GROUPED.fullmatch(text) for text in texts):
        raise InputError(
            f"{file.path}, {entries[parted].place}: in the time {shown(texts[parted])} the mark may part thousands, as "
            "in other rows, or decimals; export the column without groups of thousands"
        )


def _confidence(file: TextFile, entry: _Entry) -> float | None:
    if entry.confidence in (None, ""):
        return None
    trust = number(entry.confidence) if isinstance(entry.confidence, str) else _number(entry.confidence)
    if not 0 <= trust <= 1:
        raise InputError(
            f"{file.path}, {entry.place}: confidence {shown(entry.confidence)} is not a number from 0 to 1"
        )
    return trust
