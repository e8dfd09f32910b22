"""Samples of XDF streams, loaded by pyxdf, which converts all clocks to the recorder's clock.

pyxdf gets the intact chunks only, because it trusts the lengths and numbers of a damaged file.
"""
# pyxdf has no types.
# pyright: reportUnknownMemberType=false

import io
import itertools
import logging
import xml.etree.ElementTree as ET
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError, MissingExtraError
from higvf_console.core.optional import optional
from higvf_interfaces.formats.clock import ClockNote, event_times, joined
from higvf_interfaces.formats.common_clock import APART_AT_ALL, distance, in_milliseconds, on_one_clock
from higvf_interfaces.formats.xdf.chunks import MAGIC, Chunk, Tag
from higvf_interfaces.formats.xdf.file import Survey, XdfStream

if TYPE_CHECKING:
    import pyxdf
else:
    pyxdf = optional("pyxdf", "devices")

_OFFSET = 16  # bytes of a clock offset
# Stamps are smoothed between gaps of this length; by default, pyxdf smooths across gaps of up to 500 samples.
_BREAKS: Mapping[str, Any] = {"jitter_break_threshold_seconds": 0.5, "jitter_break_threshold_samples": 3}
_Loaded = Mapping[str, Any]


class XdfSamples(NamedTuple):
    """A loaded stream.

    Attributes:
        time: (n,) repaired times on the recorder's clock [s]; of events non-decreasing; of samples NaN where missing.
        values: numbers (n, channels), or n lists of text.
        earliest: time of the earliest sample of the streams on the same clock [s]; 0 without one.
        notes: repairs and assumptions.
    """

    time: Floats
    values: Any
    earliest: float
    notes: list[str]


def load(path: Path, chosen: XdfStream, found: Survey, *, sampled: bool | None = None) -> XdfSamples:
    """Load a stream.

    Args:
        path: path of the file.
        chosen: the stream, as `choose` returned it.
        found: contents of the file; all its streams on the same clock share one time 0.
        sampled: whether the stream holds samples, whatever its rate; None means by `chosen.marks`.

    Raises:
        InputError: If pyxdf cannot read the file, samples are not numbers as declared, or the stream was recorded twice
            at the same time.
    """
    parts = chosen.parts or (chosen.number,)
    sampled = not chosen.marks if sampled is None else sampled
    try:
        with _quiet(), np.errstate(all="ignore"):
            content = io.BytesIO(_intact(found))
            entries = cast(Sequence[_Loaded], pyxdf.load_xdf(content, **_BREAKS)[0])
            loaded = {int(entry["info"]["stream_id"]): entry for entry in entries}
            times = {number: floats(entry["time_stamps"], -1) for number, entry in loaded.items()}
            spans = {s.number: _span(times[s.number], sampled if s.number in parts else not s.marks)
                     for s in found.streams}  # fmt: skip
            parts = tuple(sorted(parts, key=lambda number: (np.isnan(spans[number][0]), spans[number][0])))
            series = [_values(loaded[number], chosen) for number in parts]
    except MissingExtraError:
        raise
    except Exception as problem:  # pyxdf raises arbitrary exceptions on a damaged file
        reason = f"{type(problem).__name__}: {str(problem)[:200]}"
        raise InputError(f"{path}: the XDF file cannot be read: {reason}") from problem
    notes = [*found.notes, *_parts_joined(path, chosen, parts, spans)]
    raw = floats(np.concatenate([times[k][: len(v)] for k, v in zip(parts, series, strict=True)]))
    values: Any = [sample for part in series for sample in part] if chosen.texts else np.concatenate(series)[: len(raw)]
    if sampled:
        time, repairs = joined(raw)
        notes += repairs.notes
    else:
        order, time, _, repaired = event_times(raw, from_epoch=False)
        values = [values[k] for k in order] if chosen.texts else values[order]
        notes += repaired
    near = on_one_clock([spans[s.number] for s in found.streams], [s.number for s in found.streams].index(parts[0]))
    notes += _other_clocks(chosen, found, spans, near)
    starts = [spans[found.streams[k].number][0] for k in near]
    return XdfSamples(time, values, min((start for start in starts if np.isfinite(start)), default=0.0), notes)


def cut_off(stream: XdfStream, readable: int) -> list[str]:
    """Return a note if the stream has no footer; `readable` is its number of readable samples."""
    return [] if stream.closed else [f"the recording was cut off: only its {readable} readable samples are used"]


def _intact(found: Survey) -> bytes:
    """Return the file without damaged chunks, and without footers that pyxdf cannot read."""
    return MAGIC + b"".join(found.data[c.start : c.end] for c in found.chunks if _usable(c, found.data))


def _usable(chunk: Chunk, data: bytes) -> bool:
    """Return whether pyxdf can read a chunk: a footer needs a whole number of samples."""
    if chunk.tag == Tag.OFFSET:
        return chunk.end - chunk.content == _OFFSET
    if chunk.tag != Tag.FOOTER:
        return True
    try:
        footer = ET.fromstring(data[chunk.content : chunk.end].decode("utf-8", errors="replace"))
    except ET.ParseError:
        return False
    return (footer.findtext("sample_count") or "").isdecimal()


def _values(entry: _Loaded, chosen: XdfStream) -> Any:
    return entry["time_series"] if chosen.texts else floats(entry["time_series"], -1, chosen.info.channels)


def _span(time: Floats, sampled: bool) -> tuple[float, float]:
    """Return the first and last repaired time of a stream [s]; NaN for an empty one."""
    times = joined(time)[0] if sampled else event_times(time, from_epoch=False).times
    known = times[np.isfinite(times)]
    return (float(known.min()), float(known.max())) if len(known) else (np.nan, np.nan)


def _parts_joined(
    path: Path, stream: XdfStream, parts: Sequence[int], spans: Mapping[int, tuple[float, float]]
) -> list[str]:
    for before, after in itertools.pairwise(parts):
        if spans[after][0] < spans[before][1]:
            raise InputError(
                f"{path}: stream {stream.info.name[:40]} was recorded twice at the same time, as #{before} and "
                f"#{after}; choose one by its number"
            )
    listed = ", ".join(f"#{number}" for number in parts)
    return [f"recorded in {len(parts)} parts ({listed}), which are joined"] if len(parts) > 1 else []


def _other_clocks(
    chosen: XdfStream, found: Survey, spans: Mapping[int, tuple[float, float]], near: Sequence[int]
) -> list[str]:
    """Return notes on the streams whose clock is not, or may not be, that of the chosen one."""
    here, name = spans[chosen.number], chosen.info.name[:40]
    others = [stream for k, stream in enumerate(found.streams) if k not in near]
    notes: list[str] = []
    if others:
        apart = max(distance(here, spans[other.number]) for other in others)
        hint = " (perhaps milliseconds)" if any(in_milliseconds(here, spans[s.number]) for s in others) else ""
        notes.append(
            f"{_names(others)} and {name} lie {apart:.0f} s apart, so on different clocks{hint}: the earliest sample "
            "of each clock is at time 0; shift one with start="
        )
    around = [found.streams[k] for k in near]
    doubtful = [stream for stream in around if distance(here, spans[stream.number]) > APART_AT_ALL]
    if doubtful:
        apart = max(distance(here, spans[other.number]) for other in doubtful)
        notes.append(
            f"{_names(doubtful)} and {name} lie {apart:.0f} s apart, perhaps on different clocks; shift one with start="
        )
    return [ClockNote(note) for note in notes]


def _names(streams: Sequence[XdfStream]) -> str:
    return ", ".join(stream.info.name[:40] for stream in streams)


@contextmanager
def _quiet() -> Generator[None]:
    """Disable the log of pyxdf; the readers report repairs in their notes."""
    logger = logging.getLogger(pyxdf.load_xdf.__module__)
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before
