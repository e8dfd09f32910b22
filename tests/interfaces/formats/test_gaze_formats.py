"""Gaze files of every dialect read the same, with notes on repairs and missing parts."""

import csv
import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.text import number

Write = Callable[..., str]
Sample = Callable[[str], Path]
TOBII_SAMPLE = "tobii_prolab_de_excerpt/prolab_de_first600rows.tsv"
HEADER = (
    "Recording timestamp [ms]\tSensor\tRecording resolution height [px]\tRecording resolution width [px]"
    "\tEyetracker timestamp [μs]\tGaze point X [DACS px]\tGaze point Y [DACS px]\tValidity left\tValidity right"
)


def tobii(*rows: str, header: str = HEADER) -> str:
    return "\n".join([header, *rows]) + "\n"


def tracker(time: int, x: str, y: str, word: str = "Valid") -> str:
    return f"{time}\tEye Tracker\t1080\t1920\t{1000 * time}\t{x}\t{y}\t{word}\tInvalid"


PLAIN = tobii(tracker(100, "1114,5", "700"), tracker(108, "1116", "702,5"), tracker(116, "", "", "Invalid"))


def test_the_recorded_tobii_excerpt_is_read_whole(sample: Sample) -> None:
    gaze = read_gaze(str(sample(TOBII_SAMPLE)))
    assert gaze.format == "tobii-prolab"
    assert gaze.frame == "screen"
    assert gaze.screen == (1920.0, 1080.0)
    assert len(gaze.time) == 510, "rows of the mouse and of events are no samples"
    assert np.count_nonzero(gaze.valid) == 464
    assert gaze.time[0] == 0
    assert 1 / np.median(np.diff(gaze.time)) == pytest.approx(120, abs=0.1)
    assert gaze.epoch == pytest.approx(6984.501304)
    assert np.nanmin(gaze.points[:, 0]) == 586
    assert gaze.notes == ()


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_any_unicode_encoding_is_read(write: Write, encoding: str) -> None:
    gaze = read_gaze(write(PLAIN.encode(encoding)))
    assert gaze.points[:2].tolist() == [[1114.5, 700.0], [1116.0, 702.5]]
    assert gaze.valid.tolist() == [True, True, False]


@pytest.mark.parametrize("mu", ["μ", "\N{MICRO SIGN}"])
def test_both_mu_signs_are_microseconds(write: Write, mu: str) -> None:
    gaze = read_gaze(write(PLAIN.replace("μ", mu)))
    assert gaze.time == pytest.approx([0.0, 0.008, 0.016])
    assert gaze.notes == ()


def test_full_width_characters_in_titles_are_normalised(write: Write) -> None:
    gaze = read_gaze(write(PLAIN.replace("[DACS px]", "\N{FULLWIDTH LEFT SQUARE BRACKET}DACS px]").replace("X ", "X")))
    assert gaze.points[0].tolist() == [1114.5, 700.0]


def test_a_windows_code_page_is_read(write: Write) -> None:
    gaze = read_gaze(write(PLAIN.replace("μ", "\N{MICRO SIGN}").encode("cp1252")))
    assert gaze.epoch == pytest.approx(0.1)
    assert gaze.notes == ()


@pytest.mark.parametrize(
    ("text", "value"),
    [("12.5", 12.5), ("12,5", 12.5), ("1.234,5", 1234.5), ("1,234.5", 1234.5), ("-3,5", -3.5), ("1e3", 1000.0)],
)
def test_numbers_are_read_with_decimal_point_or_comma(text: str, value: float) -> None:
    assert number(text) == value


@pytest.mark.parametrize("text", ["", "nan", "inf", "-inf", "1e999", "abc", "1,2,3,x"])
def test_cells_without_a_finite_number_are_missing(text: str) -> None:
    assert np.isnan(number(text))


def test_rows_of_other_sensors_are_left_out(write: Write) -> None:
    mouse = "104\tMouse\t1080\t1920\t\t\t\t\t"
    start = "0\t\t1080\t1920\t\t\t\t\t"
    gaze = read_gaze(write(tobii(start, tracker(100, "1", "2"), mouse, tracker(108, "3", "4"))))
    assert gaze.points.tolist() == [[1, 2], [3, 4]]


def test_without_a_sensor_column_rows_are_selected_by_validity(write: Write) -> None:
    rows = [line.split("\t") for line in PLAIN.splitlines()]
    text = "\n".join("\t".join(cells[:1] + cells[2:]) for cells in [*rows, ["108", "x", "1080", *[""] * 6]]) + "\n"
    assert len(read_gaze(write(text)).time) == 3


def test_without_validity_values_samples_with_coordinates_are_valid_with_a_note(write: Write) -> None:
    gaze = read_gaze(write(tobii(tracker(0, "1", "2", ""), tracker(8, "", "", "")).replace("Invalid", "")))
    assert gaze.valid.tolist() == [True, False]
    assert any("validity values" in note for note in gaze.notes)


def test_both_eyes_are_averaged_where_there_is_no_combined_point(write: Write) -> None:
    header = (
        "Recording timestamp [ms]\tGaze point left X [DACS px]\tGaze point left Y [DACS px]"
        "\tGaze point right X [DACS px]\tGaze point right Y [DACS px]\tValidity left\tValidity right"
    )
    gaze = read_gaze(
        write(tobii("0\t100\t200\t110\t220\tValid\tValid", "8\t\t\t110\t220\tInvalid\tValid", header=header))
    )
    assert gaze.points.tolist() == [[105, 210], [110, 220]]


def test_the_unit_of_a_clock_is_inferred_from_its_steps_with_a_note(write: Write) -> None:
    header = HEADER.replace("Recording timestamp [ms]", "Recording timestamp").replace("Eyetracker timestamp [μs]", "z")
    rows = [f"{8333 * k}\tEye Tracker\t1080\t1920\t\t5\t5\tValid\tValid" for k in range(4)]
    gaze = read_gaze(write(tobii(*rows, header=header)))
    assert gaze.time[-1] == pytest.approx(0.025, abs=1e-3)
    assert any("no unit" in note for note in gaze.notes)


def test_media_coordinates_are_refused_with_the_columns(write: Write) -> None:
    with pytest.raises(InputError, match=r"no gaze columns in display pixels .*Gaze point X \[MCS norm\]"):
        read_gaze(write(PLAIN.replace("DACS px", "MCS norm")))


def test_a_truncated_end_gives_the_readable_part_with_a_note(write: Write) -> None:
    gaze = read_gaze(write(PLAIN + "124\tEye Tracker\t1080\t1920\t124000\t11"))
    assert len(gaze.time) == 3
    assert gaze.notes == ("truncated last row dropped",)


def test_a_plain_table_is_read_with_confidence(write: Write) -> None:
    gaze = read_gaze(write("time,x,y,confidence\n0.0,0.5,0.25,0.9\n0.01,0.5,,0.1\n"))
    assert gaze.format == "gaze-csv"
    assert gaze.frame is None
    assert gaze.confidence is not None
    assert gaze.confidence.tolist() == [0.9, 0.1]
    assert gaze.valid.tolist() == [True, False]


@pytest.mark.parametrize("order", list(itertools.permutations(["time", "x", "y", "confidence"]))[::5])
def test_the_order_of_columns_does_not_matter(write: Write, order: tuple[str, ...]) -> None:
    values = {"time": "1.5", "x": "3", "y": "4", "confidence": "0.7"}
    gaze = read_gaze(write(",".join(order) + "\n" + ",".join(values[name] for name in order) + "\n"))
    assert gaze.time.tolist() == [1.5]
    assert gaze.points.tolist() == [[3, 4]]


def test_semicolons_with_decimal_commas_are_read(write: Write) -> None:
    gaze = read_gaze(write("time [ms];x [px];y [px]\n0;1,5;2\n8,5;3;4,25\n"))
    assert gaze.time.tolist() == pytest.approx([0, 0.0085])
    assert gaze.points.tolist() == [[1.5, 2], [3, 4.25]]
    assert gaze.frame == "screen"


def test_metres_in_the_title_give_the_frame_arena(write: Write) -> None:
    assert read_gaze(write("time,x [m],y [m]\n0,1,2\n")).frame == "arena"


def test_session_times_are_kept_and_epochs_are_subtracted(write: Write) -> None:
    assert read_gaze(write("time,x,y\n5.0,1,2\n5.1,1,2\n")).time.tolist() == [5.0, 5.1]
    far = read_gaze(write("time,x,y\n1700000000.0,1,2\n1700000000.5,1,2\n"))
    assert far.time.tolist() == [0, 0.5]
    assert far.epoch == 1_700_000_000


def test_a_long_gap_is_shortened_with_a_note(write: Write) -> None:
    gaze = read_gaze(write("time,x,y\n0,1,2\n0.1,1,2\n274,1,2\n274.1,1,2\n"))
    assert gaze.time.tolist() == pytest.approx([0, 0.1, 10.1, 10.2])
    assert any("shortened to 10 s, the longest 274 s" in note for note in gaze.notes)


def test_rows_out_of_order_are_dropped_and_clock_restarts_are_joined(write: Write) -> None:
    gaze = read_gaze(write("time,x,y\n0,1,2\n0.1,1,2\n0.1,9,9\n0.05,9,9\n0.2,1,2\n,9,9\n"))
    assert gaze.time.tolist() == pytest.approx([0, 0.1, 0.2])
    assert gaze.points[:, 0].tolist() == [1, 1, 1]
    restarted = read_gaze(write("time,x,y\n50,1,2\n50.1,1,2\n50.2,1,2\n0,3,4\n0.1,3,4\n"))
    assert restarted.time.tolist() == pytest.approx([50, 50.1, 50.2, 50.3, 50.4])
    assert any("restart" in note for note in restarted.notes)


def test_duplicate_samples_are_dropped(write: Write) -> None:
    gaze = read_gaze(write("time,x,y\n0,1,2\n1e-320,9,9\n0.01,3,4\n"))
    assert gaze.points.tolist() == [[1, 2], [3, 4]]


def test_each_cause_of_refusal_has_its_own_message(write: Write, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file is given; write CHANNEL=FILE"):
        read_gaze("")
    with pytest.raises(InputError, match="there is no such file"):
        read_gaze(str(tmp_path / "missing.tsv"))
    with pytest.raises(InputError, match="it is a folder without a recording"):
        read_gaze(str(tmp_path))
    with pytest.raises(InputError, match="the file is empty"):
        read_gaze(write(" \n\n"))
    with pytest.raises(InputError, match="no row has a time"):
        read_gaze(write("time,x,y\n,1,2\nabc,1,2\n"))
    with pytest.raises(InputError, match=r"unrecognised format.*first line has: a, b"):
        read_gaze(write("a,b\n1,2\n"))
    with pytest.raises(InputError, match=r"no gaze columns \(x and y, or gaze_x and gaze_y\); has: time, u, v"):
        read_gaze(write("time,u,v\n1,2,3\n"), "gaze-csv")
    with pytest.raises(InputError, match="none of the 2 gaze samples is valid"):
        read_gaze(write("time,x,y\n0,,\n1,,\n"))
    with pytest.raises(InputError, match="'fortnight' is not a unit of time; known units: s, ms"):
        read_gaze(write("time [fortnight],x,y\n0,1,2\n"))
    with pytest.raises(InputError, match=r"format: 'edf' is not one of xdf, .*tobii-prolab, .*gaze-csv"):
        read_gaze(write("time,x,y\n0,1,2\n"), "edf")


def test_the_option_format_overrides_detection(write: Write) -> None:
    with pytest.raises(InputError, match="no gaze columns in display pixels"):
        read_gaze(write("time,x,y\n0,1,2\n"), "tobii-prolab")


def test_the_reader_agrees_with_the_csv_module_on_every_cell(sample: Sample) -> None:
    path = sample(TOBII_SAMPLE)
    gaze = read_gaze(str(path))
    with path.open(encoding="utf-8-sig", newline="") as stream:
        rows = [row for row in csv.DictReader(stream, delimiter="\t") if row["Sensor"] == "Eye Tracker"]
    expected = [float(row["Gaze point Y [DACS px]"] or "nan") for row in rows]
    np.testing.assert_array_equal(gaze.points[:, 1], expected)
