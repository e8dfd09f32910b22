"""Protocol of decoders of raw signals, with the trials and sliding windows that decoders share."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import SignalChunk


class Decoder(Protocol):
    """Turns a stream of samples into decisions; the decisions must not depend on the division into chunks."""

    @property
    def labels(self) -> Sequence[str]:
        """All labels that the decoder can give."""
        ...

    def push(self, chunk: SignalChunk) -> list[Decision]:
        """Return the decisions completed by the next samples; each has the time of its last sample."""
        ...

    def restart(self) -> None:
        """Clear the state, because the stream starts again."""
        ...


class Trial(NamedTuple):
    """A cued interval of a recording: the person was to perform `label` from `start` to `end` [s]."""

    label: str
    start: float
    end: float


class Window(NamedTuple):
    """The samples of one decision: `values` (n, c), the last at `time` [s]."""

    time: float
    values: Floats


class SlidingWindow:
    """Divides a stream into overlapping windows."""

    def __init__(self, length: int, hop: int) -> None:
        """Set a window of `length` samples every `hop` samples."""
        self._length, self._hop = length, hop
        self.restart()

    def restart(self) -> None:
        """Clear the state."""
        self._times: Floats = np.zeros(0)
        self._values: Floats | None = None

    def push(self, chunk: SignalChunk) -> Iterator[Window]:
        """Yield the windows completed by the next samples."""
        held = self._values
        values = chunk.values if held is None else np.concatenate([held, chunk.values])
        times = np.concatenate([self._times, chunk.times])
        start = 0
        while start + self._length <= len(times):
            stop = start + self._length
            yield Window(float(times[stop - 1]), values[start:stop])
            start += self._hop
        self._times, self._values = times[start:], values[start:]
