"""Chunks of an XDF file, found one after the other, also behind damage.

    [bytes of the length: 1, 4 or 8][length][tag, 2 bytes][stream, 4 bytes, of some tags][content]

A chunk is believed if it is of a known kind, fits into the file and has no boundary chunk within it; samples must also
be followed by another chunk. Where that fails, reading resumes behind the next boundary chunk, which recorders write
every few seconds for this purpose. Format: github.com/sccn/xdf.
"""

import zlib
from enum import IntEnum
from pathlib import Path
from typing import NamedTuple

from higvf_console.core.errors import InputError

MAGIC = b"XDF:"
_BOUNDARY = bytes.fromhex("43a546dccbf5410fb30ed5467383cbe4")
_GZIP = b"\x1f\x8b"
_BLOCK = 2**20
_LONGEST_HEAD = 1 + 8 + 2  # bytes of a length and a tag


class Tag(IntEnum):
    """What a chunk holds."""

    FILE = 1
    HEADER = 2
    SAMPLES = 3
    OFFSET = 4
    BOUNDARY = 5
    FOOTER = 6


_OF_STREAM = (Tag.HEADER, Tag.SAMPLES, Tag.OFFSET, Tag.FOOTER)


class Chunk(NamedTuple):
    """A chunk in the bytes of a file.

    Attributes:
        tag: what it holds.
        stream: number of its stream; 0 without one.
        start: index of its first byte.
        content: index of the first byte of its content.
        end: index behind its last byte.
    """

    tag: int
    stream: int
    start: int
    content: int
    end: int


class Chunks(NamedTuple):
    """The chunks of a file.

    Attributes:
        data: bytes of the file, decompressed.
        chunks: intact chunks in order.
        damaged: number of damaged places that were skipped.
        truncated: whether the file ends within a chunk.
    """

    data: bytes
    chunks: list[Chunk]
    damaged: int
    truncated: bool


def read_chunks(path: Path) -> Chunks:
    """Find the chunks of a file, which may be compressed with gzip (.xdfz).

    Raises:
        InputError: If the file cannot be read or is not XDF.
    """
    data, complete = _content(path)
    if not data.startswith(MAGIC):
        raise InputError(f"{path}: is not an XDF file: it does not begin with {MAGIC.decode()}")
    chunks: list[Chunk] = []
    place, damaged, truncated = len(MAGIC), 0, not complete
    while place < len(data):
        chunk = _chunk_at(data, place)
        if chunk is not None:
            chunks.append(chunk)
            place = chunk.end
            continue
        boundary = data.find(_BOUNDARY, place)
        if boundary < 0:
            truncated = True
            break
        damaged += 1
        place = boundary + len(_BOUNDARY)
    return Chunks(data, chunks, damaged, truncated)


def length_at(data: bytes, place: int) -> tuple[int, int] | None:
    """Return a length field and the index behind it; None if there is none."""
    width = data[place] if place < len(data) else 0
    end = place + 1 + width
    return (int.from_bytes(data[place + 1 : end], "little"), end) if width in (1, 4, 8) and end <= len(data) else None


def _chunk_at(data: bytes, start: int) -> Chunk | None:
    head = _head(data, start)
    if head is None or head[2] > len(data):
        return None
    tag, content, end = head
    if (tag not in tuple(Tag) or tag == Tag.SAMPLES) and not _continues(data, end):
        return None
    if tag != Tag.BOUNDARY and data.find(_BOUNDARY, content, end) >= 0:  # its end is missing, and others are within it
        return None
    stream = int.from_bytes(data[content : content + 4], "little") if tag in _OF_STREAM else 0
    return Chunk(tag, stream, start, content + 4 * (tag in _OF_STREAM), end)


def _head(data: bytes, start: int) -> tuple[int, int, int] | None:
    """Return tag, index of the content and end of the chunk at `start`; None if there is no chunk."""
    field = length_at(data, start)
    if field is None or field[1] + 2 > len(data):
        return None
    length, place = field
    tag = int.from_bytes(data[place : place + 2], "little")
    return (tag, place + 2, place + length) if length >= 2 + 4 * (tag in _OF_STREAM) else None


def _continues(data: bytes, start: int) -> bool:
    """Return whether a chunk of a known tag begins at `start`, even one that is cut off, or the file ends there."""
    head = _head(data, start)
    return head[0] in tuple(Tag) if head is not None else len(data) - start < _LONGEST_HEAD


def _content(path: Path) -> tuple[bytes, bool]:
    """Return the bytes of a file, decompressed, and whether they are complete."""
    try:
        content = path.read_bytes()
    except OSError as problem:
        raise InputError(f"{path}: cannot be read: {problem}") from problem
    if not content.startswith(_GZIP):
        return content, True
    parts: list[bytes] = []
    while content.startswith(_GZIP):  # one part after the other, as `gzip` appends them
        unpacker = zlib.decompressobj(wbits=31)
        try:
            parts.extend(unpacker.decompress(content[k : k + _BLOCK]) for k in range(0, len(content), _BLOCK))
        except zlib.error:
            return b"".join(parts), False
        content = unpacker.unused_data
        if not unpacker.eof:
            return b"".join(parts), False
    return b"".join(parts), True
