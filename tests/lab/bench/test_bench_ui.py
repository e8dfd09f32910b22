"""The benchmark of the console without a browser: decoded messages, figures, table, errors."""

import json
import shutil
from importlib import import_module
from types import ModuleType

import msgspec.msgpack
import numpy as np
import pytest
import zstandard

from higvf_console.cli.arguments import parser
from higvf_console.core.errors import HigvfError
from higvf_console.lab.bench import bench, chromium, console_page
from higvf_console.lab.bench import ui as bench_ui
from higvf_console.lab.bench.viser_client import ROBOTS_NODE, Frame, Positions, first_motion, robots_in
from higvf_console.scenario.scenario import parse_scenario


def frame(at: float, *x: float) -> Frame:
    positions = np.zeros((len(x), 3), np.float32)
    positions[:, 0] = x
    return Frame(at, positions)


def wire_message(*arrays: tuple[str, Positions]) -> bytes:
    """A message as viser sends it that gives nodes new positions."""
    messages = [
        {"type": "SceneNodeUpdateMessage", "name": name,
         "updates": {"batched_positions": {"__binary_index": row, "dtype": "<f4"}}}
        for row, (name, _) in enumerate(arrays)
    ]  # fmt: skip
    inner = msgspec.msgpack.encode(
        {"messages": messages, "timestampSec": 0.0, "binaryBufferLengths": [array.nbytes for _, array in arrays]}
    )
    packed = zstandard.ZstdCompressor(level=1).compress(inner)
    message = len(inner).to_bytes(8, "little") + len(packed).to_bytes(8, "little") + packed
    for _, array in arrays:
        message += b"\0" * (-len(message) % 8) + array.tobytes()
    return message


def test_the_robot_positions_are_found_among_other_nodes_in_a_message() -> None:
    others, robots = np.ones((3, 3), np.float32), np.arange(15, dtype=np.float32).reshape(5, 3)
    found = robots_in(wire_message(("/fires", others), (ROBOTS_NODE, robots), ("/team/digit_1", others)))
    assert found is not None
    assert np.array_equal(found, robots)
    assert robots_in(wire_message(("/fires", others))) is None
    assert robots_in(wire_message()) is None


def test_motion_begins_with_the_first_position_that_differs_from_rest() -> None:
    still = (frame(1.0, 5.0), frame(2.0, 5.0))
    assert first_motion((), 1.5) is None
    assert first_motion(still, 1.5) is None
    assert first_motion((*still, frame(3.0, 5.5), frame(4.0, 6.0)), 1.5) == 3.0
    assert first_motion((frame(1.0, 4.0), frame(1.2, 5.0), frame(2.0, 5.0)), 1.5) is None, "it moved before"


def test_the_percentiles_are_those_of_the_strokes() -> None:
    latency = bench_ui.summary([float(taken) for taken in range(101)])
    assert latency == bench_ui.Latency(50.0, 99.0, 100.0, 101)


@pytest.mark.parametrize("robots", bench_ui.TEAMS)
def test_every_team_of_the_benchmark_has_a_safe_start_with_and_without_fires(robots: int) -> None:
    for fires in (False, True):
        setup = parse_scenario(bench_ui.scenario_of(robots, fires=fires), "the benchmark's scenario").setup()
        assert len(setup.start.motion.position) == robots
        assert len(setup.start.motion.fire_radius) == 2 * fires


def test_the_suite_reports_a_table_and_json(monkeypatch: pytest.MonkeyPatch) -> None:
    assert parser().parse_args(["bench", "--suite", "ui", "--json"]).suite in bench.SUITES
    traffic = bench_ui.Traffic("firefighting", 51_200.0, 30.5, 0.25, 58.7)
    case = {
        "robots": 3, "traffic": traffic._asdict(), "latency_ms": bench_ui.summary([30.0, 40.0])._asdict(),
    }  # fmt: skip
    figures = {
        "suite": "ui", "load_before": 0.5, "cores": 2, "p99_target_ms": bench_ui.TARGET_P99_MS, "cases": [case],
    }  # fmt: skip
    monkeypatch.setattr(bench_ui, "run", lambda: figures)
    assert json.loads(bench.run_suite("ui", as_json=True)) == figures
    title, _, row = bench.run_suite("ui", as_json=False).splitlines()
    assert "p99 < 73 ms" in title
    assert row.split() == ["3", "51.2", "30.5", "25%", "58.7", "35.0", "39.9", "40.0"]


def test_a_missing_requirement_of_the_suite_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def without_playwright(name: str) -> ModuleType:
        if name.startswith("playwright"):
            raise ImportError(name)
        return import_module(name)

    monkeypatch.delenv("HIGVF_CHROMIUM", raising=False)
    monkeypatch.setattr(shutil, "which", {}.get)
    with pytest.raises(HigvfError, match="install the package 'chromium'"), console_page.open_browser():
        pass
    monkeypatch.setattr(chromium, "import_module", without_playwright)
    with pytest.raises(HigvfError, match="needs Playwright: pip install"), chromium.launched("chromium"):
        pass


def test_a_console_that_does_not_start_reports_why() -> None:
    with pytest.raises(HigvfError, match=r"does not start: .*nowhere"), console_page.console_of("nowhere.yaml"):
        pass
