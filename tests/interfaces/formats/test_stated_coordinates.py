"""A stated frame, origin, validity or unit that is not understood is refused with the way out, in every format."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec
from higvf_interfaces.fields import Fields
from higvf_interfaces.formats.coordinates import Coordinates, stated_frame, stated_origin
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.records import BOTTOM_LEFT, CENTER, TOP_LEFT
from higvf_interfaces.gaze.source import OPTIONS, GazeSource
from tests.gaze_files import xdf_stream

Write = Callable[..., str]


def source(file: str, **options: object) -> GazeSource:
    return GazeSource(InputSpec("gaze", file), Fields(options, OPTIONS, "gaze"))


def first_pixel(file: str, **options: object) -> list[float]:
    return next(pixels for _, pixels in source(file, **options).blocks()).points[0].tolist()


def xdf(path: Path, unit: str, system: str, labels: tuple[str, str] = ("x", "y")) -> str:
    """A gaze stream whose channels state unit and coordinate system."""
    x, y = (250, 500) if unit == "pixels" else (0.25, 0.5)
    stream = xdf_stream(1, "Eyes", "Gaze", labels, [(5.0 + k / 100, x, y) for k in range(20)])
    path.write_bytes(b"XDF:" + _described(stream, unit, system))
    return str(path)


def _described(stream: bytes, unit: str, system: str) -> bytes:
    """The stream with another unit and a coordinate system in its header chunk, the first one."""
    length = int.from_bytes(stream[1:5], "little")
    header, rest = stream[5 : 5 + length], stream[5 + length :]
    stated = f"<unit>{unit}</unit><coordinate_system>{system}</coordinate_system>".encode()
    header = header.replace(b"<unit>pixels</unit>", stated)
    return stream[:1] + len(header).to_bytes(4, "little") + header + rest


def bids(folder: Path, presentation: Mapping[str, object], **sidecar: object) -> str:
    table = folder / "sub-01_task-a_recording-eye1_physio.tsv"
    table.write_text("".join(f"{k / 100}\t-576\t-270\n" for k in range(40)))
    axes = {axis: {"Units": "pixel"} for axis in ("x_coordinate", "y_coordinate")}
    content = {"Columns": ["timestamp", *axes], "timestamp": {"Units": "s"}, **axes, **sidecar}
    table.with_suffix(".json").write_text(json.dumps(content))
    (folder / "sub-01_task-a_events.json").write_text(json.dumps({"StimulusPresentation": presentation}))
    return str(table)


@pytest.mark.parametrize(
    ("units", "systems", "frame"),
    [
        (("px", "px"), (), "screen"),
        (("Pixels", "pixels"), ("screen", "Screen"), "screen"),
        (("normalized", "normalized"), ("display-area", "display_area"), "unit"),
        (("pixels", "pixels"), ("world", "world"), "scene"),
        (("normalised", "normalised"), ("scene camera", "scene camera"), "scene-unit"),
        (("", ""), ("screen", "screen"), None),
        (("", ""), (), None),
    ],
)
def test_units_and_coordinate_systems_give_the_frame(
    units: tuple[str, str], systems: tuple[str, ...], frame: str | None
) -> None:
    assert stated_frame(units, systems) == Coordinates(frame)


@pytest.mark.parametrize(
    ("units", "systems", "said"),
    [
        (("mm", "mm"), (), "'mm'"),
        (("deg", "deg"), ("screen", "screen"), "'deg'"),
        (("px", "mm"), (), "'mm' and 'px'"),
        (("px", "px"), ("eye", "eye"), "'eye'"),
        (("px", "px"), ("screen", "world"), "'screen' and 'world'"),
        (("", ""), ("world", "world"), "'world' without a known unit"),
    ],
)
def test_what_is_not_understood_becomes_a_doubt_and_no_frame(
    units: tuple[str, str], systems: tuple[str, ...], said: str
) -> None:
    stated = stated_frame(units, systems)
    assert stated.frame is None
    assert all(doubt.option == "frame" for doubt in stated.doubts)
    assert said in stated.doubts[0].statement


@pytest.mark.parametrize(
    ("words", "origin"),
    [("top, left", TOP_LEFT), ("Left-Bottom", BOTTOM_LEFT), ("center, center", CENTER), ("middle centre", CENTER)],
)
def test_an_origin_is_a_corner_on_the_left_or_the_center(words: str, origin: str) -> None:
    assert stated_origin(words, "ScreenOrigin") == (origin, ())


@pytest.mark.parametrize("words", ["top, right", "bottom right", "top, center", "somewhere", ""])
def test_other_origins_are_doubts(words: str) -> None:
    (doubt,) = stated_origin(words, "ScreenOrigin")[1]
    assert doubt.option == "origin"
    assert f"ScreenOrigin {words!r}" in doubt.statement


def test_gaze_of_a_scene_camera_in_xdf_is_refused_unless_the_frame_is_given(tmp_path: Path) -> None:
    file = xdf(tmp_path / "a", "pixels", "world")
    assert read_gaze(file).frame == "scene"
    with pytest.raises(InputError, match=r"camera on the head.*calibration=FILE.*frame=screen"):
        source(file)
    assert source(file, frame="screen").screen.frame == "screen"


@pytest.mark.parametrize(("unit", "system"), [("mm", "screen"), ("pixels", "eye-in-head"), ("degrees", "")])
def test_an_unknown_unit_or_coordinate_system_in_xdf_is_refused(tmp_path: Path, unit: str, system: str) -> None:
    file = xdf(tmp_path / "a", unit, system)
    with pytest.raises(InputError, match=r"is not understood; give frame=arena \(metres\), frame=screen"):
        source(file)
    assert source(file, frame="screen" if unit == "pixels" else "unit").screen is not None


def test_channels_selected_by_options_keep_the_origin_of_their_labels(tmp_path: Path) -> None:
    file = xdf(tmp_path / "a", "normalized", "screen", ("norm_pos_x", "norm_pos_y"))
    assert first_pixel(file, x="norm_pos_x", y="norm_pos_y", screen="100x100") == [25, 50]
    assert source(file, x="1", y="2").screen.origin == BOTTOM_LEFT


def test_an_origin_at_the_center_is_half_the_screen_away(tmp_path: Path) -> None:
    size = {"ScreenResolution": [1920, 1080]}
    file = bids(tmp_path, {**size, "ScreenOrigin": ["center", "center"]})
    assert first_pixel(file) == [384, 270]
    assert any("give origin=center-up" in note for note in source(file).notes)
    assert first_pixel(file, origin="center-up") == [384, 810]


@pytest.mark.parametrize(
    ("presentation", "option"),
    [
        ({"ScreenOrigin": ["top", "right"], "ScreenResolution": [1920, 1080]}, "origin=top-left"),
        ({"ScreenOrigin": 7, "ScreenResolution": [1920, 1080]}, "origin=top-left"),
        ({"ScreenResolution": "full HD"}, "screen=WIDTHxHEIGHT"),
    ],
)
def test_an_unknown_origin_or_size_of_a_bids_screen_is_refused(
    tmp_path: Path, presentation: Mapping[str, object], option: str
) -> None:
    with pytest.raises(InputError, match=f"is not understood; give {option}"):
        source(bids(tmp_path, presentation))


@pytest.mark.parametrize(
    ("sidecar", "said"),
    [
        ({"x_coordinate": {"Units": "mm"}, "y_coordinate": {"Units": "mm"}}, "the unit 'mm'"),
        ({"SampleCoordinateSystem": "gaze-in-world"}, "camera on the head"),
        ({"SampleCoordinateSystem": "eye-in-head"}, "'eye in head' is not understood"),
    ],
)
def test_an_unknown_unit_or_system_of_bids_is_refused(tmp_path: Path, sidecar: Mapping[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        source(bids(tmp_path, {}, **sidecar))


def test_an_unknown_unit_of_time_of_bids_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'ticks', the unit of timestamp in its JSON, is not a unit of time"):
        source(bids(tmp_path, {}, timestamp={"Units": "ticks"}))


@pytest.mark.parametrize("unit", ["mm", "deg", "%"])
def test_an_unknown_unit_in_a_title_is_refused(write: Write, unit: str) -> None:
    text = f"time,x [{unit}],y [{unit}]\n" + "".join(f"{k / 100},1,2\n" for k in range(20))
    with pytest.raises(InputError, match=f"the unit '{unit}' of x and y is not understood; give frame="):
        source(write(text))


GLASSES = "Recording timestamp\tSensor\tGaze point X{}\tGaze point Y{}\tValidity left\tValidity right{}\n"


def prolab(unit: str, more: str, *rows: str) -> str:
    gaze = [f"{10_000 * k}\tEye Tracker\t384\t272\tValid\tValid" for k in range(20)]
    return GLASSES.format(unit, unit, more) + "\n".join([*gaze, *rows]) + "\n"


@pytest.mark.parametrize(
    ("unit", "more", "rows"),
    [
        ("", "\tGyro X\tGyro Y", ()),
        ("", "", ("3000\tGyroscope\t\t\t\t",)),
        ("", "", ("3000\tAccelerometer\t\t\t\t",)),
        (" [MCS px]", "\tGaze point 3D X [HUCS mm]", ()),
    ],
)
def test_gaze_of_tobii_glasses_is_that_of_a_scene_camera(
    write: Write, unit: str, more: str, rows: tuple[str, ...]
) -> None:
    file = write(prolab(unit, more, *rows))
    assert read_gaze(file).frame == "scene"
    with pytest.raises(InputError, match="camera on the head"):
        source(file)


def test_pro_lab_gaze_without_unit_is_on_the_screen_only_if_a_screen_is_stated(write: Write) -> None:
    assert read_gaze(write(prolab("", "\tRecording resolution width"))).frame == "screen"
    with pytest.raises(InputError, match="does not specify the frame of x and y; give frame="):
        source(write(prolab("", "")))


def test_a_plain_table_states_its_origin_in_a_column(write: Write) -> None:
    def table(*origins: str) -> str:
        rows = (f"{k / 100},{500 + k},{400 + k},{origins[k % len(origins)]}\n" for k in range(20))
        return write("time,x [px],y [px],origin\n" + "".join(rows))

    assert read_gaze(table("bottom-left", "")).origin == BOTTOM_LEFT
    assert read_gaze(table("")).origin == TOP_LEFT
    for unknown in (("somewhere",), ("top-left", "bottom-left")):
        with pytest.raises(InputError, match=r"the column origin '.*give origin="):
            source(table(*unknown))


def test_sizes_of_an_eyelink_screen_are_read_as_last_pixel_or_as_size(write: Write) -> None:
    for bounds, size in (("0 0 1919 1079", (1920, 1080)), ("0.00 0.00 1920.00 1080.00", (1920, 1080)),
                         ("100 50 1465 817", (1366, 768)), ("0 0 1366 768", (1366, 768))):  # fmt: skip
        text = f"MSG\t1 GAZE_COORDS {bounds}\nSAMPLES\tGAZE\tLEFT\tRATE\t1000.00\n1\t200.0\t150.0\t700.0\t...\n"
        assert read_gaze(write(text)).screen == size


def eyelink(*messages: str, rows: str = "10 200.0 150.0 700.0 ...\n") -> str:
    said = "".join(f"MSG\t1 {message}\n" for message in messages)
    return f"{said}SAMPLES\tGAZE\tLEFT\tRATE\t1000.00\n{rows}"


@pytest.mark.parametrize(
    ("bounds", "origin", "pixels"),
    [
        ("0 0 1919 1079", "top left", [200, 150]),
        ("0 1079 1919 0", "bottom left", [200, 930]),
        ("-960.00 540.00 960.00 -540.00", "bottom left", [1160, 390]),
        ("1919 0 0 1079", "top left", [1719, 150]),
        ("= 0 0 1919 1079", "top left", [200, 150]),
        ("= [0, 0, 1919, 1079]", "top left", [200, 150]),
    ],
)
def test_bounds_of_eyelink_say_from_which_side_x_and_y_count(
    write: Write, bounds: str, origin: str, pixels: list[float]
) -> None:
    opened = source(write(eyelink(f"GAZE_COORDS {bounds}")))
    assert opened.screen.origin == origin
    assert (opened.screen.shown.width_px, opened.screen.shown.height_px) == (1920, 1080)
    assert next(shown for _, shown in opened.blocks()).points[0].tolist() == pixels
    assert opened.notes == ()


@pytest.mark.parametrize("bounds", ["0 0 0 0", "left top right bottom", "0 0 1919"])
def test_bounds_of_eyelink_that_are_not_understood_are_refused_with_the_way_out(write: Write, bounds: str) -> None:
    file = write(eyelink(f"GAZE_COORDS {bounds}"))
    with pytest.raises(InputError, match=f"GAZE_COORDS {bounds} is not understood; give screen=WIDTHxHEIGHT"):
        source(file)
    assert source(file, screen="1280x1024").screen.shown.width_px == 1280


def test_bounds_of_eyelink_that_contradict_each_other_are_refused(write: Write) -> None:
    with pytest.raises(InputError, match="DISPLAY_COORDS 0 0 1919 1079 contradicts the bounds before it"):
        source(write(eyelink("GAZE_COORDS 0 1079 1919 0", "DISPLAY_COORDS 0 0 1919 1079")))


@pytest.mark.parametrize("title", ["on_surf", "on_srf"])
def test_gaze_off_a_surface_is_invalid_by_either_title(write: Write, title: str) -> None:
    text = f"gaze_timestamp,x_norm,y_norm,{title},confidence\n1,0.5,0.5,True,0.9\n2,0.5,0.5,False,0.9\n"
    gaze = read_gaze(write(text))
    assert (gaze.format, gaze.valid.tolist()) == ("pupil-surface", [True, False])


def test_gaze_on_a_surface_without_the_column_that_says_so_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="no column on_surf or on_srf"):
        read_gaze(write("gaze_timestamp,x_norm,y_norm\n1,0.5,0.5\n"), "pupil-surface")


@pytest.mark.parametrize(
    "text",
    [
        "time,x [px],y [px],valid\n0,1,2,perhaps\n",
        "time,x [px],y [px],valid\n0,1,2,4\n",
        "gaze_timestamp,x_norm,y_norm,on_surf\n1,0.5,0.5,2\n",
        "TIME,BPOGX,BPOGY,BPOGV\n0,0.5,0.5,ok\n",
        "device_time_stamp,left_gaze_point_on_display_area_x,left_gaze_point_on_display_area_y,"
        "left_gaze_point_validity\n0,0.5,0.5,4\n",
    ],
)
def test_a_validity_that_is_not_understood_is_refused_with_the_known_ones(write: Write, text: str) -> None:
    with pytest.raises(InputError, match=r"column .*: '.*' means neither valid nor invalid; known: 1, .*; 0, "):
        read_gaze(write(text))


def test_validity_words_of_pro_lab_in_another_language_are_refused(write: Write) -> None:
    text = prolab(" [DACS px]", "").replace("Valid\tValid\n", "ja\tja\n")
    with pytest.raises(InputError, match="validity 'ja' is not understood; known: Valid, Invalid"):
        read_gaze(write(text))


def test_samples_of_low_confidence_are_not_valid_in_any_format(write: Write) -> None:
    rows = "".join(f"{k / 100},5,5,{0.12 if k == 3 else 0.98}\n" for k in range(20))
    file = write("time,x [px],y [px],confidence\n" + rows)
    assert np.flatnonzero(~read_gaze(file).valid).tolist() == [3]
    assert "1 samples below min_confidence" in source(file).notes
    assert "1 samples below min_confidence" not in source(file, min_confidence=0.1).notes


def test_a_confidence_in_per_cent_is_refused(write: Write) -> None:
    file = write("time,x [px],y [px],confidence\n0,5,5,12\n0.01,5,5,98\n")
    with pytest.raises(InputError, match="confidence 98 is not a share from 0 to 1"):
        source(file)


@pytest.mark.parametrize("more", [",left_gaze_point_available", ""])
def test_validity_columns_of_titta_count(write: Write, more: str) -> None:
    point = "left_gaze_point_on_display_area"
    value = ",True" if more else ""
    text = f"device_time_stamp,{point}_x,{point}_y,left_gaze_point_valid{more}\n" + (
        f"0,0.5,0.25,True{value}\n10000,0.5,0.25,False{value}\n"
    )
    gaze = read_gaze(write(text))
    assert gaze.valid.tolist() == [True, False]
    assert gaze.notes == ()


def test_tobii_gaze_without_a_validity_column_is_noted(write: Write) -> None:
    text = "device_time_stamp,left_gaze_point_on_display_area_x,left_gaze_point_on_display_area_y\n0,0.5,0.25\n"
    assert any("no validity column" in note for note in read_gaze(write(text)).notes)


def test_shares_of_the_screen_that_are_called_pixels_are_refused(write: Write) -> None:
    file = write("time,x,y\n" + "".join(f"{k / 100},0.5,0.{k % 10}\n" for k in range(40)))
    with pytest.raises(InputError, match="x and y lie between 0 and 1, so they are no pixels; give frame=unit"):
        source(file, frame="screen")
    assert source(file, frame="unit").screen.frame == "unit"


def test_much_gaze_off_the_screen_hints_at_wrong_coordinates(write: Write) -> None:
    file = write("time,x,y\n" + "".join(f"{k / 100},{k % 5 / 2 - 1},0.5\n" for k in range(40)))
    opened = source(file, frame="unit")
    list(opened.blocks())
    assert any("16 samples off the screen; check frame, origin and screen" in note for note in opened.notes)


@pytest.mark.parametrize(
    ("unit", "system", "frame"),
    [
        ("normalized", "world", "scene-unit"),
        ("normalized", "", "scene-unit"),
        ("", "", "scene-unit"),
        ("normalized", "surface", "unit"),
    ],
)
def test_gaze_of_pupil_capture_is_that_of_its_camera_unless_it_is_on_a_surface(
    tmp_path: Path, unit: str, system: str, frame: str
) -> None:
    gaze = read_gaze(xdf(tmp_path / "a", unit, system, ("norm_pos_x", "norm_pos_y")))
    assert (gaze.frame, gaze.origin) == (frame, BOTTOM_LEFT)
