"""Of a damaged XDF file, the intact part is read, and what was left out is said."""

import gzip
import struct
from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import whole
from higvf_interfaces.formats.text import look
from higvf_interfaces.formats.xdf.file import survey
from tests.interfaces.formats.xdf_files import BOUNDARY, Stream, xdf

Write = Callable[..., str]
TIMES = [100 + k / 100 for k in range(1000)]
EYES = Stream("Tobii", "Gaze", "g", 100, TIMES, [(float(k), 2.0) for k in range(1000)], ("x", "y"))
CUES = Stream("Cues", "Markers", "c", 0, [100.5, 101.5], ["fist", "open"])
WHOLE = xdf(EYES, CUES)


def chunks_of_samples(content: bytes) -> list[int]:
    """Index of the first byte of each chunk of samples but the last, which holds the markers."""
    starts = [content.index(BOUNDARY)]
    while (following := content.find(BOUNDARY, starts[-1] + 1)) >= 0:
        starts.append(following)
    return [place + len(BOUNDARY) for place in starts][:-2]


def test_a_footer_that_is_no_whole_number_hides_nothing(write: Write) -> None:
    content = WHOLE.replace(b"<sample_count>1000</sample_count>", b"<sample_count>1e03</sample_count>")
    assert content != WHOLE
    gaze = read_gaze(write(content))
    assert (len(gaze.time), gaze.notes) == (1000, ())


@pytest.mark.parametrize(
    ("intact", "broken"),
    [
        (b"<name>Cues</name>", b"<name>Cues<name> "),
        (b"<channel_count>1</channel_count>", b"<channel_count>0</channel_count>"),
        (b"<channel_format>string<", b"<channel_format>strinG<"),
    ],
)
def test_a_stream_with_a_damaged_header_hides_no_other(write: Write, intact: bytes, broken: bytes) -> None:
    content = WHOLE.replace(intact, broken)
    assert content != WHOLE
    file = write(content)
    gaze = read_gaze(file)
    assert len(gaze.time) == 1000
    assert any(note.startswith("stream 2 left out: ") for note in gaze.notes)
    with pytest.raises(InputError, match="has 0 event streams"):
        read_decisions(file)


def test_a_file_whose_only_header_is_damaged_is_refused_with_the_reason(write: Write) -> None:
    with pytest.raises(InputError, match="stream 1 left out: its header is damaged"):
        survey(look(write(xdf(CUES).replace(b"</info>", b"</inf>>"))).path)


@pytest.mark.parametrize("lost", [10, len(BOUNDARY), 500, 1500])
def test_a_chunk_that_was_cut_costs_only_its_own_samples(write: Write, lost: int) -> None:
    start = chunks_of_samples(WHOLE)[3]
    end = WHOLE.index(BOUNDARY, start)
    file = write(WHOLE[: end - lost] + WHOLE[end:])
    gaze = read_gaze(file)
    kept = np.delete(np.arange(1000), np.arange(400, 500))
    assert gaze.points[:, 0].tolist() == kept.tolist()
    assert gaze.time == pytest.approx(kept / 100, abs=1e-3)
    assert "1 damaged place skipped" in gaze.notes
    assert [decision.label for decision in read_decisions(file).decisions] == ["fist", "open"]


@pytest.mark.parametrize("garbage", [b"\x01\x00", b"\x00" * 40, b"\x09garbage", b"\x04\xff\xff\xff\xff\x03\x00"])
def test_reading_resumes_behind_garbage_at_the_next_boundary(write: Write, garbage: bytes) -> None:
    start = chunks_of_samples(WHOLE)[3]
    gaze = read_gaze(write(WHOLE[:start] + garbage + BOUNDARY + WHOLE[start:]))
    assert len(gaze.time) == 1000
    assert "1 damaged place skipped" in gaze.notes


def test_a_chunk_that_declares_other_samples_than_it_has_is_left_out(write: Write) -> None:
    start = chunks_of_samples(WHOLE)[3]
    count = start + 5 + 2 + 4 + 1  # behind the lengths, the tag and the number of the stream
    assert struct.unpack_from("<I", WHOLE, count) == (100,)
    gaze = read_gaze(write(WHOLE[:count] + struct.pack("<I", 3000) + WHOLE[count + 4 :]))
    assert len(gaze.time) == 900
    assert "1 damaged chunk of samples left out" in gaze.notes


def test_a_compressed_file_is_read_like_the_file(write: Write) -> None:
    file = write(gzip.compress(WHOLE), "a.xdfz")
    assert read_gaze(file).time == pytest.approx(read_gaze(write(WHOLE)).time)
    assert len(read_decisions(file).decisions) == 2
    cut = read_gaze(write(gzip.compress(WHOLE)[:-3000], "b.xdfz"))
    assert 100 < len(cut.time) < 1000
    assert any("truncated" in note for note in cut.notes)


def halves(gap: float, source: str = "m") -> bytes:
    """A device that was lost and found again: two streams that are alike."""
    first, second = [100 + k / 50 for k in range(250)], [105 + gap + k / 50 for k in range(250)]
    parts = [
        Stream("Muse", "EEG", source, 50, times, [(float(k + shift), 1.0) for k in range(250)], ("A", "B"))
        for shift, times in ((250, second), (0, first))
    ]
    return xdf(*parts, CUES)


def test_the_parts_of_a_stream_that_was_recorded_twice_are_joined(write: Write) -> None:
    record = read_signals(write(halves(20.0)))
    times, values = whole(record)
    assert values[:, 0].tolist() == list(range(500))
    assert times[[0, 249, 250, 499]] == pytest.approx([0, 4.98, 25, 29.98], abs=0.01)
    assert "recorded in 2 parts (#2, #1), which are joined" in record.notes


def test_streams_alike_at_the_same_time_or_without_source_are_no_parts(write: Write) -> None:
    with pytest.raises(
        InputError, match="Muse was recorded twice at the same time, as #2 and #1; choose one by its numb"
    ):
        read_signals(write(halves(-3.0)))
    with pytest.raises(InputError, match=r"has 2 signal streams; choose one by stream="):
        read_signals(write(halves(20.0, source="")))
