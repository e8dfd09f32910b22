"""XDF files: what streams one holds, how to choose one, and its samples by pyxdf, which loads it whole.

Stream names are not unique and types lie, so a stream is chosen by name, type, source id or number, and a choice that
fails lists what there is. The chunks are walked before pyxdf sees them: it trusts the lengths in a file, and a torn or
wrong one would be believed. Format: github.com/sccn/xdf, "Specifications".
"""

import logging
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
import pyxdf

from higvf_console.arrays import Floats, floats
from higvf_console.errors import InputError
from higvf_interfaces.formats.records import StreamInfo

MAGIC = b"XDF:"
_HEADER, _SAMPLES = 2, 3
_LONGEST_HEADER = 10_000_000  # bytes


class XdfStream(NamedTuple):
    """A stream of a file: its number in the file, what it says of itself, its header in XML, and its samples."""

    number: int
    info: StreamInfo
    header: ET.Element
    samples: int = 0


class Survey(NamedTuple):
    """What a file holds: its streams, and whether it ends in the middle of a chunk."""

    streams: tuple[XdfStream, ...]
    torn: bool


class XdfSamples(NamedTuple):
    """A loaded stream: times (n,) [s] of the recording computer, and values (n, channels)."""

    time: Floats
    values: Any


def survey(path: Path) -> Survey:
    """Walks the chunks of a file without loading it.

    Raises:
        InputError: it is no XDF file, or a chunk claims more samples than it has bytes.
    """
    streams: dict[int, XdfStream] = {}
    samples: Counter[int] = Counter()
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
                number = int.from_bytes(file.read(4), "little") if tag in (_HEADER, _SAMPLES) else 0
                if tag == _HEADER:
                    streams[number] = _header(path, file, number, end)
                elif tag == _SAMPLES:
                    samples[number] += _count(path, file, end)
                file.seek(end)
    except OSError as problem:
        raise InputError(f"{path}: cannot be read: {problem}") from problem
    counted = (stream._replace(samples=samples[number]) for number, stream in streams.items())
    return Survey(tuple(counted), torn)


def choose(path: Path, streams: Sequence[XdfStream], wanted: str | None, types: Sequence[str]) -> XdfStream:
    """The stream called `wanted`, by number from 1, name, type or source id; without it, the only one of `types`.

    Raises:
        InputError: none or several are meant; the message lists the streams.
    """
    if wanted is None:
        found = [stream for stream in streams if stream.info.type.strip().casefold() in types]
        meant = f"of type {' or '.join(types)}"
    else:
        meant, key = f"called {wanted[:80]!r}", wanted.strip().casefold()
        named = [(s.info.name, s.info.type, s.info.source_id) for s in streams]
        found = [s for s, names in zip(streams, named, strict=True) if key in [n.strip().casefold() for n in names]]
        if not found and key.removesuffix(".0").isdecimal():
            found = [s for place, s in enumerate(streams, start=1) if str(place) == key.removesuffix(".0")]
    if len(found) == 1:
        return found[0]
    listed = "; ".join(describe(place, stream) for place, stream in enumerate(streams, start=1)) or "none"
    raise InputError(
        f"{path}: {len(found) or 'no'} streams {meant}; give stream= a name, type, source id or number of: {listed}"
    )


def describe(place: int, stream: XdfStream) -> str:
    """A stream in a list for messages."""
    name, kind, source_id, channels, rate = stream.info
    return (
        f"{place} name {name[:40]!r} type {kind[:20]!r} source id {source_id[:40]!r}, {channels} channels, {rate:g} Hz"
    )


def load(path: Path, stream: XdfStream) -> XdfSamples:
    """Loads one stream, its clock corrected.

    Raises:
        InputError: pyxdf cannot read the file.
    """
    quiet = logging.getLogger("pyxdf")
    level = quiet.level
    quiet.setLevel(logging.CRITICAL)  # it logs what this module says in its own words
    try:
        loaded, _ = pyxdf.load_xdf(str(path), select_streams=[stream.number], verbose=False)
        (found,) = loaded
        return XdfSamples(floats(found["time_stamps"]), found["time_series"])
    except Exception as problem:  # a damaged file makes pyxdf raise whatever there is
        raise InputError(f"{path}: pyxdf cannot read it: {type(problem).__name__}: {problem}") from problem
    finally:
        quiet.setLevel(level)


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
    return XdfStream(number, info, header)


def _count(path: Path, file: IO[bytes], end: int) -> int:
    """How many samples the chunk claims; each takes a byte or more."""
    samples = _length(file)
    if samples is None or samples > end - file.tell():
        raise InputError(f"{path}: a chunk claims {samples} samples in {end - file.tell()} bytes: the file is damaged")
    return samples


def _said(header: ET.Element, key: str) -> str:
    return (header.findtext(key) or "").strip()
