"""One stream of the Lab Streaming Layer, read on a thread of its own: found, clock-corrected, watched, found again.

    network -> inlet -> reader thread -> bounded queue -> poll

`pull_sample` gives nothing on a time-out whether the device is quiet or dead, so the watch is ours: a stream with a
rate is as alive as its newest sample, one of events is alive while the network still answers for it. Times come on this
machine's LSL clock (`proc_clocksync`), never decreasing.
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

SOURCE = "lsl"  # of an input: --input gaze=lsl:name=...
OPTIONS = ("name", "type", "source_id", "host", "within")
CAPACITY = 65_536  # samples that wait at most; the oldest go first
WITHIN = 3.0  # a stream must be found within [s]
_WAIT = 0.1  # for a sample, before the thread looks after the stream again [s]
_WAVE = 1.0  # in which the devices of a network answer [s]
_FORGOTTEN = 1.0  # the network no longer answers for a stream of events [s]
_BUFFERED = 60  # [s] of a stream with a rate, [100 samples] of another, kept by the library


class LslSample(NamedTuple):
    """A sample: `time` on this machine's LSL clock [s], and the values of its channels."""

    time: float
    values: Sequence[Any]


class StreamQuery(NamedTuple):
    """Which stream is wanted; an empty word fits every stream."""

    name: str = ""
    type: str = ""
    source_id: str = ""
    host: str = ""

    def fits(self, info: Any) -> bool:
        """Whether a stream found on the network is one that is wanted."""
        said = (info.name(), info.type(), info.source_id(), info.hostname())
        return all(not wish or wish.casefold() == word.casefold() for wish, word in zip(self, said, strict=True))


def is_live(spec: InputSpec, recorded: Sequence[str]) -> bool:
    """Whether an input's source is the Lab Streaming Layer rather than a file.

    Args:
        spec: the input.
        recorded: its options that mean nothing to a live stream.

    Raises:
        InputError: it is a file, and beside it stands an option that chooses a stream; or the other way round.
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
    """The module `pylsl`.

    Raises:
        InputError: it is not installed, or its library cannot be loaded.
    """
    try:
        return import_module("pylsl")
    except (ImportError, OSError, RuntimeError) as problem:
        raise InputError(f"live streams need pylsl: pip install 'higvf-console[lsl]' ({problem})") from problem


def query_of(options: Fields, usual: StreamQuery) -> StreamQuery:
    """What the options `OPTIONS` say; `usual` where they say nothing at all.

    Raises:
        InputError: a value that is no word.
    """
    given = {key: word(options, key) for key in StreamQuery._fields if options.has(key)}
    return StreamQuery(**given) if given else usual


class LslReader:
    """A stream, read until it is closed.

    Attributes:
        labels: of the channels; empty where the stream does not say.
        header: what the stream says of itself, as XML.
        rate: nominal sampling rate [Hz]; 0 for events.
        channels: how many.
        name: the stream, as messages call it.
        lost: how often the stream has been lost so far.
    """

    def __init__(self, wish: StreamQuery, place: str, within: float = WITHIN, capacity: int = CAPACITY) -> None:
        """Finds the stream and begins to read.

        Args:
            wish: which one.
            place: how messages call the input.
            within: how long to look [s].
            capacity: samples that wait at most.

        Raises:
            InputError: there is none, or several fit; the message lists what there is.
        """
        self._lsl = library()
        self._gone: type[RuntimeError] = import_module("pylsl.util").LostError
        self._info = _find(self._lsl, wish, place, within)
        self._inlet = self._opened(self._info)
        full = self._inlet.info(within)
        self.header = ET.fromstring(full.as_xml())
        self.rate, self.channels = float(full.nominal_srate()), int(full.channel_count())
        described = self.header.findall("desc/channels/channel")[: self.channels]
        self.labels = tuple((channel.findtext("label") or "").strip() for channel in described)
        self.name = stream_summary(full)
        self.lost = 0
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
        """For how long there has been no sign of life [s]; None before the first."""
        return None if self._alive is None else max(0.0, self.now - self._alive)

    @property
    def notes(self) -> tuple[str, ...]:
        """The stream, and how often it has been lost."""
        return (self.name, *((f"lost {self.lost} times",) if self.lost else ()))

    def take(self) -> list[LslSample]:
        """The samples that have come since the last call; returns at once."""
        taken: list[LslSample] = []
        for _ in range(len(self._waiting)):
            taken.append(self._waiting.popleft())
        return taken

    def close(self) -> None:
        """Ends the thread; may be called twice."""
        if not self._stopping.is_set():
            self._stopping.set()
            self._thread.join(2.0)

    def _opened(self, info: Any) -> Any:
        flags = self._lsl.proc_clocksync | self._lsl.proc_monotonize
        inlet = self._lsl.StreamInlet(info, max_buflen=_BUFFERED, recover=False, processing_flags=flags)
        inlet.open_stream(timeout=WITHIN)
        inlet.time_correction(timeout=WITHIN)  # else the first sample waits for it
        return inlet

    def _read(self) -> None:
        presence = self._presence()
        while not self._stopping.is_set():
            try:
                self._pull(presence)
            except self._gone:
                self.lost += 1
                self._find_again(presence)
            except RuntimeError:  # the library's own, while a stream breaks off
                self._stopping.wait(_WAIT)
        self._inlet.close_stream()

    def _pull(self, presence: Any) -> None:
        values, at = self._inlet.pull_sample(timeout=_WAIT)
        if at is not None:
            more, times = self._inlet.pull_chunk(timeout=0.0, max_samples=1024)
            self._waiting.append(LslSample(float(at), values))
            self._waiting.extend(LslSample(float(t), sample) for t, sample in zip(times, more, strict=True))
            self._alive = self.now
        elif not self.rate and presence.results():
            self._alive = self.now

    def _presence(self) -> Any:
        """Asks the network all the time for the device: by its source id, else by name and type."""
        source, forget = self._info.source_id(), {"forget_after": _FORGOTTEN}
        if source:
            return self._lsl.ContinuousResolver("source_id", source, **forget)
        return self._lsl.ContinuousResolver("name", self._info.name(), **forget)

    def _find_again(self, presence: Any) -> None:
        """Waits until the same device is back."""
        while not self._stopping.wait(_WAIT):
            for info in presence.results():
                if info.uid() == self._info.uid() or not self._same_kind(info):
                    continue
                try:
                    self._inlet, self._info = self._opened(info), info
                except RuntimeError:  # gone again, or too slow to open
                    continue
                return

    def _same_kind(self, info: Any) -> bool:
        return info.type() == self._info.type() and info.channel_count() == self._info.channel_count()


def _find(lsl: Any, wish: StreamQuery, place: str, within: float) -> Any:
    deadline = time.monotonic() + within
    known: dict[str, Any] = {}
    while True:
        known |= {info.uid(): info for info in lsl.resolve_streams(wait_time=_WAVE)}
        found = list(known.values())
        fit = [info for info in found if wish.fits(info)]
        if len({info.source_id() or info.uid() for info in fit}) == 1:
            return fit[-1]
        if fit or time.monotonic() >= deadline:
            break
    asked = ", ".join(f"{key}={value}" for key, value in wish._asdict().items() if value) or "any stream"
    listed = "; ".join(sorted(stream_summary(info) for info in found)) or "none"
    way_out = "; choose one by name, type, source_id, host" if fit else ""
    raise InputError(f"{place}: {len(fit)} live streams fit {asked}{way_out}; found on the network: {listed}")


def stream_summary(info: Any) -> str:
    """A stream as messages list it: name, type, source, host, channels, rate."""
    rate = f"{info.nominal_srate():g} Hz" if info.nominal_srate() else "events"
    source = f", source_id {info.source_id()}" if info.source_id() else ""
    channels = f"{info.channel_count()} channels" if info.channel_count() != 1 else "1 channel"
    return f"name {info.name()}, type {info.type()}{source}, host {info.hostname()} ({channels}, {rate})"
