"""Headless runs that keep their history; each is made once, however many cases look at it."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from higvf_console.channels.channels import open_interface
from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.events import Event
from higvf_console.core.interface import InputSpec
from higvf_console.core.state import Path, PathKind
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.inputs import demo_specs
from higvf_console.runtime.session import Session
from higvf_console.runtime.snapshot import Snapshot
from higvf_console.scenario.scenario import Scenario, data_folder, load_scenario
from higvf_console.sim.certificates import connectivity
from higvf_console.world.setup import Setup


class RunSpec(NamedTuple):
    """What is run: a shipped scenario, a shipped script or the scenario's demonstration, a duration [s]."""

    scenario: str
    script: str | None = None
    demo: bool = False
    duration: float | None = None

    def __str__(self) -> str:
        """As words of the command line."""
        given = " --demo" if self.demo else f" --script scenarios/scripts/{self.script}.yaml" if self.script else ""
        lasts = f" --duration {self.duration:g}" if self.duration else ""
        return f"higvf run {self.scenario} --headless{given}{lasts}"


class GivenPath(NamedTuple):
    """A desired path and the session time from which it was in force [s]."""

    time: float
    path: Path


class Run(NamedTuple):
    """A finished run and its history: T + 1 moments, the start included; N robots, M fires.

    Attributes:
        spec: what was run.
        scenario: the file.
        setup: what it started from.
        report: of `run_headless`.
        time: (T + 1,) [s].
        position: (T + 1, N, 2) [m].
        velocity: (T + 1, N, 2) behind the safety filter [m/s].
        target: (T + 1, N) fire index or NOBODY.
        fire_radius: (T + 1, M) [m].
        burning: (T + 1, M).
        path_status: (T + 1,) a `PathStatus`.
        path_parameter: (T + 1,) w [m].
        influenced: (T + 1,) robot index.
        paused: (T + 1,).
        clearance: (T + 1,) smallest of the team [m].
        connectivity: (T + 1,) lambda_2 of the links' Laplacian.
        links: (T + 1) arrays (E, 2) of robot pairs.
        paths: the desired paths, in order.
        events: what the session said.
    """

    spec: RunSpec
    scenario: Scenario
    setup: Setup
    report: dict[str, Any]
    time: Floats
    position: Floats
    velocity: Floats
    target: Ints
    fire_radius: Floats
    burning: Bools
    path_status: Ints
    path_parameter: Floats
    influenced: Ints
    paused: Bools
    clearance: Floats
    connectivity: Floats
    links: tuple[Ints, ...]
    paths: tuple[GivenPath, ...]
    events: tuple[Event, ...]

    def moment(self, time: float) -> int:
        """The index of the moment nearest to a session time [s]."""
        return int(np.argmin(np.abs(self.time - time)))


class Runs:
    """Makes runs, and keeps them for the cases to come."""

    def __init__(self) -> None:
        """Starts with none."""
        self._made: dict[RunSpec, Run] = {}

    def get(self, spec: RunSpec) -> Run:
        """The run of that kind.

        Raises:
            HigvfError: the scenario or the script cannot be used.
        """
        if spec not in self._made:
            self._made[spec] = run_with_history(spec)
        return self._made[spec]


class _WatchedSession(Session):
    """A session that shows every moment to a watcher."""

    watch: Callable[[Snapshot], None] | None = None

    def tick(self, *, advance: bool = True) -> None:
        super().tick(advance=advance)
        if self.watch is not None:
            self.watch(self.snapshot)


class _History:
    """Collects the moments of a run."""

    def __init__(self, first: Snapshot) -> None:
        self.rows: list[tuple[Any, ...]] = []
        self.links: list[Ints] = []
        self.paths: list[GivenPath] = []
        self.add(first)

    def add(self, now: Snapshot) -> None:
        motion, intent, trace = now.state.motion, now.state.intent, now.trace
        if intent.path.kind != PathKind.NONE and (not self.paths or self.paths[-1].path is not intent.path):
            self.paths.append(GivenPath(now.time, intent.path))
        self.links.append(trace.links)
        self.rows.append((
            now.time, motion.position, motion.velocity, motion.target, motion.fire_radius, motion.fire_burning,
            int(motion.path_status), motion.path_parameter, intent.influenced, intent.paused,
            float(trace.clearance.min()), connectivity(trace.links, len(motion.position)),
        ))  # fmt: skip


def run_with_history(spec: RunSpec) -> Run:
    """Runs `spec` to its end, through the session, as `higvf run --headless` does.

    Raises:
        HigvfError: the scenario or the script cannot be used.
    """
    scenario = load_scenario(spec.scenario)
    inputs = demo_specs(scenario) if spec.demo else []
    if spec.script is not None:
        source = str(data_folder() / "scenarios" / "scripts" / f"{spec.script}.yaml")
        inputs.append(InputSpec("script", source, {}, {}, scenario.arena, len(scenario.robots.points)))
    session = _WatchedSession(scenario, [open_interface(given) for given in inputs])
    try:
        history = _History(session.snapshot)
        session.watch = history.add
        report = run_headless(session, spec.duration)
    finally:
        session.close()
    columns = [np.array(column) for column in zip(*history.rows, strict=True)]
    return Run(
        spec, scenario, session.setup, report, *columns, links=tuple(history.links), paths=tuple(history.paths),
        events=session.snapshot.events,
    )  # fmt: skip
