"""Headless runs with their history; each run is computed once and shared by all cases."""

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
    """Specification of a run.

    Attributes:
        scenario: name of a shipped scenario.
        script: name of a shipped script, or None.
        demo: whether to use the recorded inputs of the scenario.
        duration: session time [s]; None = duration of the scenario.
    """

    scenario: str
    script: str | None = None
    demo: bool = False
    duration: float | None = None

    def __str__(self) -> str:
        """The equivalent command line."""
        given = " --demo" if self.demo else f" --script scenarios/scripts/{self.script}.yaml" if self.script else ""
        lasts = f" --duration {self.duration:g}" if self.duration else ""
        return f"higvf run {self.scenario} --headless{given}{lasts}"


class GivenPath(NamedTuple):
    """A desired path and the session time from which it was active [s]."""

    time: float
    path: Path


class Run(NamedTuple):
    """A finished run and its history: T + 1 states including the start, N robots, M fires.

    Attributes:
        spec: its specification.
        scenario: its scenario.
        setup: world, parameters and start state.
        report: report of `run_headless`.
        time: (T + 1,) [s].
        position: (T + 1, N, 2) [m].
        velocity: (T + 1, N, 2) after the safety filter [m/s].
        target: (T + 1, N) fire index or NOBODY.
        fire_radius: (T + 1, M) [m].
        burning: (T + 1, M).
        path_status: (T + 1,) a `PathStatus`.
        path_parameter: (T + 1,) w [m].
        influenced: (T + 1,) robot index.
        paused: (T + 1,).
        clearance: (T + 1,) minimum of the team [m].
        connectivity: (T + 1,) lambda_2 of the Laplacian of the links.
        links: T + 1 arrays (E, 2) of robot pairs.
        paths: the desired paths, in order.
        events: events of the session.
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

    def index_at(self, time: float) -> int:
        """Index of the state nearest to a session time [s]."""
        return int(np.argmin(np.abs(self.time - time)))


class Runs:
    """A cache of runs, shared by the cases."""

    def __init__(self) -> None:
        """Creates an empty cache."""
        self._made: dict[RunSpec, Run] = {}

    def get(self, spec: RunSpec) -> Run:
        """The run of a specification, computed at the first call.

        Raises:
            HigvfError: the scenario or the script cannot be used.
        """
        if spec not in self._made:
            self._made[spec] = run_with_history(spec)
        return self._made[spec]


class _WatchedSession(Session):
    """A session that passes every snapshot to a callback."""

    watch: Callable[[Snapshot], None] | None = None

    def tick(self, *, advance: bool = True) -> None:
        super().tick(advance=advance)
        if self.watch is not None:
            self.watch(self.snapshot)


class _History:
    """Collects the history of a run."""

    def __init__(self, first: Snapshot) -> None:
        self.states: list[tuple[Any, ...]] = []
        self.links: list[Ints] = []
        self.paths: list[GivenPath] = []
        self.add(first)

    def add(self, now: Snapshot) -> None:
        motion, intent, trace = now.state.motion, now.state.intent, now.trace
        if intent.path.kind != PathKind.NONE and (not self.paths or self.paths[-1].path is not intent.path):
            self.paths.append(GivenPath(now.time, intent.path))
        self.links.append(trace.links)
        self.states.append((
            now.time, motion.position, motion.velocity, motion.target, motion.fire_radius, motion.fire_burning,
            int(motion.path_status), motion.path_parameter, intent.influenced, intent.paused,
            float(trace.clearance.min()), connectivity(trace.links, len(motion.position)),
        ))  # fmt: skip


def run_with_history(spec: RunSpec) -> Run:
    """Runs `spec` to its end in a session, as `higvf run --headless` does.

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
    columns = [np.array(column) for column in zip(*history.states, strict=True)]
    return Run(
        spec, scenario, session.setup, report, *columns, links=tuple(history.links), paths=tuple(history.paths),
        events=session.snapshot.events,
    )  # fmt: skip
