"""What a decoder of raw signals owes, and the window that all of them look through."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import SignalChunk


class Decoder(Protocol):
    """Turns a stream of samples into decisions; the same whatever the chunks are, live or replayed."""

    @property
    def labels(self) -> Sequence[str]:
        """Every label that it can give."""
        ...

    def push(self, chunk: SignalChunk) -> list[Decision]:
        """Decisions that the next samples complete; the time of each is that of the last sample it rests on."""
        ...

    def restart(self) -> None:
        """Forgets the samples, because the stream starts again."""
        ...


class Trial(NamedTuple):
    """A stretch of a recording in which the person was to do one thing: `label` from `start` to `end` [s]."""

    label: str
    start: float
    end: float


class Window(NamedTuple):
    """The samples that one decision rests on: `values` (n, c), the last of them at `time` [s]."""

    time: float
    values: Floats


class SlidingWindow:
    """Cuts a stream into overlapping windows."""

    def __init__(self, length: int, hop: int) -> None:
        """Windows of `length` samples, one every `hop` samples."""
        self._length, self._hop = length, hop
        self.restart()

    def restart(self) -> None:
        """Forgets the samples."""
        self._times: Floats = np.zeros(0)
        self._values: Floats | None = None

    def push(self, chunk: SignalChunk) -> Iterator[Window]:
        """Windows that the next samples complete."""
        held = self._values
        values = chunk.values if held is None else np.concatenate([held, chunk.values])
        times = np.concatenate([self._times, chunk.times])
        start = 0
        while start + self._length <= len(times):
            stop = start + self._length
            yield Window(float(times[stop - 1]), values[start:stop])
            start += self._hop
        self._times, self._values = times[start:], values[start:]
