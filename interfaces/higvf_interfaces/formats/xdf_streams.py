"""The streams of an XDF file (Lab Streaming Layer), and the choice of one: names are not unique and types lie.

pyxdf reads a file as a whole into memory; nothing else is loaded so. Time 0 is the earliest sample of any stream, so
that the markers and the signals of one file keep step.
"""

import logging
import struct
import zlib
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
import pyxdf

from higvf_console.arrays import Floats, floats
from higvf_console.errors import InputError
from higvf_interfaces.fields import shown
from higvf_interfaces.formats.text import TextFile

MAGIC = "XDF:"
_BROKEN = (ValueError, KeyError, IndexError, TypeError, AttributeError, OSError, EOFError, SyntaxError, MemoryError,
           OverflowError, ArithmeticError, UnicodeError, RecursionError, struct.error, zlib.error)  # fmt: skip


class XdfStream(NamedTuple):
    """One stream.

    Attributes:
        number: in the file.
        name: as the sender called it; not unique.
        type: as the sender called it, such as "EEG" or "Markers"; may lie.
        source: id of the device; empty where it gave none.
        rate: nominal sampling rate [Hz]; 0 for events.
        texts: whether the samples are texts.
        times: (n,) from the file's earliest sample on [s].
        samples: n rows of c values: numbers as an array (n, c), texts as lists.
        names: (c,) of the channels; empty where the file does not say.
        units: likewise.
        complete: whether the stream was closed properly.
    """

    number: int
    name: str
    type: str
    source: str
    rate: float
    texts: bool
    times: Floats
    samples: Any
    names: tuple[str, ...]
    units: tuple[str, ...]
    complete: bool

    @property
    def marks(self) -> bool:
        """Whether it holds events rather than samples of a signal."""
        return self.texts or self.rate == 0

    def __str__(self) -> str:
        """The stream as messages list it."""
        source = f", source {self.source}" if self.source else ""
        what = "texts" if self.texts else f"{self.rate:g} Hz" if self.rate else "events"
        return f"#{self.number}: type {self.type}, name {self.name}{source} ({what}, {len(self.times)} samples)"


class XdfFile(NamedTuple):
    """All streams of a file, and the device time that became 0 [s]."""

    streams: tuple[XdfStream, ...]
    epoch: float


def matches(file: TextFile) -> bool:
    """Whether the file begins with XDF's magic word."""
    return file.first_line.startswith(MAGIC)


def load(path: Path) -> XdfFile:
    """Reads all streams; of a file that was cut off, those samples that are there.

    Raises:
        InputError: it is no XDF file or none of it can be read.
    """
    try:
        with _quiet(), np.errstate(all="ignore"):
            found = cast(Sequence[Mapping[str, Any]], pyxdf.load_xdf(str(path))[0])
            raw = [_stream(entry) for entry in found]
    except _BROKEN as problem:
        raise InputError(f"{path}: the XDF file cannot be read: {str(problem)[:200]}") from problem
    starts = [float(np.nanmin(s.times)) for s in raw if len(s.times) and np.isfinite(s.times).any()]
    if not starts:
        raise InputError(f"{path}: the XDF file has no samples in its {len(raw)} streams")
    epoch = min(starts)
    return XdfFile(tuple(stream._replace(times=stream.times - epoch) for stream in raw), epoch)


def choose(streams: Sequence[XdfStream], wanted: str | None, marks: bool, path: Path) -> XdfStream:
    """The stream that `wanted` names, or the only one there is.

    Args:
        streams: of the file.
        wanted: words joined by `+`, each the type, name, source or number of the stream.
        marks: whether events are sought rather than the samples of a signal.
        path: of the file, for messages.

    Raises:
        InputError: none or several fit; the message lists what there is.
    """
    words = [word.strip().casefold() for word in (wanted or "").split("+") if word.strip()]
    fit = [s for s in streams if s.marks is marks and all(word in _handles(s) for word in words)]
    if len(fit) == 1:
        return fit[0]
    listed = "; ".join(map(str, streams)) or "none"
    what = "event" if marks else "signal"
    asked = f"stream={wanted} fits" if words else "the file has"
    way_out = "; choose one by stream=TYPE, NAME, SOURCE or NUMBER, or several of these joined by +" if fit else ""
    raise InputError(f"{path}: {asked} {len(fit)} {what} streams{way_out}; the file has: {listed}")


def cut_off(stream: XdfStream) -> list[str]:
    """A note where the stream was not closed properly."""
    return [] if stream.complete else [f"the recording was cut off; its readable part has {len(stream.times)} samples"]


def _handles(stream: XdfStream) -> set[str]:
    numbers = {str(stream.number), f"#{stream.number}", f"{stream.number}.0"}
    return {stream.type.casefold(), stream.name.casefold(), stream.source.casefold(), *numbers}


def _stream(entry: Mapping[str, Any]) -> XdfStream:
    info = entry["info"]
    texts = _first(info, "channel_format") == "string"
    names, units = _channels(info)
    count = int(float(_first(info, "channel_count") or 0))
    samples = entry["time_series"] if texts else floats(entry["time_series"], -1, max(1, count))
    times = floats(entry["time_stamps"], -1)
    return XdfStream(
        number=int(info["stream_id"]),
        name=_first(info, "name"),
        type=_first(info, "type"),
        source=_first(info, "source_id"),
        rate=float(_first(info, "nominal_srate") or 0),
        texts=texts,
        times=times[: len(samples)],
        samples=samples[: len(times)],
        names=names if len(names) == count else tuple(f"channel {k + 1}" for k in range(count)),
        units=units if len(units) == count else ("",) * count,
        complete=bool(entry.get("footer")),
    )


def _first(info: Mapping[str, Any], key: str) -> str:
    """XML elements come as lists of one text, or of nothing."""
    values = info.get(key)
    return str(values[0]) if isinstance(values, list) and values and values[0] is not None else ""


def _channels(info: Mapping[str, Any]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    try:
        channels = [channel or {} for channel in info["desc"][0]["channels"][0]["channel"]]
    except (KeyError, IndexError, TypeError):
        return (), ()
    names = tuple(_first(channel, "label") for channel in channels)
    return names, tuple(_unit(_first(channel, "unit")) for channel in channels)


def _unit(text: str) -> str:
    return {"microvolts": "uV", "microvolt": "uV", "µv": "uV", "volts": "V"}.get(text.casefold(), text)


@contextmanager
def _quiet() -> Generator[None]:
    """pyxdf logs what it repairs; we say in our own notes what matters to the operator."""
    logger = logging.getLogger("pyxdf")
    before, logger.disabled = logger.level, False
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)


def label_of(sample: object) -> str:
    """A marker as one text; shown shortened where it is none."""
    value = cast(Sequence[object], sample)[0] if isinstance(sample, list | np.ndarray) and len(sample) else sample
    if isinstance(value, float | np.floating):
        return f"{float(value):g}"
    return value.strip() if isinstance(value, str) else shown(value)
