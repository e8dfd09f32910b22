"""A run whose robots are those of a simulated team, beat by beat; and what can be done to that team."""

from collections.abc import Callable
from pathlib import Path
from threading import Event as Signal

import numpy as np

from higvf_console.core.commands import Arm, AskArm, OperatorCommand
from higvf_console.core.events import Severity
from higvf_console.core.team import Drive, Poses, RobotLink, TeamSpec
from higvf_console.runtime.recording import Recorder
from higvf_console.runtime.session import Session
from higvf_console.runtime.teams import rules_of, team_spec
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.team.driver import TeamDriver
from higvf_console.team.simulated import SimulatedTeam
from higvf_console.team.state import TeamState
from tests.fake_interfaces import FakeConsole

PERIOD = 0.02  # [s]
THREE = """
version: 1
arena: {size_m: [3.2, 2], walls: true}
robots: {radius_m: 0.037, speed_limit_m_per_s: 0.12, heading_deg: 0, start_m: [[0.6, 0.6], [0.6, 1.0], [0.6, 1.4]]}
fires: [{at_m: [2.2, 1.0], radius_m: 0.1, growth_m_per_s: 0.0002, robots_needed: 1}]
parameters:
  robots: {look_ahead: 0.024, turn_rate_limit: 4}
  boundaries: {reactive_margin: 0.12, repulsive_margin: 0.072}
  fires: {stand_off: 0.14}
duration_s: 600
"""


class MeddledTeam(SimulatedTeam):
    """A simulated team whose poses and links go through the hands of a test, and which counts its stops."""

    def __init__(self, spec: TeamSpec) -> None:
        super().__init__(spec)
        self.meddle: Callable[[Poses, float], Poses] = lambda poses, _now: poses
        self.relink: Callable[[tuple[RobotLink, ...]], tuple[RobotLink, ...]] = lambda links: links
        self.sent: list[Drive] = []
        self.stops = 0
        self.closed = False

    @property
    def truth(self) -> Poses:
        """Where the robots of the plant are, whatever is told."""
        return Poses(self._position, self._heading, np.full(len(self._position), self._now or 0.0))

    def poses(self, now: float) -> Poses:
        return self.meddle(super().poses(now), now)

    def links(self, now: float) -> tuple[RobotLink, ...]:
        return self.relink(super().links(now))

    def drive(self, command: Drive, now: float) -> None:
        self.sent.append(command)
        super().drive(command, now)

    def stop(self, now: float) -> None:
        self.stops += 1
        super().stop(now)

    def close(self) -> None:
        self.closed = True


class Rehearsal:
    """A session with its console and its team."""

    def __init__(self, options: str = "", text: str = THREE, record: Path | None = None) -> None:
        self.scenario: Scenario = parse_scenario(text, "rehearsal.yaml")
        spec, given = team_spec(f"simulated=:{options}", "--team", self.scenario, self.scenario.setup())
        rules = rules_of(spec, given)
        self.plant = MeddledTeam(spec)
        self.console = FakeConsole()
        driver = TeamDriver(self.plant, spec.robots, rules, None, PERIOD)
        recorder = None if record is None else Recorder(record, self.scenario, 0, rules=rules)
        self.session = Session(self.scenario, [self.console], recorder=recorder, team=driver)

    @property
    def team(self) -> TeamState:
        team = self.session.snapshot.team
        assert team is not None
        return team

    def give(self, *commands: OperatorCommand) -> None:
        for command in commands:
            self.console.push(command)
        self.beat()

    def beat(self, count: int = 1) -> None:
        for _ in range(count):
            self.session.tick()

    def last(self, seconds: float) -> None:
        self.beat(round(seconds / PERIOD))

    def arm(self) -> "Rehearsal":
        """Arms the team as an operator does."""
        self.last(0.5)
        self.give(AskArm())
        self.last(2.0)
        self.give(Arm())
        assert self.team.armed, self.texts()
        return self

    def halt(self, error: Exception) -> None:
        """The engine fails in its loop, once."""
        stopping, tick = Signal(), self.session.tick

        def fail(**_: bool) -> None:
            stopping.set()
            raise error

        self.session.tick = fail  # type: ignore[method-assign]
        self.session.run(stopping)
        self.session.tick = tick  # type: ignore[method-assign]

    def texts(self, *severities: Severity) -> list[str]:
        """What was told of the team, and what was refused."""
        return [
            event.text
            for event in self.session.snapshot.events
            if event.kind in ("team", "refused") and (not severities or event.severity in severities)
        ]

    def moved(self, seconds: float) -> float:
        """By how much the robots move at most in the next seconds, in truth [m]."""
        before = self.plant.truth.position.copy()
        self.last(seconds)
        return float(np.hypot(*(self.plant.truth.position - before).T).max())
