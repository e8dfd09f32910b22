"""Signals and markers from text tables, read block by block."""

import math
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import ClockNote
from higvf_interfaces.formats.records import CommandLog, Decision
from higvf_interfaces.formats.signals.records import (
    CHUNK,
    SignalChunk,
    SignalRecord,
    SignalRequest,
    unique_names,
    unused_rate,
)
from higvf_interfaces.formats.signals.sample_clock import SampleClock, estimate_rate
from higvf_interfaces.formats.text import as_label, number, plain

LOWEST_RATE, HIGHEST_RATE = 0.1, 100_000.0  # [Hz]
_HEAD = 4096  # samples from which the rate is estimated
_MODULI = (101, 128, 201, 256)  # of usual sample counters: OpenBCI Ganglion 101 or 201, Cyton 256
_RATES_AGREE = 0.2  # a larger relative difference of the stated rate and that of the stamps is a contradiction
_NEAR = 3  # highest counts that may have been lost where a counter wraps


class SampleTable(NamedTuple):
    """Layout of a text file.

    Attributes:
        path: path of the file.
        format: name of the format.
        rows: function that yields the cells of each row and appends a note on dropped rows.
        channels: column of each channel.
        names: names of the channels in the file.
        units: units of the channels.
        time: column of the time stamps; None if the table has none.
        seconds: function that parses a time stamp [s]; NaN if invalid.
        counter: column of a wrapping sample counter; None if the table has none.
        marker: column that is 0 or empty except at events; None if the table has none.
        rate: rate specified in the file [Hz]; None if unknown.
    """

    path: Path
    format: str
    rows: Callable[[list[str]], Iterator[list[str]]]
    channels: tuple[int, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    time: int | None
    seconds: Callable[[str], float]
    counter: int | None
    marker: int | None
    rate: float | None


class _Block(NamedTuple):
    times: Floats
    rows: list[list[str]]


def table_signals(table: SampleTable, request: SignalRequest) -> SignalRecord:
    """Return the channels of a table as a signal.

    Raises:
        InputError: If the table has no channels or samples, or neither the table nor the request gives times or a rate.
    """
    if not table.channels:
        raise InputError(f"{table.path}: the {table.format} table has no channel column")
    notes: list[str] = []
    rate, epoch = _timing(table, request.rate, notes)

    def chunks() -> Iterator[SignalChunk]:
        del notes[:]
        for block in _blocks(table, rate, request.rate, notes):
            values = [[_cell(row, column) for column in table.channels] for row in block.rows]
            yield SignalChunk(block.times, floats(values, -1, len(table.channels)))

    return SignalRecord(unique_names(table.names), table.units, rate, epoch, table.format, notes, chunks)


def table_markers(table: SampleTable, request: SignalRequest) -> CommandLog:
    """Return the events of the marker column: one decision per change to a value other than 0.

    Raises:
        InputError: If there is no marker column or no event, or the times are unknown.
    """
    notes: list[str] = []
    rate, epoch = _timing(table, request.rate, [])
    decisions: list[Decision] = []
    before = ""
    for block in _blocks(table, rate, request.rate, notes) if table.marker is not None else ():
        for time, row in zip(block.times.tolist(), block.rows, strict=True):
            label = _label(row, table.marker)
            if label and label != before:
                decisions.append(Decision(time, label, None))
            before = label
    if not decisions:
        raise InputError(f"{table.path}: no event is marked in this {table.format} table, so it holds no decisions")
    return CommandLog(tuple(decisions), epoch, table.format, tuple(notes))


def _timing(table: SampleTable, given: float | None, notes: list[str]) -> tuple[float, float]:
    """Return the rate [Hz] and the device time of the first sample [s], from the first block."""
    head = list(islice(_rows(table, notes), _HEAD))
    if not head:
        raise InputError(f"{table.path}: the {table.format} table has no samples")
    stamps = _stamps(table, head)
    measured = estimate_rate(stamps)
    if np.isfinite(measured):
        rate = table.rate if table.rate and _agrees(table.rate, _lossless(table, head, measured)) else measured
    else:
        rate = given or table.rate or measured
    if not LOWEST_RATE <= rate <= HIGHEST_RATE:
        raise InputError(
            f"{table.path}: the file has neither times nor a sampling rate; give rate=HZ (or period=SECONDS), "
            "such as rate=200 for a Myo armband"
        )
    return float(rate), float(stamps[0]) if np.isfinite(stamps[0]) else 0.0


def _lossless(table: SampleTable, head: list[list[str]], measured: float) -> float:
    """Return a rate [Hz] that was measured by rows, with the samples that the counter says were lost."""
    counter = floats([_cell(row, table.counter) for row in head])
    modulus = _modulus(counter) if table.counter is not None else None
    return measured if modulus is None else measured * float(_counted(counter, math.nan, modulus).mean())


def _agrees(stated: float | None, rate: float) -> bool:
    return not stated or abs(rate / stated - 1.0) < _RATES_AGREE


def _rows(table: SampleTable, notes: list[str]) -> Iterator[list[str]]:
    """Yield the cells of the rows; of a file damaged later on, the readable part."""
    readable = False
    try:
        for row in table.rows(notes):
            readable = True
            yield row
    except InputError as problem:
        if not readable:
            raise
        notes.append(f"only the readable part is used: {problem}")


def _blocks(table: SampleTable, rate: float, given: float | None, notes: list[str]) -> Iterator[_Block]:
    clock = SampleClock(rate)
    rows = _rows(table, notes)
    modulus = None
    if table.counter is not None:
        modulus = _modulus(floats([_cell(row, table.counter) for row in islice(_rows(table, []), _HEAD)]))
    lost, last = 0, math.nan
    while block := list(islice(rows, CHUNK)):
        steps = np.ones(len(block))
        if modulus is not None:
            counter = np.array([_cell(row, table.counter) for row in block])
            steps = _counted(counter, last, modulus)
            last, lost = float(counter[-1]), lost + int(steps.sum()) - len(steps)
        times = clock.times(_stamps(table, block), steps)
        advancing = clock.repairs.advancing(times)
        if not advancing.all():
            block = [row for row, kept in zip(block, advancing, strict=True) if kept]
        yield _Block(floats(times[advancing]), block)
    if not _agrees(table.rate, rate):
        notes.append(
            ClockNote(f"the file states {table.rate:g} Hz, its time stamps come at {rate:.4g} Hz: the stamps count")
        )
    if table.time is None:
        how = "the given rate" if given else "the rate in the file"
        notes.append(f"no times in the file: samples spaced by {how}, {rate:g} Hz")
    else:
        notes.extend(unused_rate(given, rate))
    if lost:
        notes.append(f"{lost} samples lost by the radio link")
    notes.extend(clock.repairs.notes)


def _stamps(table: SampleTable, rows: list[list[str]]) -> Floats:
    if table.time is None:
        return np.full(len(rows), np.nan)
    place, seconds = table.time, table.seconds
    return floats([seconds(plain(row[place])) if place < len(row) else np.nan for row in rows])


def _modulus(counter: Floats) -> float | None:
    """Return the count (n,) at which a sample counter wraps to 0, infinite if it does not; None if it is no counter."""
    steps = np.diff(counter)
    if not len(steps) or not np.mean(steps == 1) > 0.5:
        return None
    if not (steps < 0).any():
        return math.inf
    seen = float(np.nanmax(counter)) + 1
    return next((float(usual) for usual in _MODULI if 0 <= usual - seen <= _NEAR), seen)


def _counted(counter: Floats, before: float, modulus: float) -> Floats:
    """Return the sampling periods (n,) before each sample by a wrapping counter; 1 where it does not advance."""
    previous = np.concatenate([[before if np.isfinite(before) else counter[0] - 1], counter[:-1]])
    steps = counter - previous
    steps = np.where(steps < 0, steps + modulus, steps)
    return np.where((steps >= 1) & np.isfinite(steps), steps, 1.0)


def _cell(row: list[str], column: int | None) -> float:
    return number(plain(row[column])) if column is not None and column < len(row) else np.nan


def _label(row: list[str], column: int | None) -> str:
    text = plain(row[column]) if column is not None and column < len(row) else ""
    value = number(text)
    if not np.isfinite(value):
        return text
    return "" if value == 0 else as_label(value)
