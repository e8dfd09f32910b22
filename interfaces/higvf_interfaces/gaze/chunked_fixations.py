"""Fixation detection for recordings of any length and for live streams, chunk by chunk.

The chunks contain the same fixations as the whole recording classified at once. A chunk is complete when later samples
can no longer change it: it ends before the last fixation that may still be merged, and farther from the newest sample
than any filter reaches. One or two seconds of samples are held meanwhile.
"""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, bools, floats, ints
from higvf_interfaces.gaze.fixations import IVT, PX_PER_DEG, THRESHOLDS, Classified, classify

HORIZON = 0.3  # combined reach of gap filling, blink margin, merging and the speed window [s]
_TAIL = 1.0  # part of an ongoing fixation that is classified again to see whether it continues [s]
LONGEST = 65_536  # maximum number of samples held; a longer fixation is split


class Pixels(NamedTuple):
    """Gaze samples on the recording's screen: `time` (n,) [s], `points` (n, 2) [px], `valid` (n,)."""

    time: Floats
    points: Floats
    valid: Bools


NO_PIXELS = Pixels(floats([]), floats([], 0, 2), bools([]))


def classify_blocks(
    blocks: Iterable[Pixels], px_per_deg: float = PX_PER_DEG, method: str = IVT, longest: int = LONGEST
) -> Iterator[Classified]:
    """Yield the consecutive classified chunks of a recording; none is empty, and no fixation spans two chunks.

    Args:
        blocks: blocks of samples in order of time.
        px_per_deg: pixels per degree of visual angle.
        method: one of `fixations.METHODS`.
        longest: maximum number of samples held.
    """
    return (chunk for chunk in chunk_per_block(blocks, px_per_deg, method, longest) if chunk is not None)


def chunk_per_block(
    blocks: Iterable[Pixels], px_per_deg: float = PX_PER_DEG, method: str = IVT, longest: int = LONGEST
) -> Iterator[Classified | None]:
    """Like `classify_blocks`, but yield one item per block: None where no chunk is complete, plus a last item."""
    classifier = ChunkClassifier(px_per_deg, method, longest)
    yield from map(classifier.push, blocks)
    yield classifier.flush()


class ChunkClassifier:
    """Classifies a recording or a live stream block by block."""

    def __init__(self, px_per_deg: float = PX_PER_DEG, method: str = IVT, longest: int = LONGEST) -> None:
        """Start without samples; see `classify_blocks` for the arguments."""
        self._px_per_deg, self._method, self._longest = px_per_deg, method, longest
        self._held = Pixels(floats([]), floats([], 0, 2), bools([]))
        self._begin = 0  # earlier samples have been returned; they are context for the filters
        self._lasting = -math.inf  # time up to which the fixation at `begin` is known to last [s]

    def push(self, block: Pixels) -> Classified | None:
        """Add a block and return the chunk that it completes, if any."""
        self._held = held = _joined(self._held, block)
        begin = self._begin
        if not len(held.time):
            return None
        full = len(held.time) - begin >= self._longest
        if not full and self._goes_on():
            self._lasting = float(held.time[-1])
            return None
        found = classify(*held, self._px_per_deg, method=self._method, begin=begin)
        end = max(begin, _settled(found))
        if end == begin and full:
            end = int(np.searchsorted(held.time, held.time[-1] - HORIZON))  # pyright: ignore[reportUnknownArgumentType]
        self._lasting = float(held.time[-1]) if end == begin else -math.inf
        if end == begin:
            return None
        kept = int(np.searchsorted(held.time, held.time[end - 1] - HORIZON))  # pyright: ignore[reportUnknownArgumentType]
        self._held = Pixels(held.time[kept:], held.points[kept:], held.valid[kept:])
        self._begin = end - kept
        return _chunk(found, begin, end)

    def flush(self) -> Classified | None:
        """Return the remaining samples as a chunk, as if the recording ended here."""
        held, begin = self._held, self._begin
        if len(held.time) <= begin:
            return None
        found = classify(*held, self._px_per_deg, method=self._method, begin=begin)
        return _chunk(found, begin, len(held.time))

    def _goes_on(self) -> bool:
        """Return whether the held fixation lasts through the new samples.

        Only its last second and the new samples are classified, so the cost of a long fixation is linear in its length.
        """
        held = self._held
        tail = int(np.searchsorted(held.time, self._lasting - _TAIL))
        if tail <= self._begin:
            return False
        found = classify(held.time[tail:], held.points[tail:], held.valid[tail:], self._px_per_deg, method=self._method)
        if not len(found.first):
            return False
        first, last = found.time[[found.first[0], found.last[0]]]
        return bool(first <= self._lasting - HORIZON and last >= held.time[-1] - HORIZON)


def _joined(first: Pixels, then: Pixels) -> Pixels:
    return Pixels(
        floats(np.concatenate([first.time, then.time])),
        floats(np.concatenate([first.points, then.points])),
        bools(np.concatenate([first.valid, then.valid])),
    )


def _settled(found: Classified) -> int:
    """Return the number of samples that later ones can no longer change."""
    time = found.time
    near = int(np.searchsorted(time, time[-1] - HORIZON))  # pyright: ignore[reportUnknownArgumentType]
    complete = int(np.searchsorted(found.last, near))  # number of fixations that end before
    if complete < len(found.first):
        near = min(near, int(found.first[complete]))
    if complete and near and time[near - 1] - time[found.last[complete - 1]] <= THRESHOLDS.merge_time:
        near = int(found.first[complete - 1])  # a later fixation may still be merged with it
    return near


def _chunk(found: Classified, begin: int, end: int) -> Classified:
    """Return the samples from `begin` to `end` (exclusive) and their fixations."""
    inside = slice(begin, end)
    mine = found.first < end
    return Classified(
        time=found.time[inside],
        points=found.points[inside],
        seen=found.seen[inside],
        steady=found.steady[inside],
        fixating=found.fixating[inside],
        first=ints(found.first[mine] - begin),
        last=ints(np.minimum(found.last[mine], end - 1) - begin),
    )
