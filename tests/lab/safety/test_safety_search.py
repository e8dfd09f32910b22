"""The search for broken guarantees: it finds what is broken on purpose, makes it small, and finds nothing else."""

import json
from pathlib import Path

import numpy as np
import pytest

from higvf_console.cli.main import main
from higvf_console.core.arrays import floats
from higvf_console.core.commands import EmergencyStop, OperatorCommand, Pause, Pick, Resume
from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import SimState, Trace
from higvf_console.lab.safety.play import Case, play
from higvf_console.lab.safety.search import Job, check, run_job, search
from higvf_console.lab.safety.shrink import shrunk
from higvf_console.lab.safety.watch import Broken
from higvf_console.lab.safety.worlds import random_world
from higvf_console.runtime import dispatch as dispatching
from higvf_console.runtime import run as running
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.sim import simulation

TICKS = 2500  # of the test; continuous integration searches besides, see `.ci/run`
BETWEEN = """
version: 1
name: between
arena: {size_m: [400, 300]}
robots: {start_m: [[100, 150], [60, 150]]}
fires: [{at_m: [300, 150], radius_m: 20, robots_needed: 2}]
obstacles: {circles: [{at_m: [200, 150], radius_m: 20}]}
"""


@pytest.fixture
def scenario() -> Scenario:
    return parse_scenario(BETWEEN, "between")


def test_nothing_is_broken_in_random_runs(tmp_path: Path) -> None:
    found = search(TICKS, seed=0, folder=tmp_path / "found", processes=1)
    assert found.found == ()
    assert found.ticks == TICKS
    assert found.replays > 3
    assert found.commands > 100
    assert not (tmp_path / "found").exists()


def test_the_same_seed_gives_the_same_runs(tmp_path: Path) -> None:
    texts = {random_world(np.random.default_rng([3, 1]), "w").text for _ in range(2)}
    first, again = (run_job(Job(3, 1, 150), tmp_path) for _ in range(2))
    assert len(texts) == 1
    assert first == again


def unfiltered(state: SimState, *rest: object) -> tuple[SimState, Trace]:
    """The control period without a safety filter that reports anything: the team goes straight through obstacles."""
    after, trace = ADVANCE(state, *rest)  # pyright: ignore[reportArgumentType]
    dt = 0.02
    speed = 0.0 if state.intent.paused else 60.0
    position = state.motion.position + floats([speed * dt, 0.0])
    motion = after.motion._replace(position=position)
    return after._replace(motion=motion), trace._replace(infeasible=np.zeros_like(trace.infeasible))


ADVANCE = simulation.advance


def test_a_violation_without_a_flag_is_found(
    scenario: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(simulation, "advance", unfiltered)
    played = play(Case(scenario, 0, (), 400), tmp_path / "run.jsonl")
    assert played.failure is not None
    assert played.failure.broken is Broken.UNFLAGGED
    assert played.failure.text.startswith("robot 1 and circle 1: margin -")
    assert 50 < played.case.ticks < 70


def test_motion_under_a_stop_is_found(scenario: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulation, "advance", unfiltered)
    stop: tuple[tuple[int, OperatorCommand], ...] = ((0, Pause()), (5, EmergencyStop()), (9, Pick(1)))
    moving = Case(scenario, 0, stop, 20)
    assert play(moving, tmp_path / "run.jsonl").failure is None  # paused robots stand even so

    def resumed(state: SimState, *rest: object) -> tuple[SimState, Trace]:
        return unfiltered(state._replace(intent=state.intent._replace(paused=False)), *rest)

    monkeypatch.setattr(simulation, "advance", resumed)
    failure = play(moving, tmp_path / "run.jsonl").failure
    assert failure is not None
    assert failure.broken is Broken.MOVED


def test_an_error_of_a_command_is_found_and_made_small(
    scenario: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(state: SimState, command: OperatorCommand, setup: object) -> object:
        if isinstance(command, Pick) and state.intent.paused:
            raise KeyError("no such robot")
        return APPLY(state, command, setup)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(dispatching, "apply_command", broken)
    given: list[tuple[int, OperatorCommand]] = [(tick, Pick(tick % 2)) for tick in range(0, 80, 4)]
    given += [(81, Pause()), (90, Resume()), (100, Pause()), (160, Pick(1))]
    found = play(Case(scenario, 0, tuple(given), 300), tmp_path / "run.jsonl")
    assert found.failure is not None
    assert found.failure.text.startswith("Pick raises KeyError: 'no such robot'")
    small = shrunk(found, tmp_path / "run.jsonl")
    assert [type(command) for _, command in small.case.commands] == [Pause, Pick]
    assert small.case.ticks < 5


APPLY = dispatching.apply_command


def test_what_is_found_is_written_down_and_can_be_repeated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(run: running.Run) -> tuple[object, ...]:
        if run.state.intent.paused:
            raise ZeroDivisionError
        return STEP(run)

    monkeypatch.setattr(running.Run, "step", broken)
    found = search(1500, seed=1, folder=tmp_path, processes=1)
    (one, *_) = found.found
    assert one.failure.broken is Broken.EXCEPTION
    assert one.file.parent == tmp_path
    case, failure = check(one.file)
    assert failure is not None
    assert failure.text.startswith("a control period raises ZeroDivisionError")
    assert any(isinstance(command, Pause | EmergencyStop) for _, command in case.commands)
    assert len(case.commands) == 1
    assert main(["bench", "--suite", "safety", "--recording", str(one.file)]) == 1
    assert "An error: a control period raises ZeroDivisionError" in capsys.readouterr().out
    monkeypatch.undo()
    assert main(["bench", "--suite", "safety", "--recording", str(one.file)]) == 0
    assert "every guarantee held" in capsys.readouterr().out


STEP = running.Run.step


def test_the_json_has_the_counts_and_a_list_for_each_kind_of_failure(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--suite", "safety", "--ticks", "200", "--seed", "4", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert list(report) == [
        "ticks", "commands", "replays", "unflagged", "mismatches", "exceptions", "moved_under_stop", "seed",
    ]  # fmt: skip
    assert (report["ticks"], report["seed"], report["unflagged"]) == (200, 4, [])


def test_options_of_the_search_are_refused_elsewhere(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--suite", "tick", "--ticks", "3"]) == 2
    assert "--ticks is an option of --suite safety, not of --suite tick" in capsys.readouterr().err
    assert main(["bench", "--suite", "safety", "--recording", "x.jsonl", "--ticks", "3"]) == 2
    assert "give it alone" in capsys.readouterr().err


def test_a_start_is_drawn_again_until_the_console_accepts_it() -> None:
    for number in range(5):
        scenario = random_world(np.random.default_rng([9, number]), "w")
        try:
            scenario.setup(0)
        except ScenarioError as error:
            pytest.fail(str(error))
