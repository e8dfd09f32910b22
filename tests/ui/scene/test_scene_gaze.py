"""The heat of gaze as a picture, and the ring of the button; pure, without a browser."""

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.reports import AttentionReport, CaptureReport
from higvf_console.core.viewport import Arena
from higvf_console.ui.interaction.calibration import shown_target
from higvf_console.ui.scene.gaze import heat_picture, progress_ring


def report(*spots: tuple[int, int, float]) -> AttentionReport:
    heat = np.zeros((70, 120))
    for row, column, seconds in spots:
        heat[row, column] = seconds
    nothing = floats([])
    return AttentionReport(
        heat=heat,
        extent=Arena(0, 0, 1200, 700),
        degree=25.0,
        fires=nothing,
        robots=nothing,
        elsewhere=0.0,
        fixation_rate=0.0,
        fixation_duration=np.nan,
        transition_entropy=np.nan,
    )


def test_the_brightest_and_least_clear_place_is_where_gaze_was_longest() -> None:
    picture = heat_picture(report((10, 20, 5.0), (50, 90, 1.0)))
    light = picture[:, :, :3].astype(int).sum(axis=2)
    assert picture.shape == (70, 120, 4)
    assert np.unravel_index(np.argmax(picture[:, :, 3]), (70, 120)) == (10, 20)
    assert light[10, 20] > light[50, 90] > light[30, 60]
    assert picture[10, 20, 3] > picture[50, 90, 3] > 0
    assert picture[30, 60, 3] == 0
    assert picture[:, :, 3].max() < 255, "what is below stays visible"


def test_without_gaze_the_picture_is_clear() -> None:
    assert not heat_picture(report())[:, :, 3].any()


def test_the_ring_fills_clockwise_from_the_top() -> None:
    quarter, whole = progress_ring(10.0, 0.25), progress_ring(10.0, 1.0)
    np.testing.assert_allclose(quarter[0, 0], [0, 10], atol=1e-9)
    np.testing.assert_allclose(quarter[-1, 1], [10, 0], atol=1e-9)
    np.testing.assert_allclose(whole[-1, 1], [0, 10], atol=1e-9)
    assert len(progress_ring(10.0, 0.0)) == 0


def test_a_page_is_told_of_a_target_only_while_there_is_one() -> None:
    assert shown_target(None) is None
    assert shown_target(CaptureReport("replayed")) is None
    target = shown_target(CaptureReport("", floats([120, 630]), 2, 5, 0.33))
    assert target == {"point": [120.0, 630.0], "number": 2, "targets": 5, "progress": pytest.approx(0.35)}
