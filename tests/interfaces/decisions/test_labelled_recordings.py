"""Markers are aligned with the clock of the signal that they label, also from another file."""

from collections.abc import Callable, Mapping

import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.decisions.emg import open_emg
from higvf_interfaces.decisions.options import DECODING, RECORDED, signal_request
from higvf_interfaces.decoding.replay import decoder_feed, labelled
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.signals.reading import read_signals
from tests.interfaces.formats.xdf_files import Stream, xdf

Write = Callable[..., str]
DEVICE = 213_543.0  # seconds since the computer started: a usual clock of the Lab Streaming Layer


def signal(start: float) -> str:
    """Forty seconds of one channel at 50 Hz."""
    return "timestamps,C3\n" + "".join(f"{start + k / 50:.3f},{k % 7}.5\n" for k in range(2000))


def markers(start: float) -> str:
    return "time,label\n" + "".join(f"{start + 7.5 + 5 * k:.3f},{'ab'[k % 2]}\n" for k in range(6))


def starts(source: str, options: Mapping[str, object]) -> list[float]:
    """Start times of the trials on the clock of the signal."""
    fields = Fields({"trial_s": 2.0, **options}, (*RECORDED, *DECODING), "input emg")
    record = read_signals(source, signal_request(fields))
    return [round(trial.start, 2) for trial in labelled(source, record, fields).trials]


@pytest.mark.parametrize(
    ("begins", "marked_from"),
    [(DEVICE, DEVICE), (100.0, 100.0), (2.0, 2.0), (0.0, 0.0), (DEVICE, 0.0), (9.0, 0.0)],
    ids=["LSL", "below an hour", "both fit", "from the start", "markers from the start", "nearly both fit"],
)
def test_markers_of_another_table_are_aligned_with_the_signal(write: Write, begins: float, marked_from: float) -> None:
    marked = write(markers(marked_from), "marks.csv")
    assert starts(write(signal(begins)), {"markers": marked}) == [7.5, 12.5, 17.5, 22.5, 27.5, 32.5]


def test_onsets_of_bids_events_count_from_the_start_of_the_signal(write: Write) -> None:
    events = write("onset\tduration\ttrial_type\n7.5\t1\ta\n12.5\t1\tb\n", "events.tsv")
    assert starts(write(signal(5.0)), {"markers": events}) == [7.5, 12.5]


def test_markers_of_one_table_are_aligned_if_its_first_row_is_a_marker(write: Write) -> None:
    rows = "".join(f"{100 + k / 50},{k % 7}.5,{'a' if k in (0, 500) else ''}\n" for k in range(1000))
    assert starts(write("time,C3,event\n" + rows), {}) == [0, 10]


@pytest.mark.parametrize("begins", [0.0, 2 * DEVICE])
def test_markers_on_another_clock_are_refused(write: Write, begins: float) -> None:
    marked = write(markers(DEVICE), "marks.csv")
    with pytest.raises(InputError, match=r"none of its 6 markers .* from 213550\.500 to .*must use the same clock"):
        starts(write(signal(begins)), {"markers": marked})


def test_one_of_several_marker_streams_is_selected_by_name(write: Write) -> None:
    eeg = Stream("EEG", "EEG", "e", 50, [9 + k / 50 for k in range(500)], [(k % 7, k % 5) for k in range(500)])
    cues, keys = (Stream(name, "Markers", "", 0, [t], ["a"]) for name, t in (("Cues", 11.0), ("Keys", 12.0)))
    file = write(xdf(eeg, cues, keys))
    assert starts(file, {"stream": "EEG", "marker_stream": "Keys"}) == [3]
    with pytest.raises(InputError, match="the file has 2 event streams; choose one by marker_stream=TYPE"):
        starts(file, {"stream": "EEG"})


def test_format_and_rate_of_the_recording_do_not_apply_to_its_calibration(write: Write) -> None:
    rows = ["{0},{1},{0},{1},{0},{1},{0},{1}".format(k * 13 % 99, k * 7 % 50) for k in range(400)]
    played = write("\n".join(rows) + "\n", "myo.csv")
    cues = "".join(f"{3 * k},{'ab'[k % 2]}\n" for k in range(12))
    titles = ",".join(f"C{k}" for k in range(8))
    calibration = f"timestamps,{titles}\n" + "".join(f"{k / 100},{rows[k % 400]}\n" for k in range(4000))
    options = {
        "decoder": "lda", "format": "myo-csv", "rate": 200.0, "trial_s": 2.0, "mains": 0.0,
        "calibration": write(calibration, "calibration.csv"), "markers": write("time,label\n" + cues, "cues.csv"),
    }  # fmt: skip
    feed = decoder_feed(played, Fields(options, (*RECORDED, *DECODING), "input emg"), 0.0)
    assert feed.labels == ("a", "b")


def test_the_option_stream_applies_to_whichever_of_recording_and_calibration_is_xdf(write: Write) -> None:
    def opened(played: str, calibration: str) -> None:
        options = {"decoder": "lda", "trial_s": "2", "mains": "0", "stream": "EMG", "calibration": calibration}
        open_emg(InputSpec("emg", played, options))

    times = [k / 100 for k in range(2500)]
    rows = [(float(k * 13 % 99), float(k * 7 % 50)) for k in range(2500)]
    cues = Stream("Cues", "Markers", "", 0, [2.0 * k for k in range(12)], ["ab"[k % 2] for k in range(12)])
    lab = write(
        xdf(Stream("A", "EMG", "", 100, times, rows), Stream("B", "EEG", "", 100, times, rows), cues), "lab.xdf"
    )
    body = "".join(f"{t},{x},{y},{'ab'[int(t / 2) % 2]}\n" for t, (x, y) in zip(times, rows, strict=True))
    table = write(f"time,C1,C2,event\n{body}", "table.csv")
    opened(table, lab)
    opened(lab, table)
    with pytest.raises(InputError, match=r"table\.csv: stream=EMG is for XDF files; this is read as signal-csv"):
        opened(table, table)
    for log in ("time,label\n1,fist\n", '{"time": 1, "label": "fist"}\n'):
        with pytest.raises(InputError, match="stream=EMG is for XDF files; this is read as command-"):
            open_emg(InputSpec("emg", write(log), {"stream": "EMG"}))
