"""The same gaze, written in every format, reads as the same gaze."""

import gzip
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.reading import GAZE_FORMATS, read_gaze
from higvf_interfaces.formats.records import SCENE_FRAMES, Wanted
from higvf_interfaces.gaze.source import OPTIONS, GazeSource
from tests.gaze_files import EPOCH_NS, HEIGHT, WIDTH, WRITERS, eyes, xdf_stream

Sample = Callable[[str], Path]
Write = Callable[..., str]


def test_there_is_a_generator_for_every_format() -> None:
    assert set(WRITERS) == {known.name for known in GAZE_FORMATS}


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_is_known_by_its_content_and_gives_the_same_eyes(tmp_path: Path, name: str) -> None:
    samples = eyes()
    file = WRITERS[name](tmp_path / "recording.bin", samples)
    assert read_gaze(str(file)).format == name
    frame = {"frame": SCENE_FRAMES.get(read_gaze(str(file)).frame or "", "")}
    values = {**({"frame": frame["frame"]} if frame["frame"] else {}), "screen": f"{WIDTH}x{HEIGHT}"}
    source = GazeSource(InputSpec("gaze", str(file)), Fields(values, OPTIONS, "gaze"))
    blocks = [pixels for _, pixels in source.blocks()]
    time = np.concatenate([block.time for block in blocks])
    points = np.concatenate([block.points for block in blocks])
    seen = np.array([eye.seen for eye in samples])
    np.testing.assert_allclose(time - time[0], [eye.time for eye in samples], atol=1e-6)
    assert np.concatenate([block.valid for block in blocks]).tolist() == seen.tolist()
    np.testing.assert_allclose(points[seen], [eye[1:3] for eye in samples if eye.seen], atol=1e-3)


@pytest.mark.parametrize("name", ["tobii-prolab", "neon-native", "eyelink-asc", "bids"])
def test_the_size_of_screen_or_scene_is_taken_from_the_file(tmp_path: Path, name: str) -> None:
    expected = (1600, 1200) if name == "neon-native" else (WIDTH, HEIGHT)
    assert read_gaze(str(WRITERS[name](tmp_path / "file", eyes()))).screen == expected


@pytest.mark.parametrize("name", ["neon-csv", "neon-native"])
def test_nanoseconds_are_counted_from_the_first_sample_and_kept_as_an_epoch(tmp_path: Path, name: str) -> None:
    gaze = read_gaze(str(WRITERS[name](tmp_path / "file", eyes())))
    assert gaze.epoch == pytest.approx(EPOCH_NS * 1e-9)
    assert np.ptp(np.diff(gaze.time)) < 1e-9, "a float of nanoseconds since 1970 would miss by 256 ns"


@pytest.mark.parametrize("name", ["pupil-core", "neon-csv", "neon-native"])
def test_gaze_of_a_scene_camera_is_refused_with_the_alternatives(tmp_path: Path, name: str) -> None:
    file = WRITERS[name](tmp_path / "file", eyes())
    with pytest.raises(InputError, match=r"camera on the head.*surface with markers.*calibration=FILE.*frame="):
        GazeSource(InputSpec("gaze", str(file)), Fields({}, OPTIONS, "gaze"))


def test_the_recorded_neon_folder_loses_its_two_blinks(sample: Sample) -> None:
    gaze = read_gaze(str(sample("gaze_neon_native/gaze ps1.raw").parent))
    assert (gaze.format, gaze.frame, gaze.screen) == ("neon-native", "scene", (1600, 1200))
    assert len(gaze.time) == 1788
    shut = np.flatnonzero(np.diff(np.concatenate([[0], ~gaze.valid, [0]])))
    lengths = gaze.time[shut[1::2] - 1] - gaze.time[shut[::2]]
    assert lengths == pytest.approx([0.235, 0.255], abs=0.02)
    assert np.isfinite(gaze.points).all(), "gaze stays finite in a blink; only the list tells"


def test_the_recorded_eyelink_excerpt_is_read(sample: Sample) -> None:
    gaze = read_gaze(str(sample("eyelink_asc/eyelink_monocular_example.asc")))
    assert gaze.screen == (1280, 1024)
    assert len(gaze.time) == 16, "numbers of the calibration are no samples"
    assert gaze.points[0].tolist() == [138.1, 132.8]


def test_the_recorded_tobii_sdk_table_is_read(sample: Sample) -> None:
    path = sample("tobii_tx300_sdk/p1_2.tsv")
    gaze = read_gaze(str(path))
    assert (gaze.format, gaze.frame) == ("tobii-old", "unit")
    assert 1 / np.median(np.diff(gaze.time)) == pytest.approx(300, abs=3)
    rows = np.genfromtxt(path, names=True, delimiter="\t")
    neither = (rows["LValidity"] > 1) & (rows["RValidity"] > 1)
    assert (~gaze.valid).tolist() == neither.tolist()
    assert np.nanmin(gaze.points) > 0, "-1 is no place"


def test_recorded_xdf_without_gaze_is_refused_with_its_streams(sample: Sample) -> None:
    path = str(sample("xdf_muse_eeg/sub-P031_ses-S001_task-Default_run-001_eeg.xdf"))
    with pytest.raises(InputError, match=r"0 streams of type gaze .*type PPG, name Muse.*type EEG, name Muse"):
        read_gaze(path)
    with pytest.raises(InputError, match="stream=Muse fits 4 streams"):
        read_gaze(path, wanted=Wanted("Muse"))
    assert len(read_gaze(path, wanted=Wanted("EEG", "TP9", "2")).time) > 1000


def test_xdf_streams_are_chosen_by_type_source_id_or_number(tmp_path: Path) -> None:
    file = str(WRITERS["xdf"](tmp_path / "file", eyes()))
    for wanted in ("Gaze", "id-2", "2", "2.0"):
        assert len(read_gaze(file, wanted=Wanted(wanted)).time) == 40
    swapped = read_gaze(file, wanted=Wanted("Gaze", "2", "x"))
    assert swapped.points[0].tolist() == [300, 400]
    with pytest.raises(InputError, match="x=pupil9 is not a channel; channels: 1 x, 2 y, 3 pupil"):
        read_gaze(file, wanted=Wanted("Gaze", "pupil9", "x"))


def test_an_xdf_stream_without_metadata_asks_for_its_channels(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"XDF:" + xdf_stream(1, "Eyes", "Gaze", (), [(1.0, 2.0, 3.0), (1.01, 2.0, 3.0)]))
    with pytest.raises(InputError, match="no channels with known gaze labels; give x= and y=; channels: 1, 2"):
        read_gaze(str(path))
    assert read_gaze(str(path), wanted=Wanted(None, "1", "2")).points[0].tolist() == [2, 3]


@pytest.mark.parametrize("name", sorted(set(WRITERS) - {"bids", "neon-native"}))
def test_a_file_cut_anywhere_in_its_last_quarter_gives_its_readable_part(tmp_path: Path, name: str) -> None:
    file = WRITERS[name](tmp_path / "file", eyes(60))
    whole = file.read_bytes()
    for end in range(len(whole) - len(whole) // 4, len(whole), 97):
        file.write_bytes(whole[:end])
        gaze = read_gaze(str(file))
        assert 20 < len(gaze.time) <= 60
        assert name != "xdf" or "the file is truncated: only its readable part is used" in gaze.notes


def test_compressed_data_that_end_prematurely_give_their_readable_part_with_a_note(tmp_path: Path) -> None:
    file = WRITERS["bids"](tmp_path / "file", eyes(4000))
    packed = file.read_bytes()
    file.write_bytes(packed[: len(packed) // 2])
    gaze = read_gaze(str(file))
    assert 100 < len(gaze.time) < 4000
    assert "the compressed data end prematurely: only the readable part is used" in gaze.notes


def test_a_truncated_neon_folder_gives_its_readable_part_with_a_note(tmp_path: Path) -> None:
    folder = WRITERS["neon-native"](tmp_path / "folder", eyes())
    raw = folder / "gaze ps1.raw"
    raw.write_bytes(raw.read_bytes()[:-13])
    gaze = read_gaze(str(folder))
    assert len(gaze.time) == 38
    assert any("gaze ps1.raw is cut off: 38.375 points for 40 times, 38 used" in note for note in gaze.notes)
    (folder / "gaze ps1.time").unlink()
    with pytest.raises(InputError, match=r"the file of its time stamps, .* is missing"):
        read_gaze(str(folder))


def test_blinks_beside_a_neon_table_are_cut(tmp_path: Path) -> None:
    rows = "".join(f"{EPOCH_NS + k * 10_000_000},{k},5\n" for k in range(10))
    file = tmp_path / "gaze.csv"
    file.write_text("timestamp [ns],gaze x [px],gaze y [px]\n" + rows)
    assert any("blinks are not cut" in note for note in read_gaze(str(file)).notes)
    (tmp_path / "blinks.csv").write_text(
        f"blink id,start timestamp [ns],end timestamp [ns]\n1,{EPOCH_NS + 20_000_000},{EPOCH_NS + 45_000_000}\n"
    )
    assert np.flatnonzero(~read_gaze(str(file)).valid).tolist() == [2, 3, 4]


def test_neon_gaze_mapped_on_a_surface_is_gaze_on_a_screen(write: Write) -> None:
    x, y = (f"gaze position on surface {axis} [normalized]" for axis in "xy")
    text = f"timestamp [ns],gaze detected on surface,{x},{y},blink id\n1,True,0.5,0.25,\n20000000,False,1.5,2,\n"
    gaze = read_gaze(write(text))
    assert (gaze.frame, gaze.origin) == ("unit", "top left")
    assert gaze.valid.tolist() == [True, False]


@pytest.mark.parametrize("endings", [("_x", "_y"), ("_0", "_1"), ("[0]", "[1]")])
def test_points_of_the_tobii_sdk_may_have_two_columns(write: Write, endings: tuple[str, str]) -> None:
    left = [f"left_gaze_point_on_display_area{end}" for end in endings]
    text = f"system_time_stamp,{left[0]},{left[1]},left_gaze_point_validity\n0,0.5,0.25,1\n10000,0.5,0.25,0\n"
    gaze = read_gaze(write(text))
    assert gaze.format == "tobii-research"
    assert gaze.points[0].tolist() == [0.5, 0.25]
    assert gaze.valid.tolist() == [True, False]


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("RecordingTimestamp\tGazePointLeftX (ADCSpx)\tGazePointLeftY (ADCSpx)\tValidityLeft", "screen"),
        ("Timestamp\tGazePointXLeft\tGazePointYLeft\tValidityLeft", "screen"),
        ("TETTime\tXGazePosLeftEye\tYGazePosLeftEye\tValidityLeftEye", "unit"),
    ],
)
def test_low_validity_codes_of_tobii_studio_and_eprime_mean_valid(write: Write, header: str, unit: str) -> None:
    gaze = read_gaze(write(f"{header}\n0\t5\t6\t0\n16\t5\t6\t1\n33\t5\t6\t2\n50\t-1\t-1\t4\n66\t-1\t-1\t0\n"))
    assert (gaze.format, gaze.frame) == ("tobii-old", unit)
    assert gaze.valid.tolist() == [True, True, False, False, False]
    assert gaze.time[-1] == pytest.approx(0.066)


@pytest.mark.parametrize(
    ("header", "valid"),
    [
        ("RecordingTimestamp\tGazePointX (ADCSpx)\tGazePointY (ADCSpx)\tValidityLeft\tValidityRight",
         [True, True, False, False, False]),
        ("Timestamp\tGazePointX\tGazePointY\tValidityLeft\tValidityRight", [True, True, False, False, False]),
        ("RecordingTimestamp\tGazePointX (ADCSpx)\tGazePointY (ADCSpx)\tPupilLeft\tPupilRight",
         [True, True, True, False, False]),
    ],
)  # fmt: skip
def test_tobii_studio_without_the_points_of_the_eyes_has_a_combined_one(
    write: Write, header: str, valid: list[bool]
) -> None:
    rows = "0\t5\t6\t0\t4\n16\t5\t6\t4\t1\n33\t5\t6\t2\t3\n50\t\t\t4\t4\n66\t-1\t-1\t0\t0\n"
    gaze = read_gaze(write(f"{header}\n{rows}"))
    assert (gaze.format, gaze.frame) == ("tobii-old", "screen")
    assert gaze.valid.tolist() == valid
    assert gaze.points[0].tolist() == [5, 6]
    unjudged = "no validity columns: every sample with coordinates counts as valid"
    assert (unjudged in gaze.notes) == ("Validity" not in header)


def test_tobii_studio_in_the_pixels_of_a_medium_is_refused_with_the_way_out(write: Write) -> None:
    with pytest.raises(InputError, match=r"GazePointX \(MCSpx\) is in 'mcspx', not in pixels .*ADCSpx in the export"):
        read_gaze(write("RecordingTimestamp\tGazePointX (MCSpx)\tGazePointY (MCSpx)\n0\t5\t6\n"))


def test_eyelink_flags_and_other_samples_than_gaze(write: Write) -> None:
    head = "SAMPLES\tGAZE\tLEFT\tRATE\t1000.00\nMSG\t1 GAZE_COORDS 100 50 1699 949\n"
    gaze = read_gaze(write(head + "1\t200.0\t150.0\t700.0\t...\n2\t 200.0\t150.0\t700.0\tI..\n3\t.\t.\t0.0\tC..\n"))
    assert gaze.points[0].tolist() == [100, 100], "the screen begins at 100, 50"
    assert gaze.valid.tolist() == [True, False, False]
    assert gaze.screen == (1600, 900)
    with pytest.raises(InputError, match="its samples are HREF, not gaze on the screen; convert with edf2asc -sg"):
        read_gaze(write("SAMPLES\tHREF\tLEFT\tRATE\t1000.00\n1\t2\t3\t4\t...\n"))
    with pytest.raises(InputError, match="has no samples; convert the EDF with edf2asc without -e"):
        read_gaze(write("** CONVERTED FROM a.edf\nMSG 1 hello\n"))


def test_a_bids_table_without_times_is_counted_from_its_start(tmp_path: Path) -> None:
    path = tmp_path / "sub-01_physio.tsv.gz"
    path.write_bytes(gzip.compress(b"1\t2\n3\t4\n5\t6\n"))
    sidecar: dict[str, object] = {"Columns": ["x_coordinate", "y_coordinate"], "SamplingFrequency": 50, "StartTime": 2}
    path.with_name("sub-01_physio.json").write_text(json.dumps(sidecar))
    gaze = read_gaze(str(path))
    assert gaze.frame is None
    assert np.diff(gaze.time) == pytest.approx([0.02, 0.02])
    del sidecar["SamplingFrequency"]
    path.with_name("sub-01_physio.json").write_text(json.dumps(sidecar))
    with pytest.raises(InputError, match="neither a column timestamp nor a SamplingFrequency"):
        read_gaze(str(path))
    path.with_name("sub-01_physio.json").unlink()
    with pytest.raises(InputError, match=r"put sub-01_physio\.json beside it"):
        read_gaze(str(path), "bids")


def test_any_text_table_may_be_compressed(tmp_path: Path) -> None:
    plain = WRITERS["gaze-csv"](tmp_path / "plain", eyes())
    (tmp_path / "packed").write_bytes(gzip.compress(plain.read_bytes()))
    np.testing.assert_array_equal(read_gaze(str(tmp_path / "packed")).points, read_gaze(str(plain)).points)


@pytest.mark.parametrize("wanted", [Wanted(x="1"), Wanted(y="pupil9")])
def test_x_without_y_and_y_without_x_are_refused(tmp_path: Path, wanted: Wanted) -> None:
    file = str(WRITERS["xdf"](tmp_path / "file", eyes()))
    with pytest.raises(InputError, match=r"[xy]= is given without [xy]=; channels: 1 x, 2 y, 3 pupil"):
        read_gaze(file, wanted=wanted)


@pytest.mark.parametrize("name", sorted(set(WRITERS) - {"xdf"}))
def test_stream_and_channel_options_are_refused_for_other_formats_than_xdf(tmp_path: Path, name: str) -> None:
    file = str(WRITERS[name](tmp_path / "file", eyes()))
    with pytest.raises(InputError, match=f"stream=Gaze, x=rx is for XDF files; this is read as {name}"):
        read_gaze(file, wanted=Wanted("Gaze", "rx"))
