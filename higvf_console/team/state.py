"""A team of robots at one moment, and what it tells in one control period."""

import math
from collections.abc import Iterable
from enum import StrEnum
from typing import NamedTuple, TypeAlias

import numpy as np

from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.events import Event, Severity
from higvf_console.core.team import Poses, RobotLink
from higvf_console.team.tracking import Sent, Track, nowhere

Told: TypeAlias = tuple[Severity, str, int | None]  # how loud, one sentence, the robot (from 0; None = the team)


class Arming(StrEnum):
    """Whether the team may drive."""

    DISARMED = "disarmed"
    CHECKING = "checking"
    CHECKED = "checked"
    ARMED = "armed"


class TeamReport(NamedTuple):
    """What the team tells in one control period; recorded, so that a replay needs no team.

    Attributes:
        now: [s].
        poses: newest of each robot.
        links: to each robot.
        failure: why the team cannot be talked to; "" = it can.
    """

    now: float
    poses: Poses
    links: tuple[RobotLink, ...]
    failure: str = ""


class TeamState(NamedTuple):
    """A team of N robots at one moment.

    Attributes:
        now: of the last report [s].
        track: where the robots are.
        sent: commands that may still act.
        number: of the latest command.
        arming: whether it may drive.
        since: when `arming` became so [s].
        stopped: (N,) robots that the operator has stopped one by one.
        told_at: (N,) since when a robot has been told to stand; inf = it may drive [s].
        stood: (N,) robots that have stood since they were told to, or were never told to drive.
        latency: from a command to its confirmation, lately [s]; 0 = nothing is confirmed.
        links: to each robot.
        stale: (N,) robots whose pose is too old.
        unseen_at: (N,) when that was last so [s].
        disobedient: (N,) robots that are told to stand and do not.
        faults: (N,) whether the latest pose of a robot was refused.
        failure: of the last report.
    """

    now: float
    track: Track
    sent: tuple[Sent, ...]
    number: int
    arming: Arming
    since: float
    stopped: Bools
    told_at: Floats
    stood: Bools
    latency: float
    links: tuple[RobotLink, ...]
    stale: Bools
    unseen_at: Floats
    disobedient: Bools
    faults: Bools
    failure: str

    @property
    def armed(self) -> bool:
        """Whether the team may drive."""
        return self.arming is Arming.ARMED

    @property
    def held(self) -> Bools:
        """(N,) robots that stand while others may drive."""
        return self.stopped | self.stale | self.disobedient

    @property
    def acknowledged(self) -> Bools:
        """(N,) robots that have confirmed the latest command to stand, or any later one."""
        return np.array([link.acknowledged >= 0 for link in self.links]) & ~np.isinf(self.told_at) & self._confirmed

    @property
    def _confirmed(self) -> Bools:
        first = [next((one.command.number for one in self.sent if one.at >= told), math.inf) for told in self.told_at]
        return np.array([link.acknowledged >= number for link, number in zip(self.links, first, strict=True)])


def opened(robots: int) -> TeamState:
    """A team of which nothing is known yet."""
    no = np.zeros(robots, np.bool_)
    return TeamState(
        now=0.0, track=nowhere(robots), sent=(), number=0, arming=Arming.DISARMED, since=0.0, stopped=no,
        told_at=np.zeros(robots), stood=~no, latency=0.0, links=(RobotLink(),) * robots, stale=no,
        unseen_at=np.zeros(robots), disobedient=no, faults=no, failure="",
    )  # fmt: skip


def names(robots: Ints) -> str:
    """Robots (from 0) in words."""
    numbers = [str(int(robot) + 1) for robot in robots]
    if len(numbers) == 1:
        return f"robot {numbers[0]}"
    return f"robots {', '.join(numbers[:-1])} and {numbers[-1]}"


def events_of(told: Iterable[Told], time: float) -> tuple[Event, ...]:
    """The events at session `time` [s]."""
    return tuple(Event(time, severity, "team", text, robot=robot) for severity, text, robot in told)
