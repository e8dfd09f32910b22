"""The study of deadlocks: its figures, JSON and table, and the report and file of a single scene."""

import io
import json
from pathlib import Path

import pytest

from higvf_console.cli.main import main
from higvf_console.core.errors import HigvfError
from higvf_console.core.state import PathStatus
from higvf_console.lab.bench import bench, deadlock_report
from higvf_console.lab.bench import deadlock as bench_deadlock
from higvf_console.lab.bench.deadlock import FORMS, Outcome, make_scene, run_scene, scene_named
from higvf_console.lab.bench.scenes import Kind
from higvf_console.lab.progress import ProgressBar


def outcome(form: str, kind: Kind, seed: int, status: PathStatus, seconds: float, clearance: float = 1.0) -> Outcome:
    return Outcome(kind, seed, form, status, seconds, deadlock=seconds / 10.0, clearance=clearance)


def everywhere(status: PathStatus = PathStatus.FINISHED) -> list[Outcome]:
    return [outcome(form, kind, seed, status, 20.0) for form in FORMS for kind in Kind for seed in range(2)]


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """A suite that runs nothing."""

    def run_all(_: int | None, *, factor: float) -> list[Outcome]:
        assert factor == 1.0
        return everywhere()

    monkeypatch.setattr(bench_deadlock, "run_all", run_all)


def test_figures_count_arrivals_violations_and_times() -> None:
    found = deadlock_report.figures(
        [
            outcome("corrected", Kind.SPACED, 0, PathStatus.FINISHED, 20.0),
            outcome("corrected", Kind.SPACED, 1, PathStatus.FINISHED, 40.0, clearance=-0.5),
            outcome("corrected", Kind.SPACED, 2, PathStatus.BLOCKED, 60.0),
            outcome("corrected", Kind.SPACED, 3, PathStatus.FOLLOWING, 180.0, clearance=-1e-9),
        ]
    )
    assert found == {
        "scenes": 4, "arrival_share": 0.5, "violations": 1, "deadlock_s_mean": 7.5, "median_s": 30.0, "failed": [2, 3],
    }  # fmt: skip


@pytest.mark.usefixtures("made_up")
def test_the_json_is_grouped_by_form_and_kind() -> None:
    report = json.loads(bench.run_suite("deadlock", as_json=True))
    assert list(report) == ["printed", "zero_in", "corrected"]
    own = {"scenes", "arrival_share", "violations", "deadlock_s_mean", "median_s", "failed"}
    for form in report.values():
        assert set(form) == own | {"crowded", "pockets"}
        assert set(form["crowded"]) == set(form["pockets"]) == own


def test_a_form_in_which_nobody_arrives_has_no_median() -> None:
    outcomes = everywhere(PathStatus.BLOCKED)
    assert deadlock_report.plain(outcomes)["printed"]["median_s"] is None
    assert "spaced seeds that did not arrive: 0, 1" in deadlock_report.table(outcomes)


@pytest.mark.usefixtures("made_up")
def test_the_table_has_a_line_for_each_kind_and_form() -> None:
    _, head, *lines = bench.run_suite("deadlock", as_json=False).splitlines()
    assert head.split()[:4] == ["form", "kind", "scenes", "arrived"]
    assert [line.split()[:4] for line in lines[:3]] == [[form, "spaced", "2", "100.0%"] for form in FORMS]
    assert len(lines) == 9


def test_a_spaced_scene_arrives_safely_in_the_corrected_form() -> None:
    end = run_scene(make_scene(Kind.SPACED, 1), "corrected")
    assert end.arrived
    assert not end.violated
    assert end.seconds < 180.0


def test_the_report_of_a_scene_covers_every_form(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--suite", "deadlock", "--scene", "spaced:1"]) == 0
    output = capsys.readouterr().out
    assert "follows the path" in output
    assert all(f"\n{form}" in output for form in FORMS)
    assert "has finished its path" in output


def test_a_scene_is_saved_as_a_scenario(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    assert main(["bench", "--suite", "deadlock", "--scene", "pockets:3", "--save", str(file)]) == 0
    assert main(["run", str(file), "--headless", "--duration", "0.1", "--report", str(tmp_path / "r.json")]) == 0
    assert json.loads((tmp_path / "r.json").read_text())["scenario"] == "pockets-3"


@pytest.mark.parametrize("name", ["crowded", "crowded:", "crowded:-1", "full:3", "3"])
def test_a_scene_that_does_not_exist_is_refused_with_the_choices(name: str) -> None:
    with pytest.raises(HigvfError, match="with a kind of spaced, crowded, pockets, such as crowded:17"):
        scene_named(name)


def test_options_of_another_suite_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--suite", "tick", "--scenes", "3"]) == 2
    assert "--scenes is an option of --suite deadlock, not of --suite tick" in capsys.readouterr().err
    assert main(["bench", "--suite", "deadlock", "--save", "x.yaml"]) == 2
    assert "add --scene KIND:SEED" in capsys.readouterr().err


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_progress_bar_draws_only_on_a_terminal() -> None:
    terminal, file = Terminal(), io.StringIO()
    for stream in (terminal, file):
        bar = ProgressBar("scenes", 4, stream)
        bar.advance(1)
        bar.advance(3)
    assert "] 1/4" in terminal.getvalue()
    assert terminal.getvalue().endswith("] 4/4\x1b[K\n")
    assert file.getvalue() == ""


def test_a_progress_bar_shows_a_note_and_ends_its_line_before_the_last_step() -> None:
    terminal = Terminal()
    bar = ProgressBar("fit", 4, terminal)
    bar.advance(2, "smallest objective 0.50")
    bar.end()
    assert "] 2/4 smallest objective 0.50" in terminal.getvalue()
    assert terminal.getvalue().endswith("] 2/4\x1b[K\n")


def test_a_scene_at_the_scale_of_a_table_ends_alike() -> None:
    for seed in range(2):
        usual, small = (run_scene(make_scene(Kind.SPACED, seed, factor), "corrected") for factor in (1.0, 1 / 300))
        assert small.status == usual.status
        assert small.seconds == pytest.approx(usual.seconds, rel=0.02)
        assert small.clearance == pytest.approx(usual.clearance / 300, rel=0.1)
