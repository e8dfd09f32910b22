"""Live decision feeds: markers from an external decoder, or raw signals decoded here.

The session time of a sample is the current session time minus the sample's age on the LSL clock.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Protocol

from higvf_console.core.arrays import floats
from higvf_interfaces.decisions.feeds import DecisionFeed, Due
from higvf_interfaces.decisions.options import words
from higvf_interfaces.decoding.contract import Decoder
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.clock import Repairs
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import SignalChunk, SignalRecord, signal_places, unique_names
from higvf_interfaces.formats.xdf.file import channel_texts
from higvf_interfaces.formats.xdf.markers import decision_of, label_of, several_texts
from higvf_interfaces.live.lsl import WITHIN, LslReader, StreamQuery, query_of
from higvf_interfaces.streams import RunClock

MARKERS = StreamQuery(type="Markers")


class LiveFeed(DecisionFeed, Protocol):
    """A decision feed that reads a live stream."""

    @property
    def reader(self) -> LslReader:
        """The reader of the stream."""
        ...


class _SessionClock:
    """Session times of a live stream's decisions: non-decreasing, and 0 for decisions before the run."""

    def __init__(self) -> None:
        self._latest, self._run = 0.0, RunClock()

    def at(self, now: float, ago: float) -> float:
        if self._run.was_reset(now):
            self._latest = 0.0
        self._latest = min(now, max(self._latest, now - max(0.0, ago)))
        return self._latest


class MarkerFeed:
    """Feed of the labels of a live marker stream."""

    ended = False

    def __init__(self, reader: LslReader) -> None:
        """Read the markers of a stream."""
        self.reader = reader
        self.labels: Sequence[str] = ()
        self._clock = _SessionClock()
        self._count = 0

    @property
    def notes(self) -> Sequence[str]:
        """Notes on the stream."""
        return (*self.reader.notes, *several_texts(self.reader.channels))

    @property
    def started(self) -> bool:
        """Whether the stream has shown a sign of life."""
        return self.reader.quiet is not None

    def due(self, now: float) -> list[Due]:
        """Return the decisions received since the last call, at session times up to `now` [s]."""
        given: list[Due] = []
        for sample in self.reader.take():
            decision = decision_of(self._clock.at(now, self.reader.now - sample.time), label_of(list(sample.values)))
            if decision is not None:
                given.append(Due(self._count, decision))
                self._count += 1
        return given


class LiveDecoderFeed:
    """Feed of the decisions of a decoder on a live signal."""

    ended = False

    def __init__(self, reader: LslReader, decoder: Decoder, columns: Sequence[int], notes: Sequence[str]) -> None:
        """Pass the channels `columns` of a stream to `decoder`."""
        self.reader, self._decoder, self._columns, self._decoder_notes = reader, decoder, list(columns), tuple(notes)
        self.labels: Sequence[str] = decoder.labels
        self._clock = _SessionClock()
        self._latest, self._lost, self._count = -math.inf, 0, 0

    @property
    def notes(self) -> Sequence[str]:
        """Notes on the decoder's calibration and on the stream."""
        return (*self._decoder_notes, *self.reader.notes)

    @property
    def started(self) -> bool:
        """Whether the stream has shown a sign of life."""
        return self.reader.quiet is not None

    def due(self, now: float) -> list[Due]:
        """Return the decisions completed since the last call, at session times up to `now` [s]."""
        if self.reader.lost != self._lost:
            self._lost = self.reader.lost
            self._decoder.restart()
        samples = [sample for sample in self.reader.take() if sample.time > self._latest]
        if not samples:
            return []
        times = floats([sample.time for sample in samples])
        kept = Repairs().advancing(times)
        self._latest = float(times[kept][-1])
        values = floats([sample.values for sample in samples], -1, self.reader.channels)[kept][:, self._columns]
        return [self._due(decision, now) for decision in self._decoder.push(SignalChunk(times[kept], floats(values)))]

    def _due(self, decision: Decision, now: float) -> Due:
        self._count += 1
        return Due(self._count - 1, decision._replace(time=self._clock.at(now, self.reader.now - decision.time)))


def live_feed(options: Fields) -> LiveFeed:
    """Open the live feed that an input's options describe: markers, or raw signals with the option `decoder`.

    Raises:
        InputError: If no stream or several match, or an option is invalid.
    """
    within = options.number("within", WITHIN, 0.1, 3600.0, "s")
    if not options.has("decoder"):
        return MarkerFeed(LslReader(query_of(options, MARKERS), options.place, within))
    from higvf_interfaces.decoding.replay import make_decoder  # noqa: PLC0415 - filters load for a second

    reader = LslReader(query_of(options, StreamQuery(type="EEG")), options.place, within)
    try:
        if not reader.rate:
            options.fail(f"a decoder needs a stream with a rate, not {reader.name}")
        named = len(reader.labels) == reader.channels and all(reader.labels)
        names = unique_names(reader.labels if named else [""] * reader.channels)
        columns = _columns(names, words(options), options)
        chosen = tuple(names[column] for column in columns)
        units = channel_texts(reader.header, "unit", reader.channels)
        record = SignalRecord(
            chosen, tuple(units[column] for column in columns), reader.rate, 0.0, "lsl", [], _no_chunks
        )
        decoder, notes = make_decoder("", record, options)
    except Exception:
        reader.close()
        raise
    return LiveDecoderFeed(reader, decoder, columns, notes)


def _columns(names: Sequence[str], wanted: Sequence[str], options: Fields) -> list[int]:
    places = {name.casefold(): place for place, name in enumerate(names)}
    missing = [name for name in wanted if name.casefold() not in places]
    if missing:
        options.fail(f"channels: there is no channel {missing[0]!r}; the stream has: {', '.join(names)}")
    return [places[name.casefold()] for name in wanted] or signal_places(names)


def _no_chunks() -> Iterator[SignalChunk]:
    return iter(())
