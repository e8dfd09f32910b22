"""A decoder feed handles the part of a recording before the session."""

from collections.abc import Sequence

import numpy as np

from higvf_interfaces.decoding.replay import DecoderFeed
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import CHUNK, SignalChunk, SignalRecord, sliced

TIMES = np.arange(5000) / 50.0
RECORD = SignalRecord(("C3",), ("",), 50.0, 0.0, "test", [], lambda: sliced(TIMES, TIMES[:, None]))


class Counter:
    """A decoder that decides the number of samples since its creation after each chunk."""

    labels: Sequence[str] = ("any",)

    def __init__(self) -> None:
        self.had = 0

    def push(self, chunk: SignalChunk) -> list[Decision]:
        self.had += len(chunk.times)
        return [Decision(float(chunk.times[-1]), str(self.had), 1.0)] if len(chunk.times) else []

    def restart(self) -> None:
        self.had = 0


def told(feed: DecoderFeed, times: Sequence[float]) -> list[tuple[float, str]]:
    return [(due.decision.time, due.decision.label) for time in times for due in feed.due(time)]


def test_samples_before_the_session_are_decoded_once_when_opening() -> None:
    decoder = Counter()
    feed = DecoderFeed(RECORD, decoder, (), -60.25)
    assert 60.25 * 50 - CHUNK < decoder.had <= 60.25 * 50
    polls = np.arange(0.02, 3.0, 0.02).tolist()
    first = told(feed, polls)
    assert first[0][0] >= 0.0
    assert int(first[-1][1]) == round((60.25 + first[-1][0]) * 50) + 1
    assert told(feed, polls) == first


def test_a_recording_entirely_before_the_session_has_ended() -> None:
    assert DecoderFeed(RECORD, Counter(), (), -200.0).ended
