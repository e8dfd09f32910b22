"""A decoder at work on a recording of which a part lies before the session."""

from collections.abc import Sequence

import numpy as np

from higvf_interfaces.decoding.replay import DecoderFeed
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.records import CHUNK, SignalChunk, SignalRecord, sliced

TIMES = np.arange(5000) / 50.0
RECORD = SignalRecord(("C3",), ("",), 50.0, 0.0, "test", [], lambda: sliced(TIMES, TIMES[:, None]))


class Counter:
    """Tells after each chunk how many samples it has had since it was made."""

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


def test_what_lies_before_the_session_is_decoded_before_it_begins_and_once_for_all_plays() -> None:
    decoder = Counter()
    feed = DecoderFeed(RECORD, decoder, (), -60.25)
    assert 60.25 * 50 - CHUNK < decoder.had <= 60.25 * 50
    polls = np.arange(0.02, 3.0, 0.02).tolist()
    first = told(feed, polls)
    assert first[0][0] >= 0.0
    assert int(first[-1][1]) == round((60.25 + first[-1][0]) * 50) + 1
    assert told(feed, polls) == first


def test_a_recording_that_lies_before_the_session_as_a_whole_has_ended() -> None:
    assert DecoderFeed(RECORD, Counter(), (), -200.0).ended
