"""Whole runs from the command line, as a user starts them: scripts, recorded devices, a real eye tracker."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from higvf_console.cli.main import main

SCRIPTS = Path(__file__).parents[2] / "scenarios" / "scripts"


def report(tmp_path: Path, *arguments: str) -> dict[str, Any]:
    file = tmp_path / "report.json"
    assert main(["run", *arguments, "--headless", "--report", str(file)]) == 0
    return json.loads(file.read_text())


def test_scripted_strokes_change_the_order_and_reduce_the_loss(tmp_path: Path) -> None:
    alone = report(tmp_path, "firefighting")
    priority = report(tmp_path, "firefighting", "--script", str(SCRIPTS / "priority.yaml"))
    hidden = report(tmp_path, "firefighting", "--script", str(SCRIPTS / "hidden-fire.yaml"))
    assert [run["extinguished"] for run in (alone, priority, hidden)] == [
        [1, 2, 3, 4, 5],
        [1, 3, 2, 4, 5],
        [1, 2, 3, 4, 5],
    ]
    assert max(priority["loss_area_total_m2"], hidden["loss_area_total_m2"]) < alone["loss_area_total_m2"]
    assert alone["loss_area_m2"][:4] == hidden["loss_area_m2"][:4]
    assert min(run["min_clearance_margin_m"] for run in (alone, priority, hidden)) >= 0.0
    assert report(tmp_path, "firefighting")["digest"] == alone["digest"]


def test_a_headless_run_reports_a_refused_scripted_stroke(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script = tmp_path / "point.yaml"
    script.write_text("- {at_s: 1, do: stroke, points_m: [[5, 5]]}\n")
    report(tmp_path, "empty", "--duration", "2", "--script", str(script))
    assert "1.00 s: No path: a stroke needs at least 3 distinct points; this one has 1." in capsys.readouterr().err


def test_the_recorded_inputs_guide_the_team_without_a_mouse(tmp_path: Path) -> None:
    alone = report(tmp_path, "barrier-gaze")
    guided = report(tmp_path, "barrier-gaze", "--demo")
    assert alone["extinguished"] == [2, 1, 3]
    assert guided["extinguished"] == [2, 3, 1]
    assert guided["loss_area_total_m2"] < alone["loss_area_total_m2"]
    assert [(c["source"], c["kind"]) for c in guided["commands"]] == [
        ("emg", "Pause"),
        ("emg", "Clutch"),
        ("gaze", "StrokeBegin"),
        ("emg", "Clutch"),
        ("gaze", "StrokeEnd"),
        ("bci", "Pick"),
        ("emg", "Resume"),
    ]


def test_strokes_lead_the_team_to_fires_behind_the_walls_of_a_floor_plan(tmp_path: Path) -> None:
    guided = report(tmp_path, "building", "--script", str(SCRIPTS / "building.yaml"))
    assert sorted(guided["extinguished"]) == [1, 2, 3]
    assert guided["min_clearance_margin_m"] >= 0.0


def test_a_real_eye_tracker_recording_steers_a_run(sample: Callable[[str], Path], tmp_path: Path) -> None:
    file = sample("tobii_prolab_de_excerpt/prolab_de_first600rows.tsv")
    alone = report(tmp_path, "empty", "--duration", "20")
    gazed = report(tmp_path, "empty", "--duration", "20", "--input", f"gaze={file}:clutch=always")
    assert [c["kind"] for c in gazed["commands"]] == ["StrokeBegin", "StrokeEnd"]
    assert gazed["digest"] != alone["digest"]
    assert gazed["min_clearance_margin_m"] is None or gazed["min_clearance_margin_m"] >= 0.0


@pytest.mark.parametrize("name", ["circle-obstacles", "circle-irregular", "building", "swarm"])
def test_the_other_scenarios_run_without_a_violation(name: str, tmp_path: Path) -> None:
    run = report(tmp_path, name, "--duration", "12")
    assert run["infeasible_ticks"] == 0
    assert run["min_clearance_margin_m"] is None or run["min_clearance_margin_m"] >= 0.0
