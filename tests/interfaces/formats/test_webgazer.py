"""Predictions of WebGazer are read from JSON, plain or as the data of jsPsych."""

import json
from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.reading import read_gaze

Write = Callable[..., str]
POINTS = [{"x": 500.0 + k, "y": 400.0, "t": 30 * k} for k in range(20)]


def trial(end: int, **more: object) -> dict[str, object]:
    return {"trial_type": "html", "time_elapsed": end, "webgazer_data": POINTS, **more}


@pytest.mark.parametrize("text", [json.dumps(POINTS), "\n".join(map(json.dumps, POINTS)) + "\n"])
def test_a_list_or_lines_of_points_are_read_in_milliseconds(write: Write, text: str) -> None:
    gaze = read_gaze(write(text))
    assert (gaze.format, gaze.frame, gaze.origin, gaze.screen) == ("webgazer-json", "screen", "top left", None)
    assert gaze.time == pytest.approx(np.arange(20) * 0.03)
    assert gaze.points[1].tolist() == [501, 400]
    assert any("give screen=" in note for note in gaze.notes)


def test_trials_of_jspsych_stand_on_the_clock_of_the_experiment(write: Write) -> None:
    check = {"trial_type": "browser-check", "width": 1280, "height": 720, "time_elapsed": 100}
    text = json.dumps([check, trial(2000), trial(5000, webgazer_data=json.dumps(POINTS))], indent=1)
    gaze = read_gaze(write(text))
    assert gaze.screen == (1280, 720)
    assert len(gaze.time) == 40
    assert gaze.time[20] - gaze.time[19] == pytest.approx(5.0 - 0.57 - 2.0)
    assert not any("give screen=" in note for note in gaze.notes)


def test_a_trial_begins_its_response_time_before_its_end(write: Write) -> None:
    text = json.dumps([trial(2000), trial(5000, rt=2900)])
    assert read_gaze(write(text)).time[20] == pytest.approx(5.0 - 2.9 - (2.0 - 0.57))


def test_predictions_without_a_face_are_missing(write: Write) -> None:
    gaze = read_gaze(write(json.dumps([*POINTS, {"x": None, "y": None, "t": 600}])))
    assert np.flatnonzero(~gaze.valid).tolist() == [20]


def test_times_in_seconds_are_told_by_their_steps_with_a_note(write: Write) -> None:
    gaze = read_gaze(write(json.dumps([{**point, "t": point["t"] * 1e-3} for point in POINTS])))
    assert gaze.time[-1] == pytest.approx(0.57)
    assert "the times are in s by their steps, not in ms" in gaze.notes


def test_json_without_points_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="no object has x, y and one of t, time"):
        read_gaze(write('[{"a": 1}]'), "webgazer-json")
    with pytest.raises(InputError, match="unrecognised format"):
        read_gaze(write('{"time": 1.5, "label": "fist"}\n'))
