"""Recordings generated from a plan read back as planned."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import InputError
from higvf_console.core.viewport import Arena, fit
from higvf_interfaces.formats.reading import read_gaze
from higvf_interfaces.formats.records import Decision
from higvf_interfaces.formats.signals.reading import read_decisions
from higvf_interfaces.gaze.fixations import PX_PER_DEG, centroid, classify
from higvf_interfaces.recordings.files import write_command_csv, write_command_jsonl, write_gaze_csv, write_gaze_tsv
from higvf_interfaces.recordings.gaze import DrawnByEye, along, synthetic_gaze
from higvf_interfaces.recordings.plan import main, make_recordings

Write = Callable[..., str]
SCREEN = fit(Arena(0.0, 0.0, 1200.0, 700.0), 1920, 1080)
LINE = floats([[200, 200], [500, 400], [900, 350], [1000, 600]])
STROKE = DrawnByEye(4.0, 10.0, LINE)
SAMPLES = synthetic_gaze([STROKE], 14.0, SCREEN, seed=3)
PLAN = """
seed: 7
duration_s: 12
arena_m: [0, 0, 1200, 700]
screen_px: [1920, 1080]
gaze:
  file: gaze.tsv
  decimal_comma: true
  strokes:
    - {from_s: 3, to_s: 8, points_m: [[200, 200], [500, 400], [900, 350]]}
commands:
  - {file: emg.csv, labels: [[2.0, fist, 0.93], [9, open]]}
  - {file: bci.jsonl, labels: [[8.5, robot2, 0.7]]}
"""


def distance_to_line(point: Floats) -> float:
    """Distance of a ground point to the drawn polyline [m]."""
    return float(np.hypot(*(along(LINE, np.linspace(0, 1, 2000)) - point).T).min())


@pytest.mark.parametrize("decimal_comma", [False, True])
def test_gaze_written_as_tobii_pro_lab_reads_back(write: Write, decimal_comma: bool) -> None:
    text = write_gaze_tsv(SAMPLES, (1920, 1080), decimal_comma=decimal_comma)
    gaze = read_gaze(write(text))
    assert gaze.format == "tobii-prolab"
    assert gaze.screen == (1920, 1080)
    assert gaze.notes == ()
    np.testing.assert_allclose(gaze.time, SAMPLES.time, atol=1e-6)
    np.testing.assert_allclose(gaze.points, SAMPLES.points, atol=0.051)
    np.testing.assert_array_equal(gaze.valid, SAMPLES.valid)
    assert bool(re.search(r"\d,\d", text)) is decimal_comma


def test_gaze_written_as_a_plain_table_reads_back(write: Write) -> None:
    gaze = read_gaze(write(write_gaze_csv(SAMPLES)))
    assert (gaze.format, gaze.frame) == ("gaze-csv", "screen")
    np.testing.assert_allclose(gaze.points, SAMPLES.points, atol=0.051)
    np.testing.assert_array_equal(gaze.valid, SAMPLES.valid)


@pytest.mark.parametrize("writer", [write_command_csv, write_command_jsonl])
def test_command_logs_read_back(write: Write, writer: Callable[[list[Decision]], str]) -> None:
    decisions = [Decision(1.25, "fist", 0.93), Decision(2.0, 'a "b", c', None)]
    assert read_decisions(write(writer(decisions))).decisions == tuple(decisions)


@pytest.mark.parametrize("seed", range(5))
def test_gaze_stays_within_half_a_degree_of_the_polyline_and_reaches_its_ends(seed: int) -> None:
    samples = synthetic_gaze([STROKE], 14.0, SCREEN, seed=seed)
    found = classify(samples.time, samples.points, samples.valid)
    during = (found.time[found.last] > STROKE.start) & (found.time[found.first] < STROKE.end)
    centres = [centroid(found, *ends) for ends in zip(found.first[during], found.last[during], strict=True)]
    ground = SCREEN.to_ground(floats(centres))
    half_a_degree = 0.5 * PX_PER_DEG * SCREEN.metres_per_px
    assert len(ground) >= 12
    assert max(distance_to_line(point) for point in ground) < half_a_degree
    assert np.hypot(*(ground[0] - LINE[0])) < half_a_degree
    assert np.hypot(*(ground[-1] - LINE[-1])) < half_a_degree


def test_fixations_last_250_to_400_ms() -> None:
    samples = synthetic_gaze([], 60.0, SCREEN, seed=1)
    found = classify(samples.time, samples.points, samples.valid)
    lasted = found.time[found.last] - found.time[found.first]
    assert 0.25 < np.median(lasted) < 0.40


def test_each_stroke_has_one_blink() -> None:
    lost = SAMPLES.time[~SAMPLES.valid]
    assert lost[0] == pytest.approx(7.0 - 0.075, abs=0.01)
    assert lost[-1] == pytest.approx(7.0 + 0.075, abs=0.01)


def test_the_same_seed_gives_the_same_samples_and_another_gives_others() -> None:
    again = synthetic_gaze([STROKE], 14.0, SCREEN, seed=3)
    np.testing.assert_array_equal(again.points, SAMPLES.points)
    assert not np.array_equal(synthetic_gaze([STROKE], 14.0, SCREEN, seed=4).points, SAMPLES.points, equal_nan=True)


def test_the_command_writes_what_the_plan_asks_for(write: Write, tmp_path: Path) -> None:
    plan = write(PLAN, "plan.yaml")
    command = [sys.executable, "-m", "higvf_interfaces.recordings.__main__", str(tmp_path / "out"), "--plan", plan]
    subprocess.run(command, check=True, capture_output=True)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["bci.jsonl", "emg.csv", "gaze.tsv"]
    assert read_gaze(str(tmp_path / "out" / "gaze.tsv")).time[-1] == pytest.approx(12, abs=0.01)
    assert read_decisions(str(tmp_path / "out" / "emg.csv")).decisions == ((2.0, "fist", 0.93), (9.0, "open", None))
    assert {name: text.encode() for name, text in make_recordings(Path(plan)).items()} == {
        path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()
    }, "the same bytes each time"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("seed: 7", "sede: 7", "sede: unknown key (did you mean 'seed'?); value 7; known keys: seed, duration_s"),
        ("seed: 7", "seed: -1", "seed: -1 is not a whole number from 0 up"),
        ("from_s: 3", "from_s: 7.5", "gaze.strokes[1].to_s: 8 is not a number from 8.5 to 12 s"),
        ("[2.0, fist, 0.93]", "[2.0, fist, 93]", "commands[1].labels[1]: [2.0, 'fist', 93] is not [seconds, label]"),
        ("file: emg.csv", "file: ../emg.csv", "commands[1].file: '../emg.csv' is not a plain file name"),
        ("[0, 0, 1200, 700]", "[0, 0, 0, 700]", "arena_m: [0, 0, 0, 700] is not [x_min, y_min, x_max, y_max]"),
        ("screen_px: [1920, 1080]", "screen_px: 1920", "screen_px: 1920 is not a list of 2 numbers"),
        (
            "[[200, 200], [500, 400], [900, 350]]",
            "[[200, 200]]",
            "strokes[1].points_m: 1 points are too few; give at least 2",
        ),
        ("decimal_comma: true", "format: xdf", "gaze.format: 'xdf' is not one of tobii-prolab, gaze-csv"),
    ],
)
def test_a_wrong_plan_is_refused_with_its_place(write: Write, old: str, new: str, message: str) -> None:
    assert old in PLAN
    with pytest.raises(InputError) as refusal:
        make_recordings(Path(write(PLAN.replace(old, new), "plan.yaml")))
    assert message in str(refusal.value)


def test_the_command_reports_an_error_and_exits_with_two(
    write: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path), "--plan", write("- 1", "plan.yaml")]) == 2
    assert "is not a section with the keys seed" in capsys.readouterr().err
