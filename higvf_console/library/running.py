"""Whole runs without a screen: a scenario or a setup in, one report out, and every control period on the way."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from higvf_console.core.arguments import instance, whole
from higvf_console.core.errors import ArgumentTypeError
from higvf_console.core.interface import Interface
from higvf_console.library import engine
from higvf_console.library.filtering import filter_velocities
from higvf_console.library.hazards import Hazards
from higvf_console.library.paths import circle_path, guiding_vectors, path_points
from higvf_console.library.scenarios import make_scenario
from higvf_console.library.setups import make_setup
from higvf_console.library.stepping import given_setup
from higvf_console.runtime.compiling import announce
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.recording import Recorder
from higvf_console.runtime.run import Tick
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, load_scenario
from higvf_console.world.setup import Setup


def run(
    scenario: Scenario | Setup | str | Path,
    duration: float | None = None,
    *,
    seed: int = 0,
    interfaces: Iterable[Interface] = (),
    record: str | Path | None = None,
    each: Callable[[Tick], object] | None = None,
) -> dict[str, Any]:
    """Runs as fast as the machine can until all fires are out or `duration` ends, and reports.

    The same scenario, seed and inputs give the same report, its `digest` included, as `higvf run --headless`.

    Args:
        scenario: from `load_scenario` or `make_scenario`, its name or file, or a setup.
        duration: how long at most [s]; None = the scenario's.
        seed: of jitter, measurement errors and lost packets; from 0.
        interfaces: the operator's devices, polled each control period in this order, and closed at the end.
        record: file to write the run down in, for `replay`.
        each: called after every control period with a `Tick`; keep what you want of it, its arrays do not change.

    Returns:
        The report of `run_headless`, ready for JSON.

    Raises:
        ArgumentError: an argument is of another type or out of range.
        ScenarioError: there is no such scenario, or its start is not safe with this seed.
        InputError: two interfaces have the same name, or the recording cannot be written.
    """
    what = given_scenario(scenario)
    number = whole("seed", seed, 0)
    announce()
    recorder = None if record is None else Recorder(Path(instance("record", record, str, Path)), what, number)
    session = Session(what, interfaces, number, recorder)
    try:
        return run_headless(session, duration, each)
    finally:
        session.close()


def given_scenario(scenario: object) -> Scenario:
    """The scenario that is named, given, or made of a setup.

    Raises:
        ArgumentTypeError: none of these.
    """
    match scenario:
        case Scenario():
            return scenario
        case Setup():
            return make_scenario(scenario, "setup")
        case str() | Path():
            return load_scenario(scenario)
        case _:
            instance("scenario", scenario, Scenario, Setup, str, Path)
            raise ArgumentTypeError  # unreachable: `instance` raises


def warm_up(setup: Setup | None = None) -> float:
    """Compiles all of the engine, or loads it from the cache; without it, each part is compiled on first use.

    Args:
        setup: anything from `make_setup`; which one makes no difference to what is compiled.

    Returns:
        How long it took [s].

    Raises:
        ArgumentError: no setup.
    """
    given = make_setup([[0.0, 0.0]], Hazards().circle((100.0, 0.0), 10.0)) if setup is None else given_setup(setup)
    took = engine.compiled(given)
    path = circle_path((0.0, 0.0), 50.0)
    path_points(path)
    guiding_vectors(path, [[0.0, 0.0]])
    filter_velocities([[0.0, 0.0]], [[1.0, 0.0]])
    return took
