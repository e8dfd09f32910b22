"""XDF files (Lab Streaming Layer): what streams one holds, and how to choose one.

Stream names are not unique and types lie, so a stream is chosen by name, type, source id or number, and a choice that
fails lists what there is. The chunks are walked before pyxdf loads any: it trusts the lengths in a file, and a torn or
wrong one would be believed. Format: github.com/sccn/xdf, "Specifications".
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
    """A stream of a file.

    Attributes:
        number: in the file.
        info: what it says of itself; the type may lie.
        header: in XML.
        texts: whether its samples are texts.
        samples: how many there are.
        closed: whether the recorder ended it; else the recording was cut off.
    """

    number: int
    info: StreamInfo
    header: ET.Element
    texts: bool
    samples: int = 0
    closed: bool = False

    @property
    def marks(self) -> bool:
        """Whether it holds events rather than samples of a signal."""
        return self.texts or self.info.rate == 0

    def __str__(self) -> str:
        """The stream as messages list it."""
        name, kind, source_id, channels, rate = self.info
        source = f", source {source_id[:40]}" if source_id else ""
        what = "texts" if self.texts else f"{rate:g} Hz" if rate else "events"
        size = f"{channels} channels, {what}, {self.samples} samples"
        return f"#{self.number}: type {kind[:20]}, name {name[:40]}{source} ({size})"


class Survey(NamedTuple):
    """What a file holds: its streams, and whether it ends in the middle of a chunk."""

    streams: tuple[XdfStream, ...]
    torn: bool


def matches(file: TextFile) -> bool:
    """Whether the file begins with XDF's magic word."""
    return file.head.startswith(MAGIC)


def survey(path: Path) -> Survey:
    """Walks the chunks of a file without loading it.

    Raises:
        InputError: it is no XDF file, breaks off before its first stream, or claims more samples than it has bytes.
    """
    streams: dict[int, XdfStream] = {}
    samples: Counter[int] = Counter()
    closed: set[int] = set()
    torn = False
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise InputError(f"{path}: is no XDF file: it does not begin with {MAGIC.decode()}")
            while file.tell() < size:
                chunk = _next_chunk(file, size)
                if chunk is None:
                    torn = True
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
    if torn and not streams:
        raise InputError(f"{path}: the XDF file cannot be read: it breaks off before its first stream")
    counted = (s._replace(samples=samples[number], closed=number in closed) for number, s in streams.items())
    return Survey(tuple(counted), torn)


def choose(
    path: Path,
    streams: Sequence[XdfStream],
    wanted: str | None,
    candidates: Sequence[XdfStream],
    what: str,
    option: str = "stream",
) -> XdfStream:
    """The candidate that `wanted` names, or the only one there is.

    Args:
        path: of the file, for messages.
        streams: all of the file.
        wanted: words joined by `+`, each the type, name, source id or number of the stream.
        candidates: those among which it is.
        what: how messages call these.
        option: how they call what gives `wanted`.

    Raises:
        InputError: none or several fit; the message lists what there is.
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
    """What a stream's header says of each of `count` channels, say its `label`; empty where it does not."""
    said = [(channel.findtext(key) or "").strip() for channel in header.findall("desc/channels/channel")[:count]]
    return said + [""] * (count - len(said))


def _handles(stream: XdfStream) -> set[str]:
    names = {name.strip().casefold() for name in (stream.info.type, stream.info.name, stream.info.source_id)}
    return names | {str(stream.number), f"#{stream.number}", f"{stream.number}.0"}


def _next_chunk(file: IO[bytes], size: int) -> tuple[int, int] | None:
    """Tag and end of the chunk that begins here; None where the file ends in it."""
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
        raise InputError(f"{path}: the header of stream {number} is {length} bytes long")
    try:
        header = ET.fromstring(file.read(length).decode("utf-8", errors="replace"))
        channels, rate = int(_said(header, "channel_count") or 0), float(_said(header, "nominal_srate") or 0)
    except (ET.ParseError, ValueError) as problem:
        raise InputError(f"{path}: the header of stream {number} is damaged: {problem}") from problem
    if not 0 < channels <= 100_000 or not np.isfinite(rate) or rate < 0:
        raise InputError(f"{path}: stream {number} claims {channels} channels at {rate:g} Hz")
    info = StreamInfo(_said(header, "name"), _said(header, "type"), _said(header, "source_id"), channels, rate)
    return XdfStream(number, info, header, _said(header, "channel_format") == "string")


def _count(path: Path, file: IO[bytes], end: int) -> int:
    """How many samples the chunk claims; each takes a byte or more."""
    samples = _length(file)
    if samples is None or samples > end - file.tell():
        raise InputError(f"{path}: a chunk claims {samples} samples in {end - file.tell()} bytes: the file is damaged")
    return samples


def _said(header: ET.Element, key: str) -> str:
    return (header.findtext(key) or "").strip()
