"""Inputs in the spellings of other makers are read right or refused with the reason; none is misread in silence."""

import json
from collections.abc import Callable
from pathlib import Path

import edfio
import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.signals.reading import read_signals
from higvf_interfaces.formats.signals.records import SignalRequest, whole
from higvf_interfaces.gaze.source import OPTIONS, GazeSource

Write = Callable[..., str]


def source(file: str, **options: object) -> GazeSource:
    return GazeSource(InputSpec("gaze", file), Fields(options, OPTIONS, "gaze"))


def gaze(titles: str, row: str, count: int = 40) -> str:
    rows = "".join(row.format(k=k, t=k / 100, lost=int(k % 4 == 0), seen=int(k % 4 != 0)) + "\n" for k in range(count))
    return titles + "\n" + rows


def signal(titles: str, row: str, count: int = 600) -> str:
    return titles + "\n" + "".join(row.format(k=k, t=1.7e9 + k / 250) + "\n" for k in range(count))


@pytest.mark.parametrize(
    ("titles", "row"),
    [
        ("time,x [px],y [px],validity", "{t},5{k},300,{seen}"),
        ("time,x [px],y [px],is_valid", "{t},5{k},300,{seen}.0"),
        ("time,x [px],y [px],gaze_valid", "{t},5{k},300,{seen}"),
        ("time,x [px],y [px],blink", "{t},5{k},300,{lost}"),
    ],
)
def test_validity_by_other_titles_counts(write: Write, titles: str, row: str) -> None:
    assert np.flatnonzero(~read_gaze(write(gaze(titles, row))).valid).tolist() == list(range(0, 40, 4))


@pytest.mark.parametrize(
    ("titles", "frame"),
    [
        ("time;gaze_x;gaze_y", None), ("timestamp,GazeX,GazeY", None), ("t,eye x,eye y", None),
        ("timestamps,x_gaze,y_gaze", None), ("time_stamp,por_x,por_y", None),
        ("timestamp_ms;gaze_x [px];gaze_y [px]", "screen"), ("time,gaze_x_px,gaze_y_px", "screen"),
        ("time,x_norm,y_norm", "unit"), ("time,gaze_pos_x [m],gaze_pos_y [m]", "arena"),
    ],
)  # fmt: skip
def test_gaze_by_other_titles_is_gaze_and_no_signal(write: Write, titles: str, frame: str | None) -> None:
    row = "{k},0.{k}7,0.3" if "_ms" in titles else "{t},0.{k}7,0.3"
    file = write(gaze(titles, row.replace(",", ";") if ";" in titles else row))
    assert (read_gaze(file).format, read_gaze(file).frame) == ("gaze-csv", frame)
    with pytest.raises(InputError, match="unrecognised format of a signal"):
        read_signals(file)
    if frame is None:
        with pytest.raises(InputError, match="does not specify the frame of x and y; give frame=arena"):
            source(file)


@pytest.mark.parametrize("titles", ["time,left_gaze_x,left_gaze_y", "time,gaze azimuth,gaze elevation"])
def test_gaze_by_titles_that_are_not_understood_is_no_signal_either(write: Write, titles: str) -> None:
    file = write(gaze(titles, "{t},5{k},300", 600))
    for read in (read_gaze, read_signals):
        with pytest.raises(InputError, match=f"unrecognised format.*{titles.split(',')[1]}"):
            read(file)


def test_validity_codes_in_the_other_direction_are_refused(write: Write) -> None:
    with pytest.raises(InputError, match="column validity: '4' means neither valid nor invalid"):
        read_gaze(write(gaze("time,x [px],y [px],validity", "{t},5{k},300,4")))


def test_a_confidence_titled_in_per_cent_is_refused_whatever_its_values(write: Write) -> None:
    with pytest.raises(InputError, match="the unit '%' of the confidence is not understood; write a share"):
        read_gaze(write(gaze("time,x [px],y [px],Confidence [%]", "{t},5{k},300,0.9")))


def test_an_origin_written_as_one_word_is_read(tmp_path: Path) -> None:
    for words, origin in (("bottom-left", "bottom left"), ("CENTRE", "center"), ("upper left corner", None)):
        table = tmp_path / "sub-1_task-a_physio.tsv"
        table.write_text("".join(f"{k / 100}\t500\t400\n" for k in range(40)))
        axes = {axis: {"Units": "px"} for axis in ("x_coordinate", "y_coordinate")}
        table.with_suffix(".json").write_text(json.dumps({"Columns": ["timestamp", *axes], **axes}))
        shown = {"StimulusPresentation": {"ScreenOrigin": words, "ScreenResolution": [1920, 1080]}}
        (tmp_path / "sub-1_task-a_events.json").write_text(json.dumps(shown))
        if origin is None:
            with pytest.raises(InputError, match="ScreenOrigin 'upper left corner' is not understood; give origin="):
                source(str(table))
        else:
            assert source(str(table)).screen.origin == origin


def test_gaze_of_psychopy_is_read_with_the_origin_of_psychopy(write: Write) -> None:
    file = write(gaze("time,x [pix],y [pix]", "{t},-{k},270"))
    with pytest.raises(InputError, match="the unit 'pix' of x and y is not understood"):
        source(file)
    opened = source(file, frame="screen", origin="center-up", screen="1920x1080")
    assert next(pixels for _, pixels in opened.blocks()).points[0].tolist() == [960, 270]


@pytest.mark.parametrize("row", ["{t},0,5{k},0,300,5", "{t},5{k},5,300"])
def test_decimal_commas_between_commas_are_refused_in_any_table(write: Write, row: str) -> None:
    with pytest.raises(InputError, match=r"row 1: \d cells for 3 columns; numbers with a decimal comma need another"):
        read_gaze(write(gaze("time,x [px],y [px]", row)))


def test_row_names_without_a_title_are_refused(write: Write) -> None:
    text = signal("time TP9 AF7".replace(" ", ","), '"{k}",{t:.3f},{k}.5,7')
    with pytest.raises(InputError, match="row 1: 4 cells for 3 columns"):
        read_signals(write(text))


def test_single_rows_with_more_cells_are_dropped_with_a_note(write: Write) -> None:
    text = gaze("time,x [px],y [px]", "{t},5{k},300").replace("0.05,55,300", "0.05,55,300,7,7")
    found = read_gaze(write(text))
    assert len(found.time) == 39
    assert "1 rows with more cells than titles dropped" in found.notes


def test_cells_that_are_empty_beyond_the_titles_do_not_matter(write: Write) -> None:
    assert len(read_gaze(write(gaze("time,x [px],y [px]", "{t},5{k},300,,"))).time) == 40


@pytest.mark.parametrize(
    ("titles", "row", "names"),
    [
        ("Timestamp,EEG.Counter,EEG.Interpolated,EEG.AF3,EEG.T7,EEG.RawCq,CQ.AF3,CQ.T7,EQ.OVERALL,MOT.Q0",
         "{t:.4f},{k},0,{k}.5,7,1,4,4,80,0.1", ("EEG.AF3", "EEG.T7")),
        ("timestamp,index,marker,CP3,C3", "{t:.4f},{k},0,{k}.5,7", ("CP3", "C3")),
        ("time,EEG 1,EEG 2,Accelerometer X,Gyroscope Y,Battery Level,Counter,Validation Indicator",
         "{t:.4f},{k}.5,7,0.1,0.2,90,{k},1", ("EEG 1", "EEG 2")),
        ("timestamp,Packet Number,EMG_1,EMG_2,acc_x,gyro-z", "{t:.4f},{k},{k}.5,7,1,2", ("EMG_1", "EMG_2")),
    ],
)  # fmt: skip
def test_counters_qualities_and_motion_of_other_boards_are_no_channels(
    write: Write, titles: str, row: str, names: tuple[str, ...]
) -> None:
    record = read_signals(write(signal(titles, row)))
    assert record.names == names
    assert whole(record).values[9].tolist() == [9.5, 7]


def test_a_recording_of_motion_alone_keeps_its_channels(write: Write) -> None:
    assert read_signals(write(signal("time,acc_x,acc_y", "{t:.4f},{k},7"))).names == ("acc_x", "acc_y")


def test_a_new_openbci_recording_with_decimal_commas_is_joined_or_refused(write: Write) -> None:
    titles = "Sample Index, EXG Channel 0, EXG Channel 1, Accel Channel 0, Timestamp"
    about = "%OpenBCI Raw EXG Data\n%Number of channels = 2\n%Sample Rate = 250 Hz\n"
    row = "{k}, {k},5, -7,25, 0,1, {t:.6f}".replace("{t:.6f}", "1700000000,00")
    rows = "".join(row.format(k=k % 200) + "\n" for k in range(600))
    assert whole(read_signals(write(about + titles + "\n" + rows))).values[9].tolist() == [9.5, -7.25]
    with pytest.raises(InputError, match="decimal commas and are separated by commas"):
        read_signals(write(about + titles.replace(", ", ",") + "\n" + rows.replace(", ", ",")))


def test_channels_of_one_rate_in_different_units_keep_their_units(tmp_path: Path) -> None:
    parts = [
        edfio.EdfSignal(np.sin(np.arange(1000) / 7), 250, label=label, physical_dimension=unit, physical_range=(-2, 2))
        for label, unit in (("EMG1", "mV"), ("EMG2", "uV"))
    ]
    edfio.Edf(parts).write(tmp_path / "a.edf")
    assert read_signals(str(tmp_path / "a.edf")).units == ("mV", "uV")


def test_a_trigger_channel_of_an_edf_file_is_found_by_any_usual_name(tmp_path: Path) -> None:
    for label in ("Trigger", "STI 014", "STATUS", "Events"):
        pulse = np.zeros(1000)
        pulse[500:] = 3
        parts = [
            edfio.EdfSignal(np.sin(np.arange(1000) / 7), 250, label="EMG", physical_dimension="uV"),
            edfio.EdfSignal(pulse, 250, label=label, physical_range=(-10, 10)),
        ]
        edfio.Edf(parts).write(tmp_path / "a.edf")
        record = read_signals(str(tmp_path / "a.edf"))
        assert (record.names, record.notes) == (("EMG",), [f"triggers, no signal: {label}"])


def test_a_table_without_times_and_with_a_rate_reads_only_signals(write: Write) -> None:
    text = signal("EEG 1,EEG 2,Battery Level,Counter", "{k}.5,7,90,{k}")
    record = read_signals(write(text), SignalRequest(format="signal-csv", rate=250))
    assert (record.names, record.rate) == (("EEG 1", "EEG 2"), 250)


def studio(*units: str) -> str:
    """A table of Tobii Studio with the point of the left eye in several units, in millimetres a tenth of the pixels."""
    titles = "\t".join(f"GazePointLeftX ({unit})\tGazePointLeftY ({unit})" for unit in units)
    scales = [0.1 if "mm" in unit else 1 for unit in units]
    rows = (
        f"{10 * k}\t" + "\t".join(f"{500 * scale:g}\t{300 * scale:g}" for scale in scales) + "\t0" for k in range(40)
    )
    return f"RecordingTimestamp\t{titles}\tValidityLeft\n" + "\n".join(rows) + "\n"


def test_gaze_of_tobii_studio_is_taken_in_pixels_wherever_they_stand(write: Write) -> None:
    assert read_gaze(write(studio("ADCSmm", "ADCSpx"))).points[0].tolist() == [500, 300]
    with pytest.raises(InputError, match=r"GazePointLeftX \(ADCSmm\) is in 'adcsmm', not in pixels of the screen"):
        read_gaze(write(studio("ADCSmm")))


def test_samples_at_the_origin_are_lost_gaze(write: Write) -> None:
    text = gaze("time,x [px],y [px]", "{t},5{k},300") + "0.40,0,0\n0.41,0.0,0\n0.42,0,300\n"
    found = read_gaze(write(text))
    assert np.flatnonzero(~found.valid).tolist() == [40, 41]
    assert "2 samples at exactly 0, 0 taken as lost gaze" in found.notes
    assert read_gaze(write("time,x [m],y [m]\n0,0,0\n0.01,1,2\n")).valid.all()


def test_times_of_signals_in_milliseconds_without_a_unit_are_refused(write: Write) -> None:
    rows = "".join(f"{4 * k},{k % 7}.5\n" for k in range(600))
    with pytest.raises(InputError, match=r"time has no unit, and in seconds its rate is 0\.25 Hz.*such as time \[ms\]"):
        read_signals(write("time,C3\n" + rows))
    assert read_signals(write("time [ms],C3\n" + rows)).rate == pytest.approx(250)
    assert read_signals(write("time [s],C3\n" + rows)).rate == pytest.approx(0.25)


def test_units_of_titles_are_units_and_no_part_of_the_names(write: Write) -> None:
    record = read_signals(write(signal("time,EMG 1 [mV],EMG 2 (µV)", "{t:.4f},{k}.5,7")))
    assert (record.names, record.units) == (("EMG 1", "EMG 2"), ("mV", "uV"))
