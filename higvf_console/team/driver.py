"""The live team: what it tells in each control period, and what its robots are told."""

import logging
import math
from collections.abc import Callable
from types import TracebackType
from typing import Any

import numpy as np

from higvf_console.core.team import (
    Drive,
    NoticeSource,
    Picture,
    PictureSource,
    Poses,
    PoseSource,
    RobotLink,
    Team,
    never_seen,
)
from higvf_console.team.state import TeamReport
from higvf_console.team.tracking import Rules

_LARGEST = 1e12  # number of a pose; larger ones, infinity too, are as good as none
RETRY_AFTER = 1.0  # from a failure until the team is asked again [s]

_log = logging.getLogger(__name__)


class TeamDriver:
    """A team and, where it does not know its poses, what tells them; one that raises is asked again a second later.

    Attributes:
        name: of the team.
        robots: how many it has.
        rules: what they can do.
    """

    def __init__(
        self, team: Team, robots: int, rules: Rules, clock: Callable[[], float] | None, period: float,
        poses: PoseSource | None = None,
    ) -> None:  # fmt: skip
        """Takes both over, to be closed with `close`.

        Args:
            team: hears what the robots shall do.
            robots: how many it has.
            rules: what they can do.
            clock: time [s] that never goes back; None = each report is one control period later than the last.
            period: control period [s].
            poses: tells where the robots are; None = the team does.
        """
        self.name, self.robots, self.rules = team.name, robots, rules
        self._team, self._poses = team, poses or team
        self._clock, self._period, self._now = clock, period, 0.0
        self._failure, self._failed_at, self._logged = "", 0.0, ""

    def report(self) -> TeamReport:
        """What is known now. A failure is told as long as it lasts, and disarms the team."""
        self._now = now = self._now + self._period if self._clock is None else self._clock()
        if now - self._failed_at >= RETRY_AFTER:
            self._failure = ""
        poses = self._ask("poses", lambda: _checked_poses(self._poses.poses(now), self.robots), never_seen(self.robots))
        links = self._ask(
            "links", lambda: _checked_links(self._team.links(now), self.robots), (RobotLink(),) * self.robots
        )
        return TeamReport(now, poses, links, self._failure)

    def notices(self) -> tuple[str, ...]:
        """What team and source of poses have to tell people since the last call, a sentence each."""
        told: tuple[str, ...] = ()
        for part in self._parts():
            if isinstance(part, NoticeSource):
                told += self._ask("notices", part.notices, ())
        return told

    @property
    def has_picture(self) -> bool:
        """Whether team or source of poses has a live picture of the arena."""
        return any(isinstance(part, PictureSource) for part in self._parts())

    def picture(self) -> Picture | None:
        """The newest picture of the arena; None = there is none. May be called on any thread."""
        for part in self._parts():
            if isinstance(part, PictureSource):
                return part.picture()
        return None

    def _parts(self) -> tuple[PoseSource, ...]:
        """Team and source of poses, each once."""
        return (self._team,) if self._poses is self._team else (self._team, self._poses)

    def send(self, command: Drive | None) -> None:
        """Tells the robots what to do; None tells them nothing."""
        if command is not None:
            self._ask("drive", lambda: self._team.drive(command, self._time()), None)

    def stop(self) -> None:
        """Lets all robots stand by the fastest way, also when the team has failed before."""
        try:
            self._team.stop(self._time())
        except Exception as error:  # whatever an adapter raises: STOP is tried again with every command
            _log.error("team '%s' could not be stopped", self.name, exc_info=error)

    def close(self) -> None:
        """Stops the robots and closes the team."""
        self.stop()
        for part in self._parts():
            try:
                part.close()
            except Exception as error:  # as above; the other part is closed too
                _log.error("team '%s' does not close", self.name, exc_info=error)

    def __enter__(self) -> "TeamDriver":
        """To be closed at the end of a block."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Closes it."""
        self.close()

    def _time(self) -> float:
        return self._now if self._clock is None else self._clock()

    def _ask(self, name: str, ask: Callable[[], Any], otherwise: Any) -> Any:
        if self._failure:
            return otherwise
        try:
            return ask()
        except Exception as error:  # whatever an adapter raises: the team is disarmed, and the run goes on
            self._failure = f"team '{self.name}' failed in {name}: {type(error).__name__}: {error}"
            self._failed_at = self._time()
            if self._logged != self._failure:
                self._logged = self._failure
                _log.error("team '%s' failed in %s", self.name, name, exc_info=error)
            self.stop()
            return otherwise


def _checked_poses(poses: Poses, robots: int) -> Poses:
    shapes = [part.shape for part in poses]
    if shapes != [(robots, 2), (robots,), (robots,)]:
        raise ValueError(f"poses of shapes {shapes}; expected {robots} robots")
    return Poses(*(np.where(np.abs(part) < _LARGEST, part, np.nan) for part in poses))


def _checked_links(links: tuple[RobotLink, ...], robots: int) -> tuple[RobotLink, ...]:
    if len(links) != robots:
        raise ValueError(f"{len(links)} links; expected {robots}, one of each robot")
    return tuple(_checked_link(*link) for link in links)


def _checked_link(acknowledged: int, battery: float, connected: bool, detail: str) -> RobotLink:
    """A link as a recording can hold it."""
    return RobotLink(
        int(acknowledged), float(battery) if 0.0 <= battery <= 1.0 else math.nan, bool(connected), str(detail)[:200]
    )
