"""The search: worlds and commands from one seed, spread over the cores; what it finds is made small and written down.

The runs depend on the seed alone, not on the number of cores.
"""

import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import NamedTuple

import numpy as np

from higvf_console.core.commands import OperatorCommand
from higvf_console.core.errors import HigvfError, InputError
from higvf_console.lab.progress import ProgressBar
from higvf_console.lab.safety.play import Case, Played, explore, play
from higvf_console.lab.safety.shrink import shrunk
from higvf_console.lab.safety.watch import Failure
from higvf_console.lab.safety.worlds import random_world
from higvf_console.runtime.recording import read_recording
from higvf_console.scenario.scenario import load_scenario
from higvf_console.scenario.sections import FilterKind
from higvf_console.sim.warm_up import stages
from higvf_console.team.state import TeamReport

TICKS = 1_000_000  # of a nightly search
SHORTEST, LONGEST = 100, 1500  # ticks of a run
_CENTRALISED = 0.08  # share of runs with the centralised filter, which takes twenty times as long: they are short
FOLDER = Path("safety-findings")


class Job(NamedTuple):
    """One run to do.

    Attributes:
        seed: of the search.
        number: of the run.
        ticks: its length.
        filter: which safety filter runs.
    """

    seed: int
    number: int
    ticks: int
    filter: FilterKind = FilterKind.DISTRIBUTED


class Found(NamedTuple):
    """A failure, and the recording that reproduces it."""

    failure: Failure
    file: Path


class Searched(NamedTuple):
    """What a search, or one of its runs, came to.

    Attributes:
        seed: of the search.
        ticks: control periods run, without those of replays and of making failures small.
        commands: given.
        replays: recordings replayed.
        found: in the order of the runs.
    """

    seed: int
    ticks: int
    commands: int
    replays: int
    found: tuple[Found, ...]


def search(ticks: int, seed: int = 0, folder: Path = FOLDER, processes: int | None = None) -> Searched:
    """Runs so many control periods in random worlds.

    Args:
        ticks: control periods.
        seed: of all random numbers.
        folder: where reproducing recordings are written; it is made when there is one.
        processes: None = as many as there are cores; 1 = this one.
    """
    jobs = list(_jobs(ticks, seed))
    bar = ProgressBar("ticks", ticks)
    done: dict[int, Searched] = {}
    _warm_up()
    if processes == 1 or len(jobs) == 1:
        for job in jobs:
            done[job.number] = run_job(job, folder)
            bar.advance(job.ticks)
    else:
        with ProcessPoolExecutor(processes) as pool:
            running = {pool.submit(run_job, job, folder): job for job in jobs}
            for future in as_completed(running):
                job = running[future]
                done[job.number] = future.result()
                bar.advance(job.ticks)
    results = [done[job.number] for job in jobs]
    return Searched(
        seed=seed,
        ticks=sum(result.ticks for result in results),
        commands=sum(result.commands for result in results),
        replays=sum(result.replays for result in results),
        found=tuple(found for result in results for found in result.found),
    )


def run_job(job: Job, folder: Path) -> Searched:
    """Explores one world, and writes down what fails there."""
    rng = np.random.default_rng([job.seed, job.number])
    scenario = random_world(rng, f"world-{job.seed}-{job.number}", job.filter)
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "run.jsonl"
        played = explore(scenario, job.number, job.ticks, rng, file)
        found = () if played.failure is None else (_written(shrunk(played, file), job, folder),)
    return Searched(job.seed, played.case.ticks, len(played.case.commands), played.replays, found)


def check(file: Path) -> tuple[Case, Failure | None]:
    """Repeats a recording under watch, such as one that a search has written.

    Args:
        file: the recording.

    Raises:
        InputError: it cannot be read, or a team drove.
    """
    recording = read_recording(file)
    commands: list[tuple[int, OperatorCommand]] = []
    for tick in sorted(recording.commands):
        for command in recording.commands[tick]:
            if isinstance(command, TeamReport):
                raise InputError(f"{file}: a team drove in this run; such a recording is repeated by `higvf replay`")
            commands.append((tick, command))
    ticks = max([0, *(mark.ticks for mark in recording.marks), *recording.commands])
    case = Case(recording.scenario, recording.seed, tuple(commands), ticks + 1)  # a period that fails leaves no mark
    _warm_up()
    with tempfile.TemporaryDirectory() as scratch:
        return case, play(case, Path(scratch) / "run.jsonl").failure


def _jobs(ticks: int, seed: int) -> Iterator[Job]:
    """Runs of random lengths, `ticks` together; a last one that would be short is added to the one before."""
    rng, number = np.random.default_rng(seed), 0
    while ticks > 0:
        kind = FilterKind.CENTRALISED if rng.random() < _CENTRALISED else FilterKind.DISTRIBUTED
        length = SHORTEST if kind is FilterKind.CENTRALISED else int(rng.integers(SHORTEST, LONGEST))
        length = ticks if ticks - length < SHORTEST else length
        yield Job(seed, number, length, kind)
        ticks, number = ticks - length, number + 1


def _warm_up() -> None:
    """Compiles once, before the processes start."""
    setup = load_scenario("firefighting").setup()
    for stage in stages(setup.start, setup.world, setup.params, coupled=True):
        stage.run()


def _written(played: Played, job: Job, folder: Path) -> Found:
    """Writes the recording of a failing run."""
    assert played.failure is not None
    file = folder / f"{played.failure.broken}-{job.seed}-{job.number}.jsonl"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise HigvfError(f"{folder}: cannot be made: {error.strerror}") from error
    play(played.case, file)
    return Found(played.failure, file)
