"""Something is killed at a random moment while the e-pucks drive, in real time: when does the last wheel stand?

console   its process, by SIGKILL
poses     the robots report where they are no more
network   nothing passes any more, either way
robot     one is dead; the others must stand too

What was cut off comes back after `_CUT` seconds, and then nothing may move by itself.
"""

import json
import math
import random
import subprocess
import sys
import time
from typing import Any, NamedTuple

from higvf_console.core.errors import HigvfError
from higvf_console.lab.team.enki import Enki, world_of
from higvf_console.lab.team.scenes import Scene

KINDS = ("console", "poses", "network", "robot")
BOUND = 0.5  # within which every wheel stands [s]
_MOMENTS = (1.0, 5.0)  # after arming [s]
_CUT = 2.0  # [s]
_WATCHED = 1.5  # after that [s]
_FAULTS: dict[str, dict[str, Any]] = {"poses": {"blind": True}, "network": {"dropped": True}, "robot": {"dead": 3}}
_MENDED: dict[str, dict[str, Any]] = {"poses": {"blind": False}, "network": {"dropped": False}, "robot": {"dead": 0}}


class Kill(NamedTuple):
    """One kill.

    Attributes:
        kind: of `KINDS`.
        moment: after arming [s].
        stood_after: until the last wheel stood [s]; inf = one did not.
        moved_again: whether a wheel turned later.
        contacts: that the plant saw.
        latencies_s: from a command until the wheels had it.
        lost_s: by which the console was late in all.
        held_up_s: by which the plant, and with it each robot, was late at most.
        told: what the console said about it; empty for a killed one.
    """

    kind: str
    moment: float
    stood_after: float
    moved_again: bool
    contacts: int
    latencies_s: list[float]
    lost_s: float
    held_up_s: float
    told: tuple[str, ...]


class Console:
    """A process of `lab.team.live`; to be closed."""

    def __init__(self, scene: Scene, team: str, *more: str) -> None:
        """Starts it."""
        self.process = subprocess.Popen(
            [sys.executable, "-m", "higvf_console.lab.team.live", scene.name, team, *more],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1,
        )  # fmt: skip

    def hear(self) -> dict[str, Any]:
        """Waits for a line."""
        assert self.process.stdout is not None
        if not (line := self.process.stdout.readline()):
            raise HigvfError(f"suite team: the console has ended with status {self.process.wait()}")
        return json.loads(line)

    def report(self) -> dict[str, Any]:
        """How the run is."""
        assert self.process.stdin is not None
        self.process.stdin.write("report\n")
        return self.hear()

    def close(self) -> None:
        """Ends it."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        try:
            self.process.wait(10.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()

    def __enter__(self) -> "Console":
        """To be closed at the end of a block."""
        return self

    def __exit__(self, *_: object) -> None:
        """Ends it."""
        self.close()


def kill(kind: str, scene: Scene, draw: random.Random) -> Kill:
    """Starts plant and console, and kills once.

    Raises:
        HigvfError: Enki is not installed, or the console ends by itself.
    """
    moment = draw.uniform(*_MOMENTS)
    world = world_of(scene.scenario, scene.scenario.setup(0), draw.randrange(2**31))
    with Enki(world, "udp") as plant, Console(scene, team_of(plant)) as console:
        console.hear()
        time.sleep(moment)
        told, lost = (), 0.0
        if kind == "console":
            lost = float(console.report()["lost_s"])
            at = time.monotonic()
            console.process.kill()
        else:
            at = time.monotonic()
            plant.break_(**_FAULTS[kind])
        time.sleep(_CUT)
        stood = plant.judgement().stood_since_s
        if kind != "console":
            plant.break_(**_MENDED[kind])
        time.sleep(_WATCHED)
        last = plant.judgement()
        if kind != "console":
            report = console.report()
            told, lost = tuple(report["events"]), float(report["lost_s"])
    after = math.inf if stood is None else max(stood - at, 0.0)
    again = stood is not None and last.stood_since_s != stood
    return Kill(kind, moment, after, again, last.contacts, last.latencies_s, lost, last.held_up_s, told)


def team_of(plant: Enki) -> str:
    """The value of `--team` for a plant that speaks UDP."""
    return f"udp=udp://127.0.0.1:{plant.port}:stamp=sent"
