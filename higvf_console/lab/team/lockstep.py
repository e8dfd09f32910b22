"""A team of Enki's robots whose time passes with the control periods: runs as fast as the machine, and repeatable.

It waits for the plant's answer in each control period, as no team of a console may.
"""

from typing import Any

import numpy as np

from higvf_console.core.team import Drive, Poses, RobotLink, never_seen
from higvf_console.lab.team.enki import Enki


class LockstepTeam:
    """The robots of a plant in the mode "lockstep"."""

    name = "lockstep"

    def __init__(self, plant: Enki, robots: int) -> None:
        """Takes over the plant, to be closed with `close`."""
        self._plant, self._robots = plant, robots
        self._poses = never_seen(robots)
        self._acknowledged = [0] * robots
        self._waiting: list[dict[str, Any]] = []

    def poses(self, now: float) -> Poses:
        """Lets time pass until `now` [s]; what has arrived."""
        answer = self._plant.ask({"now": now, "commands": self._waiting})
        self._waiting = []
        position, heading, measured_at = (part.copy() for part in self._poses)
        for report in answer["reports"]:
            k = report["robot"] - 1
            self._acknowledged[k] = max(self._acknowledged[k], report["n"])
            if "t" in report:
                position[k], heading[k] = (report["x"], report["y"]), report["theta"]
                measured_at[k] = report["t"]
        self._poses = Poses(position, heading, measured_at)
        return self._poses

    def drive(self, command: Drive, now: float) -> None:
        """A command sets off with the next control period."""
        self._waiting = [
            {"robot": k + 1, "n": command.number, "v": v, "w": w, "valid_s": command.valid_for, "at": now}
            for k, (v, w) in enumerate(zip(command.forward.tolist(), command.turn.tolist(), strict=True))
        ]

    def stop(self, now: float) -> None:
        """All stand."""
        zeros = np.zeros(self._robots)
        number = max(self._acknowledged)
        self.drive(Drive(number, np.zeros((self._robots, 2)), zeros, zeros), now)

    def links(self, now: float) -> tuple[RobotLink, ...]:  # noqa: ARG002
        """All are connected."""
        return tuple(RobotLink(number) for number in self._acknowledged)

    def close(self) -> None:
        """Ends the plant."""
        self._plant.close()
