"""One task of Enki's e-pucks, in lockstep: as fast as the machine, and the same each time."""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from higvf_console.lab.team.enki import Enki, Judgement, world_of
from higvf_console.lab.team.lockstep import LockstepTeam
from higvf_console.lab.team.scenes import Operator, Scene, distances_to
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.recording import Recorder
from higvf_console.runtime.run import Tick
from higvf_console.runtime.session import Session
from higvf_console.runtime.teams import RuleOptions, rules_of, team_spec
from higvf_console.team.driver import TeamDriver

ARRIVED = 0.1  # from the end of a path [m]


class Conditions(NamedTuple):
    """What is wrong on the way, see `enki_plant.Faults`."""

    latency_s: float = 0.0
    noise_m: float = 0.0
    loss: float = 0.0


class Outcome(NamedTuple):
    """How a task went.

    Attributes:
        scene: its name.
        conditions: on the link.
        seconds: simulated [s].
        arrived: whether all fires are out, or the robot has come to the end of its path.
        took: from arming until then [s]; NaN = it has not.
        path_error: mean distance of the robot from what was drawn, up to there [m].
        infeasible: control periods without a velocity that keeps all clearances.
        digest: of the run.
        judged: by the plant.
    """

    scene: str
    conditions: Conditions
    seconds: float
    arrived: bool
    took: float
    path_error: float
    infeasible: int
    digest: str
    judged: Judgement


class _Watch:
    """Follows the robot that the operator draws for."""

    def __init__(self, scene: Scene, operator: Operator) -> None:
        self._scene, self._operator = scene, operator
        self.points = list[tuple[float, float]]()
        self.arrived_at = math.nan

    def see(self, tick: Tick) -> None:
        """After each control period."""
        if self._operator.armed_at is None or not math.isnan(self.arrived_at):
            return
        motion = tick.state.motion
        point = motion.position[self._scene.robot]
        self.points.append((float(point[0]), float(point[1])))
        fires = len(motion.fire_burning)
        there = not motion.fire_burning.any() if fires else math.dist(point, self._scene.stroke[-1]) < ARRIVED
        if there:
            self.arrived_at = tick.time


def run(scene: Scene, conditions: Conditions, seed: int = 0, record: Path | None = None) -> Outcome:
    """Runs a task once.

    Args:
        scene: the task.
        conditions: on the link.
        seed: of what is random about them.
        record: file to write the run down in.

    Raises:
        HigvfError: Enki is not installed.
    """
    scenario, setup = scene.scenario, scene.scenario.setup(0)
    spec, _ = team_spec("lockstep", "--team", scenario, setup)
    rules = rules_of(spec, RuleOptions(error_m=conditions.noise_m))
    plant = Enki(world_of(scenario, setup, seed), "lockstep", **conditions._asdict())
    operator = Operator(scene)
    with TeamDriver(LockstepTeam(plant, spec.robots), spec.robots, rules, None, spec.period) as driver:
        recorder = None if record is None else Recorder(record, scenario, 0, rules=rules)
        session = Session(scenario, [operator], recorder=recorder, team=driver)
        operator.events = lambda: session.snapshot.events
        watch = _Watch(scene, operator)
        report = run_headless(session, scene.limit, watch.see)
        judged = plant.judgement()
        session.close()
    error = np.mean(distances_to(scene.stroke, np.array(watch.points))) if watch.points else math.nan
    took = math.nan if operator.armed_at is None else watch.arrived_at - operator.armed_at
    return Outcome(
        scene.name, conditions, report["duration_s"], not math.isnan(took), took, float(error),
        report["infeasible_ticks"], report["digest"], judged,
    )  # fmt: skip
