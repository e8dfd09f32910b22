"""One run under watch: its commands are applied, each period is judged, and at the end its recording is replayed."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np

from higvf_console.core.commands import LoadScenario, OperatorCommand
from higvf_console.lab.safety.commands import random_commands
from higvf_console.lab.safety.watch import Broken, Failure, Watch, goal_of
from higvf_console.runtime.recording import Recorder, read_recording, replay
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import Scenario

Given: TypeAlias = tuple[tuple[int, OperatorCommand], ...]  # commands, each with the ticks done before it


class Case(NamedTuple):
    """A run that can be repeated.

    Attributes:
        scenario: what is run.
        seed: of its start positions, noise and losses.
        commands: by the ticks done before each.
        ticks: control periods.
    """

    scenario: Scenario
    seed: int
    commands: Given
    ticks: int


class Played(NamedTuple):
    """What a run came to.

    Attributes:
        case: what was run, up to the failure if there was one.
        failure: the first; None = all held.
        replays: recordings that were replayed.
    """

    case: Case
    failure: Failure | None
    replays: int


def play(case: Case, file: Path) -> Played:
    """Runs a case under watch.

    Args:
        case: what to run.
        file: where to write its recording, which is then replayed.
    """
    by_tick: dict[int, list[OperatorCommand]] = {}
    for tick, command in case.commands:
        by_tick.setdefault(tick, []).append(command)
    return _play(case, file, lambda run: by_tick.get(run.ticks, ()))


def explore(scenario: Scenario, seed: int, ticks: int, rng: np.random.Generator, file: Path) -> Played:
    """Runs a scenario under watch with random commands.

    Args:
        scenario: what to run.
        seed: of the run.
        ticks: how long.
        rng: source of the random numbers.
        file: as in `play`.
    """
    rate = 10.0 ** rng.uniform(-2.5, -0.8)  # wishes in a control period

    def give(run: Run) -> Iterable[OperatorCommand]:
        return random_commands(rng, run) if rng.random() < rate else ()

    return _play(Case(scenario, seed, (), ticks), file, give)


def _play(case: Case, file: Path, give: Callable[[Run], Iterable[OperatorCommand]]) -> Played:
    run = Run(case.scenario.setup(case.seed), case.scenario.filter, case.scenario)
    file.unlink(missing_ok=True)
    watch, recorder = Watch(run), Recorder(file, case.scenario, case.seed)
    given: list[tuple[int, OperatorCommand]] = []
    failure: Failure | None = None
    ticks = 0
    while ticks < case.ticks and failure is None:
        ticks += 1  # with the one that fails
        for command in give(run):
            given.append((run.ticks, command))
            failure = _applied(run, watch, recorder, command)
            if failure is not None:
                break
        else:
            failure = _stepped(run, watch)
            if failure is None or failure.broken is not Broken.EXCEPTION:
                recorder.step(run.state.motion)
    recorder.close()
    done = case._replace(commands=tuple(given), ticks=ticks)
    if failure is not None:
        return Played(done, failure, 0)
    return Played(done, _replayed(file), 1)


def _applied(run: Run, watch: Watch, recorder: Recorder, command: OperatorCommand) -> Failure | None:
    """Applies and records a command as a session does."""
    before, goal, former = run.run_state, goal_of(command, run), run.scenario
    try:
        run.apply(command)
    except Exception as error:  # any is a finding
        recorder.command(command, run.scenario)
        return _raised(type(command).__name__, error)
    if not (isinstance(command, LoadScenario) and run.scenario is former):
        recorder.command(command, run.scenario)
    return watch.commanded(before, goal, command)


def _stepped(run: Run, watch: Watch) -> Failure | None:
    before = run.state.motion
    try:
        run.step()
    except Exception as error:  # any is a finding
        return _raised("a control period", error)
    return watch.stepped(before)


def _raised(what: str, error: Exception) -> Failure:
    trace, place = error.__traceback__, ""
    while trace is not None:
        code = trace.tb_frame.f_code
        place = f"{Path(code.co_filename).name}, {code.co_name}"
        trace = trace.tb_next
    return Failure(Broken.EXCEPTION, f"{what} raises {type(error).__name__}: {error} ({place})")


def _replayed(file: Path) -> Failure | None:
    """Whether a recording can be read, and repeats its run."""
    try:
        result = replay(read_recording(file))
    except Exception as error:  # any is a finding
        return _raised("the replay", error)
    if result.agrees:
        return None
    return Failure(Broken.MISMATCH, f"the replay differs after tick {result.differs_after}")
