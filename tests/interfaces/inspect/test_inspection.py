"""`inspect` describes any known file in bounded memory."""

import tracemalloc
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, cast

import cv2
import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_console.core.viewport import fit
from higvf_interfaces.inspect.inspection import inspect
from higvf_interfaces.recordings.files import write_gaze_csv, write_gaze_tsv
from higvf_interfaces.recordings.gaze import DrawnByEye, synthetic_gaze
from tests.gaze_files import WRITERS, eyes

Write = Callable[..., str]
Sample = Callable[[str], Path]
KEYS = {
    "format", "kind", "streams", "samples", "duration_s", "rate_hz", "frame", "origin", "valid_share", "gaps",
    "warnings", "columns", "becomes",
}  # fmt: skip


def inspected(file: object, plot: Path | None = None, steps: bool = False, **options: str) -> Mapping[str, Any]:
    return cast(Mapping[str, Any], inspect(InputSpec("inspect", str(file), options), plot, steps))


def drawn_by_eye() -> str:
    strokes = [DrawnByEye(5, 11, floats([[200, 200], [500, 400], [900, 350]]))]
    return write_gaze_tsv(synthetic_gaze(strokes, 20.0, fit(InputSpec("g").arena, 1920, 1080), seed=3), (1920, 1080))


def test_the_origin_of_an_unknown_frame_is_unknown(write: Write) -> None:
    told = inspected(write("time,x,y\n0,1,2\n0.01,3,4\n0.02,5,6\n"))
    assert told["frame"] is told["origin"] is None


def test_a_gaze_recording_is_described_with_rate_validity_gaps_and_conversion(write: Write) -> None:
    told = inspected(write(drawn_by_eye()))
    assert set(told) >= KEYS
    assert (told["format"], told["kind"], told["frame"], told["origin"]) == (
        "tobii-prolab",
        "gaze",
        "screen",
        "top left",
    )
    assert told["samples"] == 2400
    assert told["rate_hz"] == pytest.approx(120, abs=0.1)
    assert told["duration_s"] == pytest.approx(20, abs=0.01)
    assert told["valid_share"] == pytest.approx(1 - 0.15 / 20, abs=1e-3)
    assert told["gaps"]["count"] == told["blinks"] == 1
    assert told["gaps"]["longest_s"] == pytest.approx(0.15, abs=0.02)
    assert told["becomes"]["strokes"] == 1
    assert 40 < told["becomes"]["fixations"] < 70
    assert "Gaze point X [DACS px]" in told["columns"]


def test_steps_report_decreasing_sample_counts_and_the_paths(write: Write) -> None:
    steps = inspected(write(drawn_by_eye()), steps=True)["steps"]
    counted = [value for value in steps.values() if isinstance(value, int)][:6]
    assert counted[:3] == sorted(counted[:3], reverse=True)
    assert counted[3:] == sorted(counted[3:], reverse=True)
    (stroke,) = steps["strokes"]
    assert stroke["path_length_m"] > 1000
    assert stroke["smallest_radius_m"] > 0


def test_a_long_gap_separates_two_strokes(write: Write) -> None:
    times = [k / 100 for k in range(1000) if not 400 <= k < 600]
    rows = "".join(f"{time},{300 + 200 * (int(time * 2) % 4)},400\n" for time in times)
    told = inspected(write("time,x [m],y [m]\n" + rows))
    assert told["becomes"]["strokes"] == 2
    assert told["gaps"]["longest_s"] == pytest.approx(2.0, abs=0.02)


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_is_described_by_its_name(tmp_path: Path, name: str) -> None:
    told = inspected(WRITERS[name](tmp_path / "file", eyes(80)))
    assert (told["format"], told["kind"], told["samples"]) == (name, "gaze", 80)
    assert told["rate_hz"] == pytest.approx(100, abs=0.1)
    bottom = name.startswith("pupil")
    assert told["origin"] == ("bottom left" if bottom else "top left")


def test_coordinates_of_an_unknown_frame_have_no_origin(write: Write) -> None:
    told = inspected(write("time,x,y\n0,1,2\n0.1,2,3\n0.2,4,5\n"))
    assert (told["frame"], told["origin"]) == (None, None)


def test_gaze_without_a_frame_is_described_partly_with_the_options_to_set(tmp_path: Path) -> None:
    told = inspected(WRITERS["neon-native"](tmp_path / "folder", eyes()), plot=tmp_path / "p.png")
    assert (told["frame"], told["becomes"]) == ("scene", {})
    assert "calibration=FILE" in told["warnings"][0]
    assert not (tmp_path / "p.png").exists()
    assert inspected(WRITERS["neon-native"](tmp_path / "folder", eyes()), frame="screen")["frame"] == "screen"


@pytest.mark.parametrize(
    "wrong",
    [
        {"frame": "scren"}, {"px_per_deg": "-5"}, {"method": "foo"}, {"calibration": "nofile.yaml"}, {"latency": "abc"},
        {"screen": "wide"}, {"origin": "middle"}, {"clutch": "foot"}, {"commit": "never"},
    ],
)  # fmt: skip
@pytest.mark.parametrize("head", ["time,x [px],y [px]", "time,x,y"])
def test_a_wrong_option_of_gaze_is_refused_whether_the_frame_is_known_or_not(
    write: Write, head: str, wrong: dict[str, Any]
) -> None:
    with pytest.raises(InputError, match=next(iter(wrong.values()))):
        inspected(write(f"{head}\n0,1,1\n1,1,1\n"), **wrong)


def test_a_wrong_option_of_a_command_log_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="votes: 5/3 is not n/m"):
        inspected(write("time,label\n1,fist\n"), votes="5/3")


@pytest.mark.parametrize("options", [{"clutch": "held"}, {"decoder": "lda"}, {"votes": "3/5"}, {"confusion": "0.9"}])
def test_the_options_of_every_channel_are_accepted(write: Write, options: dict[str, Any]) -> None:
    assert inspected(write("time,x [px],y [px]\n0,1,1\n1,1,1\n"), **options)["kind"] == "gaze"
    assert inspected(write("time,label\n1,fist\n"), **options)["kind"] == "commands"


def test_a_wrong_decoder_is_refused_with_the_choices(write: Write) -> None:
    for head in ("time,x [px],y [px]\n0,1,1\n1,1,1\n", "time,label\n1,fist\n", "timestamps,C3,C4\n0,1,2\n1,1,2\n"):
        with pytest.raises(InputError, match="decoder: 'foo' is not one of lda, ssvep"):
            inspected(write(head), decoder="foo")


def test_unusable_gaze_is_described_with_the_reason(write: Write) -> None:
    told = inspected(write("time,x [px],y [px]\n0,-9,1\n1,-9,1\n"))
    assert (told["samples"], told["becomes"]) == (2, {})
    assert "no gaze sample is confident and on the screen" in told["warnings"][0]


def test_a_heat_map_is_written_on_request(write: Write, tmp_path: Path) -> None:
    inspected(write(drawn_by_eye()), plot=tmp_path / "heat.png")
    picture = cv2.imread(str(tmp_path / "heat.png"))
    assert picture is not None
    assert picture.shape == (525, 900, 3)
    assert np.ptp(picture) > 100
    with pytest.raises(InputError, match=r"heat\.png: cannot be written"):
        inspected(write(drawn_by_eye()), plot=tmp_path / "no" / "heat.png")


def test_a_command_log_is_described_by_its_labels_and_their_actions(write: Write, tmp_path: Path) -> None:
    log = "time,label,confidence\n1,fist,0.9\n2,open,\n4,fist,0.7\n5,wave,0.5\n"
    told = inspected(write(log), plot=tmp_path / "log.png")
    assert set(told) >= KEYS
    assert (told["format"], told["kind"], told["samples"], told["duration_s"]) == ("command-csv", "commands", 4, 4.0)
    assert told["labels"] == {"fist": 2, "open": 1, "wave": 1}
    assert told["becomes"]["emg"] == {"fist": "pause", "open": "resume", "wave": "unknown"}
    assert told["confidence"] == {"known": 3, "mean": 0.7}
    assert any("wave" in warning for warning in told["warnings"])
    assert cv2.imread(str(tmp_path / "log.png")) is not None


def test_recorded_xdf_without_gaze_is_described_by_its_streams(sample: Sample) -> None:
    told = inspected(sample("xdf_muse_eeg/sub-P031_ses-S001_task-Default_run-001_eeg.xdf"))
    assert (told["format"], told["kind"]) == ("xdf", "streams")
    assert [stream["type"] for stream in told["streams"]] == ["PPG", "ACC", "GYRO", "EEG"]
    assert told["samples"] > 2000
    assert all("stream=" in warning for warning in told["warnings"])
    eeg = inspected(sample("xdf_muse_eeg/sub-P031_ses-S001_task-Default_run-001_eeg.xdf"), stream="EEG")
    assert (eeg["kind"], len(eeg["streams"]), eeg["columns"][0]) == ("signals", 4, "TP9 [uV]")


@pytest.mark.parametrize(
    ("name", "options", "told"),
    [
        ("xdf_emg8_gestures/test1.xdf", {}, ("xdf-signals", 23390, 8)),
        ("emg_myo8/emg_data_myo.csv", {"rate": "200"}, ("myo-csv", 500, 8)),
        ("openbci_gui_v6/OpenBCI_GUI-v6-blinks-jawClench-alpha_first60s.txt", {}, ("openbci-txt", 15000, 8)),
        ("emg_bids_edf/sub-01_task-typing_emg.edf", {}, ("edf", 1000, 32)),
    ],
)
def test_recorded_signals_are_described_by_their_channels(
    sample: Sample, name: str, options: dict[str, str], told: tuple[str, int, int]
) -> None:
    found = cast(Mapping[str, Any], inspect(InputSpec("inspect", str(sample(name)), options)))
    assert found["kind"] == "signals"
    assert (found["format"], found["samples"], len(found["columns"])) == told
    assert found["valid_share"] == 1


def test_the_recorded_tobii_excerpt_is_described(sample: Sample) -> None:
    told = inspected(sample("tobii_prolab_de_excerpt/prolab_de_first600rows.tsv"))
    assert told["valid_share"] == pytest.approx(464 / 510, abs=1e-6)
    assert told["becomes"]["fixations"] == 11


def test_an_unrecognised_file_is_refused_with_the_formats_tried(write: Write) -> None:
    with pytest.raises(InputError, match=r"unrecognised format.*has: a, b.*xdf: .*tobii-prolab: .*command-csv: "):
        inspected(write("a,b\n1,2\n"))
    with pytest.raises(InputError, match=r"format: 'edf9' is not one of xdf, .*command-csv"):
        inspected(write("a,b\n1,2\n"), format="edf9")
    with pytest.raises(InputError, match="there is no such file"):
        inspected("/nowhere/file.csv")


def test_a_folder_without_a_recording_is_refused_with_the_formats_tried(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"unrecognised format.*it is a folder without a recording.*neon-native: "):
        inspected(tmp_path)


def padded_log(path: Path, megabytes: int) -> Path:
    """A log with wide rows: large in memory, cheap to process."""
    width = 2000
    with path.open("w") as stream:
        stream.write("time,x [m],y [m],comment\n")
        for k in range(megabytes * 1_000_000 // width):
            stream.write(f"{k / 120:.4f},{300 + 100 * (k // 60 % 7)},400,{'c' * (width - 25)}\n")
    return path


def test_memory_does_not_grow_with_the_file(tmp_path: Path) -> None:
    peaks: list[int] = []
    inspected(padded_log(tmp_path / "warm.csv", 1))
    for megabytes in (5, 30):
        file = padded_log(tmp_path / "log.csv", megabytes)
        tracemalloc.start()
        assert inspected(file)["samples"] == megabytes * 500
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.1 * peaks[0]
    assert peaks[1] < 10_000_000


def test_a_plain_table_of_the_same_gaze_has_the_same_description(write: Write) -> None:
    samples = synthetic_gaze([], 10.0, fit(InputSpec("g").arena, 1920, 1080), seed=1)
    told = [
        inspected(write(text, name))
        for name, text in (("a", write_gaze_csv(samples)), ("b", write_gaze_tsv(samples, (1920, 1080))))
    ]
    assert told[0]["becomes"] == told[1]["becomes"]
