"""The built-in team: robots of a plant of its own, behind a link that is as late and as unsure as it is told to be.

    --team simulated=:latency_s=0.1,noise_m=0.002,loss=0.05,dead=2,dead_at_s=20

The first test of every rule of a team, and a rehearsal of a study without robots. All draws come from one seed, and the
plant knows no clock but `now`, so the same calls give the same poses.
"""

import math
from collections import deque
from typing import Annotated as A  # noqa: N817 (a table needs narrow columns)
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools
from higvf_console.core.errors import InputError
from higvf_console.core.quantity import Quantity as Q  # noqa: N817
from higvf_console.core.team import Drive, Poses, RobotLink, TeamSpec, never_seen, options_of, standing

_SUBSTEP = 0.005  # of the plant [s]
_WHOLE_BATTERY_S = 3600.0  # for which a simulated battery lasts [s]


class SimulatedOptions(NamedTuple):
    """What its options mean; robots count from 1, 0 = none."""

    latency_s: A[float, Q("s", 0.0, 2.0, "", "From a command to its effect, and from a pose to the console, each.")] = (
        0.0
    )
    noise_m: A[float, Q("m", 0.0, 1.0, "", "Largest error of a measured coordinate.")] = 0.0
    loss: A[float, Q("", 0.0, 1.0, "", "Share of commands and of poses that are lost.")] = 0.0
    seed: A[float, Q("", 0.0, 2.0**32, "", "Of errors and losses.")] = 0.0
    dead: A[float, Q("", 0.0, 1e4, "", "Robot that stops and falls silent.")] = 0.0
    dead_at_s: A[float, Q("s", 0.0, 1e6, "", "When it does.")] = 0.0
    deaf: A[float, Q("", 0.0, 1e4, "", "Robot that goes on with its last command.")] = 0.0
    deaf_at_s: A[float, Q("s", 0.0, 1e6, "", "When it begins to.")] = 0.0
    watchdog: A[float, Q("", 0.0, 1.0, "", "1 = robots stand when commands cease; 0 = they drive on.")] = 1.0


class _Late(NamedTuple):
    """What is on its way: when it arrives, and what."""

    at: float
    what: object


class SimulatedTeam:
    """N robots whose centres move as they are told."""

    name = "simulated"

    def __init__(self, spec: TeamSpec) -> None:
        """Starts where the scenario has the robots.

        Raises:
            InputError: an option cannot be used.
        """
        self._spec, self._options = spec, options_of(spec, SimulatedOptions)
        for option in ("dead", "deaf"):
            robot = getattr(self._options, option)
            if not float(robot).is_integer() or robot > spec.robots:
                raise InputError(f"{spec.place}: {option}={robot:g} is no robot; choose 1 to {spec.robots}, or 0")
        self._rng = np.random.default_rng(int(self._options.seed))
        self._position, self._heading = spec.start.copy(), spec.headings.copy()
        self._now: float | None = None
        self._since = math.inf  # when it was asked first [s]
        self._commands = deque[_Late]()
        self._reports = deque[_Late]()
        self._force = standing(spec.robots, 0)
        self._heard_at = np.full(spec.robots, -math.inf)
        self._acknowledged = 0
        self._newest = never_seen(spec.robots)

    def poses(self, now: float) -> Poses:
        """What has arrived of the poses by `now` [s]."""
        self._advance(now)
        while self._reports and self._reports[0].at <= now:
            fresh = self._reports.popleft().what
            assert isinstance(fresh, Poses)
            told = np.isfinite(fresh.measured_at)
            self._newest = Poses(
                np.where(told[:, None], fresh.position, self._newest.position),
                np.where(told, fresh.heading, self._newest.heading),
                np.where(told, fresh.measured_at, self._newest.measured_at),
            )
        return self._newest

    def drive(self, command: Drive, now: float) -> None:
        """Sends a command, which arrives later or is lost."""
        if self._rng.random() >= self._options.loss:
            self._commands.append(_Late(now + self._options.latency_s, command))

    def stop(self, now: float) -> None:
        """Lets all stand as soon as a command can arrive."""
        self._commands.clear()
        self._commands.append(_Late(now + self._options.latency_s, standing(self._spec.robots, self._force.number)))

    def links(self, now: float) -> tuple[RobotLink, ...]:
        """All are connected but a dead one."""
        battery = min(max(1.0 - (now - self._since) / _WHOLE_BATTERY_S, 0.0), 1.0)
        silent = self._broken("dead", now)
        return tuple(
            RobotLink(self._acknowledged, battery, not dead, "silent" if dead else "") for dead in silent.tolist()
        )

    def close(self) -> None:
        """Nothing has to be closed."""

    def _broken(self, option: str, now: float) -> Bools:
        robot, since = getattr(self._options, option), getattr(self._options, f"{option}_at_s")
        return (np.arange(self._spec.robots) == robot - 1) & (now >= since)

    def _advance(self, now: float) -> None:
        if self._now is None:
            self._now = self._since = now
        while now - self._now > 1e-9:
            step = min(_SUBSTEP, now - self._now)
            self._hear(self._now)
            self._move(self._now, step)
            self._now += step
        self._measure(now)

    def _hear(self, now: float) -> None:
        while self._commands and self._commands[0].at <= now:
            command = self._commands.popleft().what
            assert isinstance(command, Drive)
            deaf = self._broken("deaf", now)
            self._force = Drive(
                command.number,
                np.where(deaf[:, None], self._force.velocity, command.velocity),
                np.where(deaf, self._force.forward, command.forward),
                np.where(deaf, self._force.turn, command.turn),
                command.valid_for,
            )
            self._heard_at = np.where(deaf, self._heard_at, now)
            self._acknowledged = max(self._acknowledged, command.number)

    def _move(self, now: float, step: float) -> None:
        heard = (now - self._heard_at <= self._force.valid_for) | (self._options.watchdog == 0.0)
        drives = (heard | self._broken("deaf", now)) & ~self._broken("dead", now)
        if self._spec.look_ahead == 0.0:
            self._position = self._position + self._force.velocity * drives[:, None] * step
            return
        half = 0.5 * self._force.turn * drives * step
        chord = self._force.forward * drives * step * np.sinc(half / math.pi)
        course = self._heading + half
        self._position = self._position + chord[:, None] * np.column_stack((np.cos(course), np.sin(course)))
        self._heading = self._heading + 2.0 * half

    def _measure(self, now: float) -> None:
        robots, noise = self._spec.robots, self._options.noise_m
        lost = (self._rng.random(robots) < self._options.loss) | self._broken("dead", now)
        error = self._rng.uniform(-noise, noise, (robots, 2)) / math.sqrt(2.0)
        position = np.where(lost[:, None], np.nan, self._position + error)
        measured = Poses(position, np.where(lost, np.nan, self._heading), np.where(lost, np.nan, now))
        self._reports.append(_Late(now + self._options.latency_s, measured))
