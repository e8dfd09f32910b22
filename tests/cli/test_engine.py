"""The engine ahead of a run: loaded in silence, compiled with a line for each part."""

import subprocess
import sys
from collections.abc import Callable

import pytest

from higvf_console.cli import engine
from higvf_console.control.compilation import cache, progress
from higvf_console.runtime import compiling
from higvf_console.scenario.scenario import Scenario
from higvf_console.sim import warm_up
from higvf_console.sim.warm_up import Stage
from higvf_console.world.setup import Setup

Stages = Callable[[Setup, bool], tuple[Stage, ...]]


@pytest.fixture(autouse=True)
def _unannounced() -> None:
    compiling.report_once.cache_clear()


def stages_that(*steps: Callable[[], object]) -> Stages:
    return lambda _, __: tuple(Stage(f"part {k}", step) for k, step in enumerate(steps, 1))


def test_an_engine_in_the_cache_is_loaded_in_silence(
    team: Scenario, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    done: list[int] = []
    monkeypatch.setattr(engine, "_stages", stages_that(lambda: done.append(1), lambda: done.append(2)))
    assert engine.load_engine(team.setup()) >= 0.0
    assert done == [1, 2]
    assert capsys.readouterr().err == ""


def test_an_engine_that_the_cache_lacks_is_compiled_with_a_line_for_each_part(
    team: Scenario, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    done: list[str] = []

    def lower(*_: object) -> None:
        done.append("lowered")

    def compiled() -> None:
        progress.compiling("kernel")
        done.append("compiled")

    helpers: list[subprocess.Popen[bytes]] = []

    def helper() -> "subprocess.Popen[bytes]":
        helpers.append(subprocess.Popen([sys.executable, "-c", ""]))
        return helpers[-1]

    monkeypatch.setattr(engine, "_stages", stages_that(compiled, compiled))
    monkeypatch.setattr(engine, "_second_process", helper)
    monkeypatch.setattr(engine.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(warm_up, "lower_controller", lower)
    engine.load_engine(team.setup())
    assert done == ["lowered", "compiled", "compiled"]
    assert [process.returncode for process in helpers] == [0]
    assert capsys.readouterr().err.splitlines() == [
        compiling.COMPILING,
        "  the equations ...",
        "  part 1 ...",
        "  part 2 ...",
    ]


def test_one_process_compiles_where_the_cache_takes_nothing(team: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []

    def compiled() -> None:
        progress.compiling("kernel")
        done.append("compiled")

    def helper() -> None:
        raise AssertionError("a second process has nowhere to leave its work")

    monkeypatch.setattr(engine, "_stages", stages_that(compiled))
    monkeypatch.setattr(engine, "_second_process", helper)
    monkeypatch.setattr(cache.STORE, "writable", lambda: False)
    engine.load_engine(team.setup())
    assert done == ["compiled"]
