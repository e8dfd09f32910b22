"""XDF files (Lab Streaming Layer): survey of the streams, and selection of one.

Stream names are not unique and types are unreliable, so a stream is selected by name, type, source id or number; a
failed selection lists all streams. A device that was recorded twice, because it was lost and found again, is one
stream. Streams and chunks that are damaged are left out, and the others are read.
"""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.clock import counted
from higvf_interfaces.formats.records import StreamInfo
from higvf_interfaces.formats.text import TextFile
from higvf_interfaces.formats.xdf.chunks import MAGIC, Chunk, Tag, length_at, read_chunks

_LONGEST_HEADER = 10_000_000  # bytes
_STAMP = 8  # bytes of a time stamp, which a sample may lack
_TEXTS = "string"
_SIZES = {_TEXTS: 1, "double64": 8, "float32": 4, "int64": 8, "int32": 4, "int16": 2, "int8": 1}  # bytes, at least


class XdfStream(NamedTuple):
    """A stream in a file.

    Attributes:
        number: number of the stream in the file.
        info: metadata of the stream; the type is unreliable.
        header: XML header.
        texts: whether the samples are text.
        samples: number of samples.
        closed: whether the stream has a footer; without one the recording was cut off.
        parts: numbers of the streams that are joined to this one, its own first.
    """

    number: int
    info: StreamInfo
    header: ET.Element
    texts: bool
    samples: int = 0
    closed: bool = False
    parts: tuple[int, ...] = ()

    @property
    def marks(self) -> bool:
        """Whether the stream holds events rather than a sampled signal."""
        return self.texts or self.info.rate == 0

    def __str__(self) -> str:
        """Return a summary for messages."""
        name, kind, source_id, channels, rate = self.info
        source = f", source {source_id[:40]}" if source_id else ""
        what = "texts" if self.texts else f"{rate:g} Hz" if rate else "events"
        size = f"{channels} channels, {what}, {self.samples} samples"
        return f"#{self.number}: type {kind[:20]}, name {name[:40]}{source} ({size})"


class Survey(NamedTuple):
    """The contents of a file.

    Attributes:
        streams: those with a readable header.
        truncated: whether the file ends within a chunk.
        notes: what was left out.
        data: bytes of the file.
        chunks: intact chunks of these streams, footers included.
    """

    streams: tuple[XdfStream, ...]
    truncated: bool
    notes: tuple[str, ...]
    data: bytes
    chunks: tuple[Chunk, ...]


def matches(file: TextFile) -> bool:
    """Return whether the file begins with the magic bytes of XDF."""
    return file.head.startswith(MAGIC)


def survey(path: Path) -> Survey:
    """List the streams of a file, and its intact chunks.

    Raises:
        InputError: If the file is not XDF, or ends before its first stream.
    """
    data, chunks, damaged, truncated = read_chunks(path)
    streams: dict[int, XdfStream] = {}
    notes = [f"{counted(damaged, 'damaged place')} skipped"] if damaged else []
    kept: list[Chunk] = []
    unreadable = 0
    for chunk in chunks:
        if chunk.tag == Tag.HEADER:
            try:
                streams[chunk.stream] = _header(data[chunk.content : chunk.end], chunk.stream)
            except ValueError as problem:
                notes.append(f"stream {chunk.stream} left out: {problem}")
                continue
        stream = streams.get(chunk.stream)
        if stream is None:
            continue
        if chunk.tag == Tag.SAMPLES:
            count = _samples(data, chunk, stream)
            if count is None:
                unreadable += 1
                continue
            streams[chunk.stream] = stream._replace(samples=stream.samples + count)
        elif chunk.tag == Tag.FOOTER:
            streams[chunk.stream] = stream._replace(closed=True)
        kept.append(chunk)
    if unreadable:
        notes.append(f"{counted(unreadable, 'damaged chunk')} of samples left out")
    if not streams:
        held = "; ".join(notes) or ("it ends before its first stream" if truncated else "it has no streams")
        raise InputError(f"{path}: the XDF file cannot be read: {held}")
    return Survey(tuple(streams.values()), truncated, tuple(notes), data, tuple(kept))


def choose(
    path: Path,
    streams: Sequence[XdfStream],
    wanted: str | None,
    candidates: Sequence[XdfStream],
    what: str,
    option: str = "stream",
) -> XdfStream:
    """Select one stream.

    Args:
        path: path of the file, for messages.
        streams: all streams of the file.
        wanted: words joined by `+`, each the type, name, source id or number of the stream; None selects the only
            candidate.
        candidates: streams to select from.
        what: name of the candidates in messages.
        option: name of the option that gives `wanted`.

    Raises:
        InputError: If no stream or several match; the message lists all streams.
    """
    fit = fitting(candidates, wanted)
    if len(fit) == 1 or (fit and fit[0].info.source_id and len({_device(stream) for stream in fit}) == 1):
        return fit[0]._replace(parts=tuple(stream.number for stream in fit), closed=all(s.closed for s in fit))
    listed = "; ".join(map(str, streams)) or "none"
    asked = f"{option}={wanted[:80]} fits" if wanted and wanted.strip(" +") else "the file has"
    way_out = f"; choose one by {option}=TYPE, NAME, SOURCE or NUMBER, or several of these joined by +"
    raise InputError(f"{path}: {asked} {len(fit)} {what}{way_out if streams else ''}; the file has: {listed}")


def fitting(streams: Sequence[XdfStream], wanted: str | None) -> list[XdfStream]:
    """Return the streams that have all the words joined by `+` as type, name, source id or number; all if None."""
    words = [word.strip().casefold() for word in (wanted or "").split("+") if word.strip()]
    return [stream for stream in streams if all(word in _handles(stream) for word in words)]


def channel_texts(header: ET.Element, key: str, count: int) -> list[str]:
    """Return an entry of the header, such as `label`, for each of `count` channels; empty where missing."""
    texts = [(channel.findtext(key) or "").strip() for channel in header.findall("desc/channels/channel")[:count]]
    return texts + [""] * (count - len(texts))


def _handles(stream: XdfStream) -> set[str]:
    names = {name.strip().casefold() for name in (stream.info.type, stream.info.name, stream.info.source_id)}
    return names | {str(stream.number), f"#{stream.number}", f"{stream.number}.0"}


def _device(stream: XdfStream) -> tuple[object, ...]:
    """Return what the parts of a stream that was recorded twice have in common."""
    labels = tuple(channel_texts(stream.header, "label", stream.info.channels))
    return (*stream.info, stream.texts, labels)


def _header(content: bytes, number: int) -> XdfStream:
    """Parse the header of a stream.

    Raises:
        ValueError: If it is damaged; the message says how.
    """
    if len(content) > _LONGEST_HEADER:
        raise ValueError(f"its header has {len(content)} bytes")
    try:
        header = ET.fromstring(content.decode("utf-8", errors="replace"))
        channels, rate = int(_text(header, "channel_count") or 0), float(_text(header, "nominal_srate") or 0)
    except (ET.ParseError, ValueError) as problem:
        raise ValueError(f"its header is damaged: {problem}") from problem
    if not 0 < channels <= 100_000 or not np.isfinite(rate) or rate < 0:
        raise ValueError(f"it declares {channels} channels at {rate:g} Hz")
    kind = _text(header, "channel_format")
    if kind not in _SIZES:
        raise ValueError(f"its samples are {kind[:20] or 'of no type'!r}, not one of {', '.join(_SIZES)}")
    info = StreamInfo(_text(header, "name"), _text(header, "type"), _text(header, "source_id"), channels, rate)
    return XdfStream(number, info, header, kind == _TEXTS)


def _samples(data: bytes, chunk: Chunk, stream: XdfStream) -> int | None:
    """Return the number of samples of a chunk; None if it does not agree with the size of the chunk."""
    field = length_at(data, chunk.content)
    if field is None:
        return None
    count, place = field
    if stream.texts:
        return count if _end_of_texts(data, place, count, stream.info.channels, chunk.end) == chunk.end else None
    size = _SIZES[_text(stream.header, "channel_format")] * stream.info.channels
    least, most = count * (1 + size), count * (1 + _STAMP + size)
    return count if least <= chunk.end - place <= most else None


def _end_of_texts(data: bytes, place: int, samples: int, channels: int, end: int) -> int | None:
    """Return the index behind `samples` samples of text; None if they do not fit before `end`."""
    for _ in range(samples):
        if place >= end:
            return None
        place += 1 + (_STAMP if data[place] else 0)
        for _ in range(channels):
            field = length_at(data, place)
            if field is None or field[1] + field[0] > end:
                return None
            place = field[0] + field[1]
    return place


def _text(header: ET.Element, key: str) -> str:
    return (header.findtext(key) or "").strip()
