"""Plausibility of several clocks: those of streams recorded together, and that of a live device.

Streams of one recording overlap, and a live sample arrives soon after its stamp; what differs more has another clock.
"""

import math
from collections.abc import Sequence

from higvf_interfaces.formats.clock import counted, is_time
from higvf_interfaces.formats.records import EPOCH_FROM

_AHEAD = 10.0  # no sample is stamped farther in the future [s]
APART_AT_ALL = 60.0  # streams recorded together that lie farther apart may have different clocks [s]
APART = EPOCH_FROM  # no streams recorded together lie farther apart [s]


class ArrivalClock:
    """Checks the stamps of a live stream against their arrival; a clock that differs is joined on at its arrival."""

    def __init__(self, earliest: float, restart: float) -> None:
        """Start with the device's clock as it is.

        Args:
            earliest: greatest plausible age of a sample that arrives [s].
            restart: a larger step back is a clock restart [s].
        """
        self._earliest, self._restart = earliest, restart
        self._offset = self._apart = 0.0
        self._latest = -math.inf
        self._joined = self._untimed = 0

    def time(self, stamp: float, now: float) -> float:
        """Return the time of a sample stamped `stamp` that arrives at `now`, both on this machine's clock [s]."""
        if not is_time(stamp):
            self._untimed += 1
            return now
        time = stamp + self._offset
        if not -_AHEAD <= now - time <= self._earliest or time < self._latest - self._restart:
            self._apart = max(self._apart, abs(now - time))
            self._offset, time = now - stamp, now
            self._joined += 1
        self._latest = time
        return time

    @property
    def notes(self) -> tuple[str, ...]:
        """The repairs so far."""
        repairs = (
            (self._untimed, f"{counted(self._untimed, 'sample')} without a time: arrival used"),
            (
                self._joined,
                f"its clock was {self._apart:.0f} s off this machine's: joined {counted(self._joined, 'time')}",
            ),
        )
        return tuple(text for count, text in repairs if count)


def on_one_clock(spans: Sequence[tuple[float, float]], chosen: int) -> list[int]:
    """Return which streams share the clock of stream `chosen`, itself included, in their order.

    Args:
        spans: first and last time of each stream [s]; NaN for an empty one, which shares every clock.
        chosen: index of a stream.
    """
    empty = {k for k, span in enumerate(spans) if math.isnan(span[0])}
    known = {chosen}
    while True:
        near = {k for k, span in enumerate(spans) if any(distance(span, spans[j]) <= APART for j in known)}
        if near <= known:
            return sorted(known | empty)
        known |= near


def distance(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Return the time between two spans (first, last) [s]; 0 if they overlap, NaN if one is empty."""
    return max(one[0] - other[1], other[0] - one[1], 0.0) if one[0] == one[0] and other[0] == other[0] else math.nan


def in_milliseconds(one: tuple[float, float], other: tuple[float, float]) -> bool:
    """Return whether two spans (first, last) would be near if one counted milliseconds."""
    slower, faster = sorted((one, other))
    return distance(slower, (faster[0] * 1e-3, faster[1] * 1e-3)) <= APART_AT_ALL
