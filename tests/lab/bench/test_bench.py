"""The benchmarks: their tables, their JSON, and the error that they report."""

import json
from collections.abc import Callable

import pytest

from higvf_console.core.errors import HigvfError
from higvf_console.lab.bench import bench, timing
from higvf_console.lab.bench import filter as bench_filter
from higvf_console.lab.bench import preview as bench_preview
from higvf_console.lab.bench import tick as bench_tick


def quick(contenders: dict[str, Callable[[int], object]], _: object = None) -> dict[str, float]:
    for call in contenders.values():
        call(0)
    return dict.fromkeys(contenders, 2.0)


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Suites of small teams whose contenders are called once, and take 2 ms each."""
    for suite in (bench_filter, bench_tick):
        monkeypatch.setattr(suite, "TEAMS", (3, 30))
        monkeypatch.setattr(suite, "take_turns", quick)


@pytest.mark.usefixtures("small")
def test_the_filter_suite_compares_all_contenders_and_agrees_with_brute_force() -> None:
    report = json.loads(bench.run_suite("filter", as_json=True))
    assert report["suite"] == "filter"
    assert [(case["scene"], case["robots"]) for case in report["cases"]] == [
        ("medium", 3), ("medium", 30), ("dense", 3), ("dense", 30),
    ]  # fmt: skip
    for case in report["cases"]:
        assert list(case["median_ms"]) == ["distributed", "coupled", "daqp", "orca"]
        assert case["ratio_to_distributed"]["coupled"] == 1.0
        assert case["error_against_brute_force"] < 1e-12
    assert report["cases"][-1]["active_constraints_a_robot"] > 1.0


@pytest.mark.usefixtures("small")
def test_contenders_that_are_not_installed_are_reported_and_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_filter, "daqp", None)
    monkeypatch.setattr(bench_filter, "RVOSimulator", None)
    assert json.loads(bench.run_suite("filter", as_json=True))["cases"][0]["median_ms"]["orca"] is None
    assert bench.run_suite("filter", as_json=False).count("not installed") == 8


@pytest.mark.usefixtures("small")
def test_the_tick_suite_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    bench.main("tick", as_json=False)
    title, head, *lines = capsys.readouterr().out.splitlines()
    assert "median in ms" in title
    assert head.split() == ["scene", "robots", "advance", "roll", "session"]
    assert [line.split()[1] for line in lines] == ["3", "30"]
    assert lines[0].split()[2:] == ["2.000", "0.100", "(0.1x)", "2.000", "(1.0x)"]


def test_contenders_take_turns_and_are_warmed_up_first() -> None:
    called: list[str] = []
    contenders: dict[str, Callable[[int], object]] = {name: lambda _, name=name: called.append(name) for name in "ab"}
    medians = timing.take_turns(contenders, {"b": lambda _: called.append("before b")}, seconds=0.0)
    assert called[:5] == ["a", "b", "a", "before b", "b"]
    assert called.count("a") == 16
    assert set(medians) == {"a", "b"}


def test_an_unknown_suite_is_refused_with_the_choices() -> None:
    with pytest.raises(HigvfError, match="benchmark suite: 'speed' is not one of filter, tick, deadlock"):
        bench.run_suite("speed", as_json=False)


def test_the_preview_suite_measures_previews_and_the_lateness_of_both_loops(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_preview, "take_turns", quick)
    measured = bench_preview.run(1.3)
    monkeypatch.setattr(bench_preview, "run", lambda: measured)
    report = json.loads(bench.run_suite("preview", as_json=True))
    assert report["realtime_factor"] == pytest.approx(60.0 / 0.002)
    assert report["previews_per_s"] == pytest.approx(500.0)
    without, ahead = (report["lateness_ms"][name] for name in ("without_preview", "with_preview"))
    for late in (without, ahead):
        assert sum(count for _, count in late["histogram"]) == late["periods"]
        assert 0.0 <= late["p50"] <= late["p99"] <= late["p999"] <= late["worst"]
    assert without["previews_per_s"] == 0.0 < ahead["previews_per_s"]
    assert "30\u202f000 times real time" in bench.run_suite("preview", as_json=False)
