"""Gaze, signals and markers of one file, and a BIDS table and its events, share one clock."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.records import GazeRecording
from higvf_interfaces.formats.signals.reading import read_decisions, read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, whole
from tests.interfaces.formats.xdf_files import Stream, xdf

LOOKED = 5.0  # when gaze jumps, in the clock of the others [s]


def jump(gaze: GazeRecording) -> float:
    """When gaze leaves the left half of the screen [s]."""
    return float(gaze.time[np.argmax(gaze.points[:, 0] > 500)])


def test_gaze_signals_and_markers_of_one_xdf_file_share_one_clock(write: Callable[..., str]) -> None:
    times = [1000 + k / 50 for k in range(500)]
    eeg = Stream("Muse", "EEG", "e", 50, times, [(t - 1000, 0.0) for t in times], ("A", "B"))
    seen = [1003 + k / 100 for k in range(500)]
    eyes = Stream("Tobii", "Gaze", "g", 100, seen, [(900 if t > 1000 + LOOKED else 100, 5) for t in seen], ("x", "y"))
    file = write(xdf(eeg, eyes, Stream("Cues", "Markers", "m", 0, [1000 + LOOKED], ["pause"])))
    gaze = read_gaze(file)
    assert (gaze.time[0], jump(gaze)) == (pytest.approx(3), pytest.approx(LOOKED, abs=0.02))
    assert read_decisions(file).decisions[0].time == pytest.approx(LOOKED)
    samples = whole(read_signals(file, SignalRequest(stream="EEG")))
    assert samples.values[:, 0] == pytest.approx(samples.times, abs=1e-6)
    assert gaze.epoch == pytest.approx(1000)


def test_a_long_gap_in_gaze_does_not_shift_it_against_the_other_streams(write: Callable[..., str]) -> None:
    seen = [1000 + k / 100 + 60 * (k >= 50) for k in range(100)]
    eyes = Stream("Tobii", "Gaze", "g", 100, seen, [(1.0, 2.0)] * 100, ("x", "y"))
    gaze = read_gaze(write(xdf(eyes, Stream("Cues", "Markers", "m", 0, [1060.5], ["pause"]))))
    assert gaze.time[50] == pytest.approx(60.5, abs=0.02)
    assert gaze.notes == ()


def test_gaze_on_another_clock_than_the_other_streams_is_noted(write: Callable[..., str]) -> None:
    eyes = Stream("Tobii", "Gaze", "g", 100, [9e5 + k / 100 for k in range(50)], [(1.0, 2.0)] * 50, ("x", "y"))
    file = write(xdf(eyes, Stream("Cues", "Markers", "m", 0, [10.0], ["pause"])))
    note = "Cues and Tobii lie 899990 s apart, so on different clocks: the earliest sample of each clock is at time 0; "
    gaze, cues = read_gaze(file), read_decisions(file)
    assert gaze.notes == (f"{note}shift one with start=",)
    assert (gaze.time[0], gaze.epoch) == (0.0, pytest.approx(9e5))
    assert (cues.decisions[0].time, cues.epoch) == (0.0, pytest.approx(10.0))
    assert any("899990 s apart" in text for text in cues.notes)


@pytest.mark.parametrize("timed", [False, True], ids=["counted", "device times"])
@pytest.mark.parametrize("start", [2.5, -1.0, 0.0])
def test_gaze_and_events_of_a_bids_recording_share_one_clock(tmp_path: Path, start: float, timed: bool) -> None:
    rows = [(700_000 + 10 * k, 900 if start + k / 100 > LOOKED else 100, 5) for k in range(900)]
    path = tmp_path / "sub-1_task-a_physio.tsv"
    path.write_text("".join("\t".join(map(str, row[0 if timed else 1 :])) + "\n" for row in rows))
    columns = ["timestamp", "x_coordinate", "y_coordinate"][0 if timed else 1 :]
    sidecar = {"SamplingFrequency": 100, "StartTime": start, "Columns": columns, "timestamp": {"Units": "ms"}}
    path.with_suffix(".json").write_text(json.dumps(sidecar))
    gaze = read_gaze(str(path))
    assert (gaze.time[0], jump(gaze)) == (pytest.approx(start), pytest.approx(LOOKED, abs=0.02))


@pytest.mark.parametrize("lost", ["", "\t", "   ", "9", "n/a\tn/a"], ids=["blank", "tab", "spaces", "short", "n/a"])
def test_a_bids_row_without_gaze_does_not_shift_the_times_of_others(tmp_path: Path, lost: str) -> None:
    path = tmp_path / "sub-1_physio.tsv"
    path.write_text("\n".join(["1\t2"] * 3 + [lost] * 4 + ["5\t6"] * 3) + "\n")
    sidecar = {"SamplingFrequency": 10, "StartTime": 0, "Columns": ["x_coordinate", "y_coordinate"]}
    path.with_suffix(".json").write_text(json.dumps(sidecar))
    gaze = read_gaze(str(path))
    assert gaze.time == pytest.approx(np.arange(10) / 10)
    assert gaze.valid.tolist() == [True] * 3 + [False] * 4 + [True] * 3
    short = ("4 rows with too few cells: gaze missing",)
    assert gaze.notes == (() if "\t" in lost else short)
