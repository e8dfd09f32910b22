"""Records of all readers of raw signals: a header, and the samples in chunks of bounded size."""

import re
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import Repairs

_SAME_RATE = 0.01  # relative difference below which two rates are equal
_TRIGGERS = re.compile(r"status|trig(ger)?s?|stim?( \d+)?|markers?\d*|events?", re.IGNORECASE)
_NO_SIGNALS = re.compile(  # time stamps, counters, states and motion that programs write beside the signals
    r"(acc|accel|accelerometer|gyro|gyroscope|mag|magnetometer)([ _-]?channel)?[ _-]?[xyz\d]?|validation.*|"
    r"(secondary )?(time[ _]?stamps?|times?)\b.*|(lsl|unix)[ _]?(ts|time.*)|id|index|unnamed: \d+|battery.*|"
    r"(cq|eq|pm|mot|fac|pow)\..*|marker(index|type|value.*)|.*\.(rawcq|markerhardware)|"  # of Emotiv
    r"(sample|packet|package)[ _]?(index|counter|count|number|num|id)?|counter|.*\.(counter|interpolated|battery.*)",
    re.IGNORECASE,
)
_UNITS = {"microvolt": "uV", "uv": "uV", "millivolt": "mV", "mv": "mV", "volt": "V", "v": "V"}
CHUNK = 512  # maximum number of samples of a chunk; read in a fraction of a control period


class SignalRequest(NamedTuple):
    """Options for reading a recording.

    Attributes:
        format: name of a format; None to detect it from the content.
        stream: words joined by `+`, each type, name, source or number of the stream; None for the only stream.
        rate: sampling rate of a file without times [Hz]; None if unknown.
        channels: names of the channels, in this order; empty for all.
        stream_option: name of the option that gives `stream`, for messages.
    """

    format: str | None = None
    stream: str | None = None
    rate: float | None = None
    channels: tuple[str, ...] = ()
    stream_option: str = "stream"


class SignalChunk(NamedTuple):
    """Consecutive samples: `times` (n,) strictly increasing [s], `values` (n, c), NaN where missing."""

    times: Floats
    values: Floats


class SignalRecord(NamedTuple):
    """A recorded multi-channel signal with times that start near 0.

    Attributes:
        names: (c,) unique names of the channels.
        units: (c,) units of the channels; empty if unknown.
        rate: nominal sampling rate [Hz].
        epoch: device time at time 0 [s].
        format: name of the format.
        notes: repairs and assumptions; grows while the chunks of a text file are read.
        chunks: function that reads the samples from the start, in chunks of at most `CHUNK` samples.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    epoch: float
    format: str
    notes: list[str]
    chunks: Callable[[], Iterator[SignalChunk]]


def whole(record: SignalRecord) -> SignalChunk:
    """Read all samples of a record: times (n,) and values (n, c).

    Raises:
        InputError: If it has none.
    """
    chunks = list(record.chunks())
    if not chunks:
        raise InputError(f"{record.format}: the recording has no samples")
    return SignalChunk(np.concatenate([c.times for c in chunks]), np.concatenate([c.values for c in chunks]))


def pick_channels(record: SignalRecord, wanted: Sequence[str], place: str) -> SignalRecord:
    """Return the record restricted to the channels `wanted`, in that order; all channels with a signal if empty.

    Raises:
        InputError: If a channel is missing; the message lists the channels.
    """
    if not wanted:
        held = signal_places(record.names)
        if len(held) == len(record.names):
            return record
        others = [name for k, name in enumerate(record.names) if k not in held]
        return _restricted(record, held, f"no signals, left out: {', '.join(others)}; choose them by channels=")
    known = {name.casefold(): place for place, name in enumerate(record.names)}
    missing = [name for name in wanted if name.casefold() not in known]
    if missing:
        raise InputError(f"{place}: there is no channel {missing[0]!r}; the file has: {', '.join(record.names)}")
    return _restricted(record, [known[name.casefold()] for name in wanted])


def signal_places(names: Sequence[str]) -> list[int]:
    """Return the places of the channels that hold a signal by their names: no time, counter, trigger or motion.

    If no name is left, all channels count.
    """
    return [k for k, name in enumerate(names) if not is_trigger(name) and not _NO_SIGNALS.fullmatch(name.strip())] or [
        *range(len(names))
    ]


def is_trigger(name: str) -> bool:
    """Return whether a channel holds triggers by its name, such as BioSemi's Status."""
    return _TRIGGERS.fullmatch(name.strip()) is not None


def _restricted(record: SignalRecord, columns: list[int], note: str = "") -> SignalRecord:
    def noted() -> None:
        if note and note not in record.notes:  # the notes of a text file begin anew when it is read again
            record.notes.append(note)

    def chunks() -> Iterator[SignalChunk]:
        for chunk in record.chunks():
            noted()
            yield SignalChunk(chunk.times, floats(chunk.values[:, columns]))

    noted()
    return record._replace(
        names=tuple(record.names[k] for k in columns), units=tuple(record.units[k] for k in columns), chunks=chunks
    )


def plain_unit(text: str) -> str:
    """Return a unit of voltage in its usual spelling: `microvolts` and `µV` give `uV`; other units as they are."""
    plain = text.strip().casefold().replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")
    return _UNITS.get(plain.removesuffix("s"), text.strip())


def unused_rate(given: float | None, rate: float) -> list[str]:
    """Return a note if the given rate [Hz] differs from the rate of the file, which takes precedence."""
    other = given is not None and abs(given - rate) > _SAME_RATE * rate
    return [f"the given rate, {given:g} Hz, is ignored: the file specifies {rate:g} Hz"] if other else []


def unique_names(names: Sequence[str]) -> tuple[str, ...]:
    """Make names unique: the second `Not Used` becomes `Not Used (2)`, an empty name `channel N`."""
    seen: dict[str, int] = {}
    unique: list[str] = []
    for number, name in enumerate(names, start=1):
        plain = name or f"channel {number}"
        seen[plain] = seen.get(plain, 0) + 1
        unique.append(plain if seen[plain] == 1 else f"{plain} ({seen[plain]})")
    return tuple(unique)


def sliced(times: Floats, values: Floats) -> Iterator[SignalChunk]:
    """Yield samples in chunks; samples out of order or without a finite time are dropped."""
    kept = np.flatnonzero(np.isfinite(times))
    kept = kept[Repairs().advancing(floats(times[kept]))]
    for start in range(0, len(kept), CHUNK):
        part = kept[start : start + CHUNK]
        yield SignalChunk(floats(times[part]), floats(values[part]))
