"""Fixations of a recording of any length: classifies it chunk by chunk, with the fixations that the whole would give.

A chunk is handed out when later samples can no longer change it: behind the last fixation that might still be merged
with what follows, and further from the newest sample than any filter looks. What is held meanwhile is a second or two.
"""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, Floats, bools, floats, ints
from higvf_interfaces.gaze.fixations import IVT, PX_PER_DEG, THRESHOLDS, Classified, classify

HORIZON = 0.3  # as far as gap filling, blink margin, merging and the window of speed reach together [s]
_TAIL = 1.0  # of a lasting fixation is enough to see it go on [s]
LONGEST = 65_536  # samples held; a fixation that is longer is cut


class Pixels(NamedTuple):
    """Samples on the recording's screen: `time` (n,) [s], `points` (n, 2) [px], `valid` (n,)."""

    time: Floats
    points: Floats
    valid: Bools


NO_PIXELS = Pixels(floats([]), floats([], 0, 2), bools([]))


def classify_blocks(
    blocks: Iterable[Pixels], px_per_deg: float = PX_PER_DEG, method: str = IVT, longest: int = LONGEST
) -> Iterator[Classified]:
    """Pieces of a recording that follow one another, none empty, no fixation in two of them.

    Args:
        blocks: the recording, in order of time.
        px_per_deg: pixels in one degree of visual angle.
        method: as `fixations.classify` takes it.
        longest: samples held at most.
    """
    return (chunk for chunk in chunk_per_block(blocks, px_per_deg, method, longest) if chunk is not None)


def chunk_per_block(
    blocks: Iterable[Pixels], px_per_deg: float = PX_PER_DEG, method: str = IVT, longest: int = LONGEST
) -> Iterator[Classified | None]:
    """As `classify_blocks`, with None for each block that settles nothing: an item costs one block of reading."""
    classifier = ChunkClassifier(px_per_deg, method, longest)
    yield from map(classifier.push, blocks)
    yield classifier.flush()


class ChunkClassifier:
    """Cuts a recording, or a live stream, into chunks block by block."""

    def __init__(self, px_per_deg: float = PX_PER_DEG, method: str = IVT, longest: int = LONGEST) -> None:
        """Holds nothing yet; the arguments are those of `classify_blocks`."""
        self._px_per_deg, self._method, self._longest = px_per_deg, method, longest
        self._held = Pixels(floats([]), floats([], 0, 2), bools([]))
        self._begin = 0  # samples before have been handed out; they are the filters' left side
        self._lasting = -math.inf  # until when the fixation at `begin` is known to go on [s]

    def push(self, block: Pixels) -> Classified | None:
        """What the next samples have settled, if anything."""
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
            end = int(np.searchsorted(held.time, held.time[-1] - HORIZON))
        self._lasting = float(held.time[-1]) if end == begin else -math.inf
        if end == begin:
            return None
        kept = int(np.searchsorted(held.time, held.time[end - 1] - HORIZON))
        self._held = Pixels(held.time[kept:], held.points[kept:], held.valid[kept:])
        self._begin = end - kept
        return _chunk(found, begin, end)

    def flush(self) -> Classified | None:
        """What is held and not settled, as if nothing followed."""
        held, begin = self._held, self._begin
        if len(held.time) <= begin:
            return None
        found = classify(*held, self._px_per_deg, method=self._method, begin=begin)
        return _chunk(found, begin, len(held.time))

    def _goes_on(self) -> bool:
        """Whether the fixation that is held lasts through all that is new, told by its last second and the new alone.

        So a stare costs what its samples cost, and not their square.
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
    """How many of the samples no later one can change."""
    time = found.time
    near = int(np.searchsorted(time, time[-1] - HORIZON))
    complete = int(np.searchsorted(found.last, near))  # fixations that ended before
    if complete < len(found.first):
        near = min(near, int(found.first[complete]))
    if complete and near and time[near - 1] - time[found.last[complete - 1]] <= THRESHOLDS.merge_time:
        near = int(found.first[complete - 1])  # what follows may still be merged with it
    return near


def _chunk(found: Classified, begin: int, end: int) -> Classified:
    """The samples from `begin` to `end` and the fixations that end among them."""
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
