"""The homography from screen to arena is exact where possible, and refused if its horizon crosses the screen."""

from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import Cursor
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec, OperatorContext
from higvf_console.core.viewport import Arena, fit
from higvf_interfaces.gaze.calibration import (
    calibrate,
    calibration_report,
    calibration_text,
    read_calibration,
    targets,
    to_arena,
)
from higvf_interfaces.gaze.interface import open_gaze

ARENA = Arena(0.0, 0.0, 1200.0, 700.0)
SCREEN = (1920.0, 1080.0)
Write = Callable[..., str]


def seen_from_aside(ground: Floats, tilt: float) -> Floats:
    """Screen pixels of ground points in an oblique view."""
    flat = fit(ARENA, *SCREEN).to_screen(ground)
    return floats(flat / (1 + tilt * flat[:, :1] / SCREEN[0]))


@settings(max_examples=30)
@given(tilt=st.floats(-0.3, 0.6), x=st.floats(0, 1200), y=st.floats(0, 700), count=st.sampled_from([4, 5]))
def test_points_between_the_targets_are_mapped_exactly(tilt: float, x: float, y: float, count: int) -> None:
    looked = targets(ARENA, count)
    calibration = calibrate(seen_from_aside(looked, tilt), looked, SCREEN)
    assert calibration.residual < 1e-4
    where = floats([[x, y]])
    np.testing.assert_allclose(to_arena(calibration, seen_from_aside(where, tilt)), where, atol=1e-3)


def test_the_residual_is_the_rms_error_in_metres() -> None:
    looked = targets(ARENA, 5)
    pixels = fit(ARENA, *SCREEN).to_screen(looked)
    pixels[4] += [0.0, 30.0]
    off = 30 * 700 / 1080
    calibration = calibrate(pixels, looked, SCREEN)
    assert 0.2 * off < calibration.residual < off
    with_four = calibrate(pixels[:4], looked[:4], SCREEN)
    assert with_four.residual < 1e-4, "four points always fit, whatever they are"


def test_targets_are_clockwise_from_the_top_left_and_inside_the_arena() -> None:
    np.testing.assert_allclose(targets(ARENA, 5), [[120, 630], [1080, 630], [1080, 70], [120, 70], [600, 350]])
    with pytest.raises(InputError, match="7 points; choose 4"):
        targets(ARENA, 7)


@pytest.mark.parametrize(
    ("pixels", "ground", "message"),
    [
        ([[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 0], [1, 1]], "3 points_px and 3 points_m; give the same"),
        ([[0, 0], [1, 1], [2, 2], [3, 3]], [[0, 0], [9, 0], [9, 9], [0, 9]], "no homography fits these points"),
        ([[5, 5]] * 4, [[0, 0], [9, 0], [9, 9], [0, 9]], "no homography fits these points"),
        ([[100, 500], [500, 500], [350, 300], [250, 300]], [[0, 0], [9, 0], [9, 90], [0, 90]], "horizon"),
    ],
    ids=["too few", "on a line", "one place", "horizon on the screen"],
)
def test_points_without_a_valid_homography_are_refused(
    pixels: list[list[float]], ground: list[list[float]], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        calibrate(floats(pixels), floats(ground), SCREEN)


def test_gaze_beyond_the_horizon_is_nan() -> None:
    looked = targets(ARENA, 4)
    calibration = calibrate(seen_from_aside(looked, 0.5), looked, SCREEN)
    ends = to_arena(calibration, floats([[-1e6, 500], [1e6, 500]]))
    assert np.count_nonzero(np.isnan(ends).all(axis=1)) == 1


def test_a_stored_calibration_is_read_back(tmp_path: Path) -> None:
    looked = targets(ARENA, 5)
    calibration = calibrate(seen_from_aside(looked, 0.2), looked, SCREEN)
    (tmp_path / "c.yaml").write_text(calibration_text(calibration))
    again = read_calibration(tmp_path / "c.yaml")
    np.testing.assert_allclose(again.homography, calibration.homography, atol=1e-9)
    assert again.screen == SCREEN


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1, 2]", "is not a section with the keys screen_px, points_px, points_m"),
        ("{colour: red}", "colour: unknown key; value 'red'; known keys: screen_px"),
        ("{points_px: [[1, 2]], points_m: [[1, 2]]}", "the key 'screen_px' is missing"),
        (
            "{screen_px: [1920, 1080], points_px: [[1, 2, 3]], points_m: [[1, 2]]}",
            r"points_px\[1\]: \[1, 2, 3\] is not a point",
        ),
    ],
)
def test_a_wrong_file_is_refused_with_place_and_keys(write: Write, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_calibration(Path(write(text)))


def test_a_calibrated_channel_puts_the_cursor_where_the_operator_looks(
    write: Write, at: Callable[..., OperatorContext]
) -> None:
    looked = targets(ARENA, 5)
    file = write(calibration_text(calibrate(seen_from_aside(looked, 0.4), looked, SCREEN)), "c.yaml")
    ((x, y),) = seen_from_aside(floats([[900, 200]]), 0.4)
    gaze = write("time,x [px],y [px]\n" + "".join(f"{k / 100},{x},{y}\n" for k in range(100)), "gaze.csv")
    cursor = open_gaze(InputSpec("gaze", gaze, {"calibration": file}, arena=ARENA)).poll(at(0.5))[-1]
    assert isinstance(cursor, Cursor)
    np.testing.assert_allclose(cursor.point, [900, 200], atol=1e-3)


@pytest.mark.parametrize(
    ("line", "made"),
    [
        ("made: 2026-03-02T14:05:00+01:00", "2026-03-02T14:05:00+01:00"),
        ("made: 2026-03-02", "2026-03-02"),
        ("made: after lunch", "after lunch"),
    ],
)
def test_the_report_of_a_calibration_has_its_date_and_residual(write: Write, line: str, made: str) -> None:
    looked = targets(ARENA, 5)
    pixels = fit(ARENA, *SCREEN).to_screen(looked)
    pixels[4] += [0.0, 30.0]
    text = calibration_text(calibrate(pixels, looked, SCREEN))
    report = calibration_report(read_calibration(Path(write(f"{text}{line}\n"))))
    assert report.made == made
    assert report.residual_m / report.residual_px == pytest.approx(700 / 1080, rel=0.1)


def test_a_calibration_file_without_a_date_uses_its_modification_time(write: Write) -> None:
    looked = targets(ARENA, 4)
    file = Path(write(calibration_text(calibrate(seen_from_aside(looked, 0.1), looked, SCREEN))))
    assert datetime.fromisoformat(read_calibration(file).made).timestamp() == pytest.approx(file.stat().st_mtime, abs=1)
