"""The report of `higvf reproduce`: a self-contained page, Markdown with figures, JSON, errors."""

import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest

from higvf_console.cli.main import main
from higvf_console.core.errors import HigvfError
from higvf_console.lab.reproduce import command
from higvf_console.lab.reproduce.case import Case, Findings, Measurement
from higvf_console.lab.reproduce.registry import CASES, choose
from higvf_console.lab.reproduce.report.markdown import markdown_report
from higvf_console.lab.reproduce.report.page import html_report
from higvf_console.lab.reproduce.results import Result, Results

FEW = ["gvf", "bumps", "fire-priority"]


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a report of a few cases."""
    folder = tmp_path_factory.mktemp("report")
    assert main(["reproduce", *FEW, "--out", str(folder)]) == 0
    return folder


def test_the_page_is_self_contained(report: Path) -> None:
    page = (report / "report.html").read_text(encoding="utf-8")
    assert "://" not in page
    sources = re.findall(r'(?:src|href)="(.{20})', page)
    assert all(source.startswith(("data:image/svg+xml;", "#")) for source in sources)
    assert "<script" not in page
    assert page.count("<img ") == sum(len(c["pictures"]) for c in load(report)["cases"]) > 0


def test_every_entry_of_the_contents_leads_somewhere(report: Path) -> None:
    page = (report / "report.html").read_text(encoding="utf-8")
    assert set(re.findall(r'href="#([^"]+)"', page)) <= set(re.findall(r'id="([^"]+)"', page))


def test_the_pictures_of_the_markdown_lie_beside_it(report: Path) -> None:
    names = re.findall(r"!\[[^]]*\]\((figures/[^)]+)\)", (report / "report.md").read_text(encoding="utf-8"))
    assert len(names) > 3
    for name in names:
        assert (report / name).read_bytes().startswith(b"\x89PNG")


def load(folder: Path) -> Any:
    return json.loads((folder / "report.json").read_text(encoding="utf-8"))


def test_the_json_holds_the_runs_and_the_findings(report: Path) -> None:
    whole = load(report)
    assert set(whole) == {"version", "made", "versions", "cases", "runs", "differences"}
    assert [case["name"] for case in whole["cases"]] == FEW
    for case in whole["cases"]:
        assert set(case) == {
            "name", "title", "paper", "how", "holds", "measurements", "pictures", "runs", "notes",
        }  # fmt: skip
        assert case["holds"] is True
        for measurement in case["measurements"]:
            assert set(measurement) == {"what", "value", "unit", "expected", "holds"}
    (run,) = whole["runs"]
    assert run["command"] == "higvf run table2 --headless --script scenarios/scripts/table2-priority.yaml"
    assert run["forms"] == "corrected"
    assert re.fullmatch("[0-9a-f]{64}", run["digest"])


def test_the_digest_is_that_of_a_headless_run(report: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script = Path(__file__).parents[3] / "scenarios" / "scripts" / "table2-priority.yaml"
    assert main(["run", "table2", "--headless", "--script", str(script)]) == 0
    assert json.loads(capsys.readouterr().out)["digest"] == load(report)["runs"][0]["digest"]


def test_two_reproductions_differ_in_their_time_stamp_alone(report: Path, tmp_path: Path) -> None:
    assert main(["reproduce", *FEW, "--out", str(tmp_path)]) == 0
    for name in ("report.html", "report.md", "report.json"):
        first, second = ((folder / name).read_text(encoding="utf-8") for folder in (report, tmp_path))
        made = load(report)["made"], load(tmp_path)["made"]
        assert first.replace(made[0], "") == second.replace(made[1], "")
    for picture in (report / "figures").iterdir():
        assert picture.read_bytes() == (tmp_path / "figures" / picture.name).read_bytes()


def test_json_on_standard_output_comes_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["reproduce", "bumps", "--json", "-"]) == 0
    assert [case["name"] for case in json.loads(capsys.readouterr().out)["cases"]] == ["bumps"]
    assert list(tmp_path.iterdir()) == []


def test_the_report_goes_to_reproduction_and_the_json_also_elsewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["reproduce", "bumps", "--json", "numbers.json"]) == 0
    out, err = capsys.readouterr()
    assert out == ""
    assert "Report: reproduction/report.html" in err
    assert json.loads(Path("numbers.json").read_text()) == load(Path("reproduction"))


def test_an_unknown_case_is_refused_with_the_closest_and_all_of_them(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "gvf", "fire-prority"]) == 2
    line = capsys.readouterr().err
    assert "no case 'fire-prority' (did you mean 'fire-priority'?)" in line
    assert all(name in line for name in CASES)


def test_cases_run_in_the_papers_order_whatever_the_order_of_their_names() -> None:
    assert [case.name for case in choose(["bumps", "gvf"])] == ["gvf", "bumps"]
    assert [case.name for case in choose([])] == list(CASES)


def test_the_prediction_of_table_2_comes_with_the_joint_fit_beside_it() -> None:
    assert [case.name for case in choose(["table2"])] == ["table2", "table2-joint"]
    assert [case.name for case in choose(["table2-joint"])] == ["table2-joint"]


def test_a_report_that_cannot_be_written_is_one_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "taken").write_text("")
    assert main(["reproduce", "bumps", "--out", str(tmp_path / "taken")]) == 2
    assert f"--out {tmp_path / 'taken'}" in capsys.readouterr().err.splitlines()[-1]


def test_a_missing_matplotlib_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(HigvfError, match=r"higvf-console\[report\]"):
        command.reproduce(["gvf"], None, None)


def test_a_missed_expectation_is_listed_in_the_summary() -> None:
    missed = Measurement("Height of <the> | moon", 3.0, "m", "none", False)
    case = Case("moon", "The moon", "Fig. 0", "by eye", choose(["gvf"])[0].run)
    results = Results("now", {}, (Result(case, Findings((missed,))),))
    assert "Height of &lt;the&gt; | moon: <b>3 m</b>" in html_report(results, {})
    assert "- moon: Height of <the> | moon: 3 m; expected none" in markdown_report(results)
    assert results.plain()["cases"][0]["holds"] is False
