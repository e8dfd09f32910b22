"""Reader of one Lab Streaming Layer stream on its own thread, with clock correction and reconnection.

    network -> inlet -> reader thread -> bounded queue -> poll

A time-out of `pull_sample` does not distinguish a silent device from a lost one. The reader therefore keeps its own
sign of life: the newest sample of a stream with a rate; for an event stream, an answer of the network. Times are on
this machine's LSL clock (`proc_clocksync`); a device that stamps by another clock is joined on (`ArrivalClock`).
"""

import threading
import time
from collections import deque
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NamedTuple
from xml.etree import ElementTree as ET

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.options import word
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.clock import RESTART
from higvf_interfaces.formats.common_clock import ArrivalClock

SOURCE = "lsl"  # source of a live input: --input gaze=lsl:name=...
OPTIONS = ("name", "type", "source_id", "host", "within")
CAPACITY = 65_536  # samples that wait at most; the oldest go first
WITHIN = 3.0  # a stream must be found within [s]
_WAIT = 0.1  # for a sample, before the thread looks after the stream again [s]
_WAVE = 1.0  # in which the devices of a network answer [s]
_FORGOTTEN = 1.0  # the network no longer answers for a stream of events [s]
_BUFFERED = 60  # [s] of a stream with a rate, [100 samples] of another, kept by the library


class LslSample(NamedTuple):
    """A sample: `time` on this machine's LSL clock [s] and the values of its channels."""

    time: float
    values: Sequence[Any]


class StreamQuery(NamedTuple):
    """Search criteria for a stream; an empty criterion matches every stream."""

    name: str = ""
    type: str = ""
    source_id: str = ""
    host: str = ""

    def fits(self, info: Any) -> bool:
        """Return whether a stream on the network meets all criteria."""
        found = (info.name(), info.type(), info.source_id(), info.hostname())
        return all(not want or want.casefold() == word.casefold() for want, word in zip(self, found, strict=True))


def is_live(spec: InputSpec, recorded: Sequence[str]) -> bool:
    """Return whether an input's source is the Lab Streaming Layer rather than a file.

    Args:
        spec: the input.
        recorded: options that apply to recordings only.

    Raises:
        InputError: If a file comes with an option for live streams, or a live stream with an option for recordings.
    """
    live = spec.source.strip().casefold() == SOURCE
    for key in recorded if live else OPTIONS:
        if key in spec.options:
            reason = (
                f"{key} is for recordings, and this is a live stream; give a file in its place"
                if live
                else f"{key} chooses a live stream, and this is a file; give {SOURCE} in its place"
            )
            raise InputError(f"input {spec.channel}={spec.source}: {reason}, or leave {key} out")
    return live


def library() -> Any:
    """Import the module `pylsl`.

    Raises:
        InputError: If it is not installed or its library cannot be loaded.
    """
    try:
        return import_module("pylsl")
    except (ImportError, OSError, RuntimeError) as problem:
        raise InputError(f"live streams need pylsl: pip install 'higvf-console[lsl]' ({problem})") from problem


def query_of(options: Fields, usual: StreamQuery) -> StreamQuery:
    """Return the search criteria of the options, or `usual` if none is set.

    Raises:
        InputError: If a value is not text.
    """
    given = {key: word(options, key) for key in StreamQuery._fields if options.has(key)}
    return StreamQuery(**given) if given else usual


class LslReader:
    """Reads a stream on its own thread until closed.

    Attributes:
        labels: labels of the channels; empty if unknown.
        header: metadata of the stream, as XML.
        rate: nominal sampling rate [Hz]; 0 for an event stream.
        channels: number of channels.
        name: summary of the stream for messages.
        lost: number of losses so far.
    """

    def __init__(self, query: StreamQuery, place: str, within: float = WITHIN, capacity: int = CAPACITY) -> None:
        """Find the stream and start reading.

        Args:
            query: search criteria.
            place: prefix of error messages.
            within: time limit of the search [s].
            capacity: maximum number of queued samples.

        Raises:
            InputError: If no stream or several match; the message lists the streams on the network.
        """
        self._lsl = library()
        self._gone: type[RuntimeError] = import_module("pylsl.util").LostError
        self._info = _find(self._lsl, query, place, within)
        self._inlet = self._opened(self._info)
        full = self._inlet.info(within)
        self.header = ET.fromstring(full.as_xml())
        self.rate, self.channels = float(full.nominal_srate()), int(full.channel_count())
        described = self.header.findall("desc/channels/channel")[: self.channels]
        self.labels = tuple((channel.findtext("label") or "").strip() for channel in described)
        self.name = stream_summary(full)
        self.lost = 0
        self._clock = ArrivalClock(float(_BUFFERED), RESTART if self.rate else float(_BUFFERED))
        self._waiting: deque[LslSample] = deque(maxlen=capacity)
        self._alive: float | None = None  # [s] of the LSL clock
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._read, name=f"lsl {full.name()}", daemon=True)
        self._thread.start()

    @property
    def now(self) -> float:
        """This machine's LSL clock [s]."""
        return float(self._lsl.local_clock())

    @property
    def quiet(self) -> float | None:
        """Time since the last sign of life [s]; None before the first."""
        return None if self._alive is None else max(0.0, self.now - self._alive)

    @property
    def notes(self) -> tuple[str, ...]:
        """The stream and the number of losses."""
        return (self.name, *((f"lost {self.lost} times",) if self.lost else ()), *self._clock.notes)

    def take(self) -> list[LslSample]:
        """Return the samples received since the last call, without waiting."""
        taken: list[LslSample] = []
        for _ in range(len(self._waiting)):
            taken.append(self._waiting.popleft())
        return taken

    def close(self) -> None:
        """Stop the thread; may be called twice."""
        if not self._stopping.is_set():
            self._stopping.set()
            self._thread.join(2.0)

    def _opened(self, info: Any) -> Any:
        flags = self._lsl.proc_clocksync  # not proc_monotonize: it holds the time still after a clock was set back
        inlet = self._lsl.StreamInlet(info, max_buflen=_BUFFERED, recover=False, processing_flags=flags)
        inlet.open_stream(timeout=WITHIN)
        inlet.time_correction(timeout=WITHIN)  # otherwise the first sample would wait for it
        return inlet

    def _read(self) -> None:
        presence = self._presence()
        while not self._stopping.is_set():
            try:
                self._pull(presence)
            except self._gone:
                self.lost += 1
                self._find_again(presence)
            except RuntimeError:  # raised by the library while a connection breaks
                self._stopping.wait(_WAIT)
        self._inlet.close_stream()

    def _pull(self, presence: Any) -> None:
        values, at = self._inlet.pull_sample(timeout=_WAIT)
        if at is not None:
            more, times = self._inlet.pull_chunk(timeout=0.0, max_samples=1024)
            self._alive = now = self.now
            for stamp, sample in zip((at, *times), (values, *more), strict=True):
                self._waiting.append(LslSample(self._clock.time(float(stamp), now), sample))
        elif not self.rate and presence.results():
            self._alive = self.now

    def _presence(self) -> Any:
        """Return a resolver that queries the network for the device by source id, or by name if it has none."""
        source, forget = self._info.source_id(), {"forget_after": _FORGOTTEN}
        if source:
            return self._lsl.ContinuousResolver("source_id", source, **forget)
        return self._lsl.ContinuousResolver("name", self._info.name(), **forget)

    def _find_again(self, presence: Any) -> None:
        """Wait until the same device is back, and reconnect."""
        while not self._stopping.wait(_WAIT):
            for info in presence.results():
                if info.uid() == self._info.uid() or not self._same_kind(info):
                    continue
                try:
                    self._inlet, self._info = self._opened(info), info
                except RuntimeError:  # lost again, or too slow to open
                    continue
                return

    def _same_kind(self, info: Any) -> bool:
        return info.type() == self._info.type() and info.channel_count() == self._info.channel_count()


def _find(lsl: Any, query: StreamQuery, place: str, within: float) -> Any:
    deadline = time.monotonic() + within
    known: dict[str, Any] = {}
    while True:
        known |= {info.uid(): info for info in lsl.resolve_streams(wait_time=_WAVE)}
        found = list(known.values())
        fit = [info for info in found if query.fits(info)]
        if len({info.source_id() or info.uid() for info in fit}) == 1:
            return fit[-1]
        if fit or time.monotonic() >= deadline:
            break
    asked = ", ".join(f"{key}={value}" for key, value in query._asdict().items() if value) or "any stream"
    listed = "; ".join(sorted(stream_summary(info) for info in found)) or "none"
    way_out = "; choose one by name, type, source_id, host" if fit else ""
    raise InputError(f"{place}: {len(fit)} live streams fit {asked}{way_out}; found on the network: {listed}")


def stream_summary(info: Any) -> str:
    """Return name, type, source, host, channels and rate of a stream, for messages."""
    rate = f"{info.nominal_srate():g} Hz" if info.nominal_srate() else "events"
    source = f", source_id {info.source_id()}" if info.source_id() else ""
    channels = f"{info.channel_count()} channels" if info.channel_count() != 1 else "1 channel"
    return f"name {info.name()}, type {info.type()}{source}, host {info.hostname()} ({channels}, {rate})"
