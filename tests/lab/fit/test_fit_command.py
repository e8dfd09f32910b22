"""`higvf fit`: which study it runs, and its errors in one line."""

import json
from pathlib import Path
from typing import Any

import pytest

from higvf_console.cli.main import main
from higvf_console.lab.fit import joint_study, study
from higvf_console.lab.fit.joint_study import kept_joint_fit
from higvf_console.lab.fit.study import Study
from higvf_console.lab.fit.table2 import kept_fit


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """The studies asked for; their results are the stored ones."""
    calls: list[tuple[Any, ...]] = []

    def stand_in(name: str, result: dict[str, Any]) -> Any:
        def run(runs: int, seed: int, *, keep: Path | None) -> Study:
            calls.append((name, runs, seed, keep))
            return Study(result, f"# {name}\n")

        return run

    monkeypatch.setattr(study, "study", stand_in("1", kept_fit()))
    monkeypatch.setattr(joint_study, "joint_study", stand_in("all", kept_joint_fit()))
    return calls


def test_the_fit_is_to_column_1_unless_all_are_asked_for(
    asked: list[tuple[Any, ...]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["fit"]) == 0
    assert "samples meet the targets of column 1" in capsys.readouterr().out
    keep, scenario = tmp_path / "trials", tmp_path / "world.yaml"
    given = ["--columns", "all", "--runs", "900", "--seed", "4", "--keep", str(keep), "--scenario", str(scenario)]
    assert main(["fit", *given]) == 0
    assert "This is a fit to all columns, not a prediction." in capsys.readouterr().out
    assert asked == [("1", 6000, 0, None), ("all", 900, 4, keep)]
    assert scenario.read_text() == "# all\n"


def test_both_results_have_table_2_in_the_same_form(
    asked: list[tuple[Any, ...]], capsys: pytest.CaptureFixture[str]
) -> None:
    found: list[Any] = []
    for columns in ("1", "all"):
        assert main(["fit", "--columns", columns, "--json", "-"]) == 0
        found.append(json.loads(capsys.readouterr().out))
    assert len(asked) == 2
    one, every = (whole["table2"] for whole in found)
    assert {name: list(column) for name, column in one.items()} == {
        name: list(column) for name, column in every.items()
    }
    assert found[0]["paper"] == found[1]["paper"]


def test_other_columns_are_refused_with_the_choices(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["fit", "--columns", "2"])
    assert ended.value.code == 2
    assert "argument --columns: invalid choice: '2' (choose from" in capsys.readouterr().err


@pytest.mark.parametrize(("columns", "least"), [("1", 192), ("all", 128)])
def test_too_few_runs_are_refused_with_the_least(columns: str, least: int, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fit", "--columns", columns, "--runs", "5"]) == 2
    assert f"higvf: --runs 5: give {least} or more" in capsys.readouterr().err


def test_a_file_of_the_other_fit_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keep = tmp_path / "trials"
    keep.write_text('{"higvf_fit_trials": 1, "columns": "1", "parameters": []}\n')
    assert main(["fit", "--columns", "all", "--runs", "400", "--keep", str(keep)]) == 2
    assert "give another file for --columns all" in capsys.readouterr().err
