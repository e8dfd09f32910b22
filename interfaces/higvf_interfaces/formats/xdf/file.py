"""XDF files (Lab Streaming Layer): survey of the streams, and selection of one.

Stream names are not unique and types are unreliable, so a stream is selected by name, type, source id or number; a
failed selection lists all streams. The survey walks the chunks before pyxdf loads the file, because pyxdf trusts chunk
lengths that may be wrong in a damaged file. Format: github.com/sccn/xdf, "Specifications".
"""

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.records import StreamInfo
from higvf_interfaces.formats.text import TextFile

MAGIC = b"XDF:"
_HEADER, _SAMPLES, _FOOTER = 2, 3, 6
_LONGEST_HEADER = 10_000_000  # bytes


class XdfStream(NamedTuple):
    """A stream in a file.

    Attributes:
        number: number of the stream in the file.
        info: metadata of the stream; the type is unreliable.
        header: XML header.
        texts: whether the samples are text.
        samples: number of samples.
        closed: whether the stream has a footer; without one the recording was cut off.
    """

    number: int
    info: StreamInfo
    header: ET.Element
    texts: bool
    samples: int = 0
    closed: bool = False

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
    """The streams of a file, and whether it ends within a chunk."""

    streams: tuple[XdfStream, ...]
    truncated: bool


def matches(file: TextFile) -> bool:
    """Return whether the file begins with the magic bytes of XDF."""
    return file.head.startswith(MAGIC)


def survey(path: Path) -> Survey:
    """List the streams of a file without loading the samples.

    Raises:
        InputError: If the file is not XDF, ends before its first stream, or declares more samples than it has bytes.
    """
    streams: dict[int, XdfStream] = {}
    samples: Counter[int] = Counter()
    closed: set[int] = set()
    truncated = False
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise InputError(f"{path}: is not an XDF file: it does not begin with {MAGIC.decode()}")
            while file.tell() < size:
                chunk = _next_chunk(file, size)
                if chunk is None:
                    truncated = True
                    break
                tag, end = chunk
                number = int.from_bytes(file.read(4), "little") if tag in (_HEADER, _SAMPLES, _FOOTER) else 0
                if tag == _HEADER:
                    streams[number] = _header(path, file, number, end)
                elif tag == _SAMPLES:
                    samples[number] += _count(path, file, end)
                elif tag == _FOOTER:
                    closed.add(number)
                file.seek(end)
    except OSError as problem:
        raise InputError(f"{path}: cannot be read: {problem}") from problem
    if truncated and not streams:
        raise InputError(f"{path}: the XDF file cannot be read: it ends before its first stream")
    counted = (s._replace(samples=samples[number], closed=number in closed) for number, s in streams.items())
    return Survey(tuple(counted), truncated)


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
    words = [word.strip().casefold() for word in (wanted or "").split("+") if word.strip()]
    fit = [stream for stream in candidates if all(word in _handles(stream) for word in words)]
    if len(fit) == 1:
        return fit[0]
    listed = "; ".join(map(str, streams)) or "none"
    asked = f"{option}={(wanted or '')[:80]} fits" if words else "the file has"
    way_out = f"; choose one by {option}=TYPE, NAME, SOURCE or NUMBER, or several of these joined by +"
    raise InputError(f"{path}: {asked} {len(fit)} {what}{way_out if streams else ''}; the file has: {listed}")


def channel_texts(header: ET.Element, key: str, count: int) -> list[str]:
    """Return an entry of the header, such as `label`, for each of `count` channels; empty where missing."""
    texts = [(channel.findtext(key) or "").strip() for channel in header.findall("desc/channels/channel")[:count]]
    return texts + [""] * (count - len(texts))


def _handles(stream: XdfStream) -> set[str]:
    names = {name.strip().casefold() for name in (stream.info.type, stream.info.name, stream.info.source_id)}
    return names | {str(stream.number), f"#{stream.number}", f"{stream.number}.0"}


def _next_chunk(file: IO[bytes], size: int) -> tuple[int, int] | None:
    """Return tag and end of the next chunk, or None if the file ends within it."""
    length = _length(file)
    if length is None or length < 2 or file.tell() + length > size:
        return None
    end = file.tell() + length
    return int.from_bytes(file.read(2), "little"), end


def _length(file: IO[bytes]) -> int | None:
    width = int.from_bytes(file.read(1), "little")
    content = file.read(width) if width in (1, 4, 8) else b""
    return int.from_bytes(content, "little") if content and len(content) == width else None


def _header(path: Path, file: IO[bytes], number: int, end: int) -> XdfStream:
    length = end - file.tell()
    if not 0 <= length <= _LONGEST_HEADER:
        raise InputError(f"{path}: the header of stream {number} has an invalid length, {length} bytes")
    try:
        header = ET.fromstring(file.read(length).decode("utf-8", errors="replace"))
        channels, rate = int(_text(header, "channel_count") or 0), float(_text(header, "nominal_srate") or 0)
    except (ET.ParseError, ValueError) as problem:
        raise InputError(f"{path}: the header of stream {number} is damaged: {problem}") from problem
    if not 0 < channels <= 100_000 or not np.isfinite(rate) or rate < 0:
        raise InputError(f"{path}: stream {number} declares {channels} channels at {rate:g} Hz: the file is damaged")
    info = StreamInfo(_text(header, "name"), _text(header, "type"), _text(header, "source_id"), channels, rate)
    return XdfStream(number, info, header, _text(header, "channel_format") == "string")


def _count(path: Path, file: IO[bytes], end: int) -> int:
    """Return the number of samples that the chunk declares; each takes at least one byte."""
    samples = _length(file)
    if samples is None or samples > end - file.tell():
        raise InputError(
            f"{path}: a chunk declares {samples} samples in {end - file.tell()} bytes: the file is damaged"
        )
    return samples


def _text(header: ET.Element, key: str) -> str:
    return (header.findtext(key) or "").strip()
