"""Fixations of a recording of any length: classifies it piece by piece, with the fixations that the whole would give.

A piece is handed out when later samples can no longer change it: behind the last fixation that might still be merged
with what follows, and further from the newest sample than any filter looks. What is held meanwhile is a second or two.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from higvf_console.arrays import Bools, Floats, bools, floats, ints
from higvf_interfaces.fixations import IVT, PX_PER_DEG, THRESHOLDS, Classified, classify

HORIZON = 0.3  # as far as gap filling, blink margin, merging and the window of speed reach together [s]
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
    maker = PieceMaker(px_per_deg, method, longest)
    for block in blocks:
        piece = maker.push(block)
        if piece is not None:
            yield piece
    rest = maker.rest()
    if rest is not None:
        yield rest


class PieceMaker:
    """Cuts a recording, or a live stream, into pieces block by block."""

    def __init__(self, px_per_deg: float = PX_PER_DEG, method: str = IVT, longest: int = LONGEST) -> None:
        """Holds nothing yet; the arguments are those of `classify_blocks`."""
        self._px_per_deg, self._method, self._longest = px_per_deg, method, longest
        self._held = Pixels(floats([]), floats([], 0, 2), bools([]))
        self._begin = 0  # samples before have been handed out; they are the filters' left side

    def push(self, block: Pixels) -> Classified | None:
        """What the next samples have settled, if anything."""
        self._held = held = _joined(self._held, block)
        begin = self._begin
        if not len(held.time):
            return None
        found = classify(*held, self._px_per_deg, method=self._method, begin=begin)
        end = max(begin, _settled(found))
        if end == begin and len(held.time) - begin >= self._longest:
            end = int(np.searchsorted(held.time, held.time[-1] - HORIZON))
        if end == begin:
            return None
        kept = int(np.searchsorted(held.time, held.time[end - 1] - HORIZON))
        self._held = Pixels(held.time[kept:], held.points[kept:], held.valid[kept:])
        self._begin = end - kept
        return _piece(found, begin, end)

    def rest(self) -> Classified | None:
        """What is held and not settled, as if nothing followed."""
        held, begin = self._held, self._begin
        if len(held.time) <= begin:
            return None
        found = classify(*held, self._px_per_deg, method=self._method, begin=begin)
        return _piece(found, begin, len(held.time))


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


def _piece(found: Classified, begin: int, end: int) -> Classified:
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
