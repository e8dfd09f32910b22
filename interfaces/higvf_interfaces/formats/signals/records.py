"""What every reader of raw signals yields: a header, and the samples in chunks of bounded size."""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError

_SAME_RATE = 0.01  # rates that differ by a smaller share are one
CHUNK = 512  # samples of a chunk at most: read within a fraction of a control period


class SignalRequest(NamedTuple):
    """What a person may say of a file that does not say it itself.

    Attributes:
        format: name of a format; None = by content.
        stream: words that name one stream by type, name, source or number, joined by `+`; None = the only one.
        rate: of samples that have no times [Hz]; None = unknown.
        channels: names of the channels wanted, in this order; empty = all.
        stream_option: how messages call the option that names the stream.
    """

    format: str | None = None
    stream: str | None = None
    rate: float | None = None
    channels: tuple[str, ...] = ()
    stream_option: str = "stream"


class SignalChunk(NamedTuple):
    """Some samples: `times` (n,) strictly increasing [s], `values` (n, c), NaN where missing."""

    times: Floats
    values: Floats


class SignalRecord(NamedTuple):
    """A recorded multi-channel signal on one clock that starts near 0.

    Attributes:
        names: (c,) of the channels, unique.
        units: (c,) of the channels; empty where the file does not say.
        rate: nominal sampling rate [Hz].
        epoch: the device's own time at 0 [s].
        format: name of the format.
        notes: what was repaired or assumed; grows while the chunks of a text file are read.
        chunks: reads the samples from their start, in chunks of at most `CHUNK`.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    epoch: float
    format: str
    notes: list[str]
    chunks: Callable[[], Iterator[SignalChunk]]


def whole(record: SignalRecord) -> SignalChunk:
    """All samples of a record at once: times (n,) and values (n, c).

    Raises:
        InputError: it has none.
    """
    chunks = list(record.chunks())
    if not chunks:
        raise InputError(f"{record.format}: the recording has no samples")
    return SignalChunk(np.concatenate([c.times for c in chunks]), np.concatenate([c.values for c in chunks]))


def pick_channels(record: SignalRecord, wanted: Sequence[str], place: str) -> SignalRecord:
    """The record with the channels `wanted` alone, in that order; all where none is wanted.

    Raises:
        InputError: there is no such channel; the message lists those there are.
    """
    if not wanted:
        return record
    known = {name.casefold(): place for place, name in enumerate(record.names)}
    missing = [name for name in wanted if name.casefold() not in known]
    if missing:
        raise InputError(f"{place}: there is no channel {missing[0]!r}; the file has: {', '.join(record.names)}")
    columns = [known[name.casefold()] for name in wanted]

    def chunks() -> Iterator[SignalChunk]:
        for chunk in record.chunks():
            yield SignalChunk(chunk.times, floats(chunk.values[:, columns]))

    return record._replace(
        names=tuple(record.names[k] for k in columns), units=tuple(record.units[k] for k in columns), chunks=chunks
    )


def unused_rate(given: float | None, rate: float) -> list[str]:
    """A note where a person says another rate [Hz] than the file itself, which is believed."""
    other = given is not None and abs(given - rate) > _SAME_RATE * rate
    return [f"the rate given, {given:g} Hz, is not used: the file has its own, {rate:g} Hz"] if other else []


def unique_names(names: Sequence[str]) -> tuple[str, ...]:
    """Names made unique: the second `Not Used` becomes `Not Used (2)`; an empty one its number."""
    seen: dict[str, int] = {}
    unique: list[str] = []
    for number, name in enumerate(names, start=1):
        plain = name or f"channel {number}"
        seen[plain] = seen.get(plain, 0) + 1
        unique.append(plain if seen[plain] == 1 else f"{plain} ({seen[plain]})")
    return tuple(unique)


def sliced(times: Floats, values: Floats) -> Iterator[SignalChunk]:
    """Samples that lie in memory, in chunks; those out of order or without a finite time are left out."""
    kept = np.flatnonzero(np.isfinite(times))
    if len(kept):
        kept = kept[np.concatenate([[True], np.diff(np.maximum.accumulate(times[kept])) > 0])]
    for start in range(0, len(kept), CHUNK):
        part = kept[start : start + CHUNK]
        yield SignalChunk(floats(times[part]), floats(values[part]))
