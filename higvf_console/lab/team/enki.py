"""Starts the plant of `enki_plant` in a process of its own, breaks it on purpose, and asks it what it saw."""

import json
import subprocess
from pathlib import Path
from typing import Any, NamedTuple

from higvf_console.core.arrays import Floats
from higvf_console.core.errors import HigvfError
from higvf_console.scenario.scenario import Scenario
from higvf_console.sim.unicycle import body_centres
from higvf_console.world.setup import Setup

PYTHON = "/usr/bin/python3"  # Debian builds Enki for the system's Python
NO_ENKI = f"Enki is not there: install the package 'python3-enki2', which {PYTHON} imports as 'pyenki'"
_PROGRAM = Path(__file__).with_name("enki_plant.py")
_PATIENCE = 10.0  # for the program to end [s]


def has_enki() -> bool:
    """Whether the system's Python has Enki."""
    try:
        return (
            subprocess.run([PYTHON, "-c", "import pyenki"], capture_output=True, check=False, timeout=60).returncode
            == 0
        )
    except OSError:
        return False


class Judgement(NamedTuple):
    """What the plant itself saw since it was started, see `enki_plant.Plant.judgement`."""

    now: float
    contacts: int
    least_robots_m: float | None
    least_obstacles_m: float | None
    stood_since_s: float | None
    each_stood_since_s: list[float | None]
    latencies_s: list[float]
    poses: list[tuple[float, float, float]]
    held_up_s: float


def world_of(scenario: Scenario, setup: Setup, seed: int = 0) -> dict[str, Any]:
    """The world of a scenario in the words of the plant.

    Args:
        scenario: its arena starts at (0, 0); its obstacles are circles.
        setup: its start.
        seed: of the plant's noise and losses.

    Raises:
        HigvfError: the plant cannot have such a world.
    """
    arena, obstacles, motion = scenario.arena, scenario.obstacles, setup.start.motion
    if (arena.x_min, arena.y_min) != (0.0, 0.0) or len(obstacles.bars) or obstacles.polygons:
        raise HigvfError(f"scenario '{scenario.name}': Enki needs an arena from (0, 0), and obstacles that are circles")
    centres: Floats = body_centres(motion.position, motion.heading, setup.params.robots.look_ahead)
    robots = [[*centre, heading] for centre, heading in zip(centres.tolist(), motion.heading.tolist(), strict=True)]
    circles = obstacles.circles.tolist()
    return {"width": arena.x_max, "height": arena.y_max, "robots": robots, "obstacles": circles, "seed": seed}


class Enki:
    """A running plant; to be closed."""

    def __init__(self, world: dict[str, Any], mode: str, **faults: Any) -> None:
        """Starts it.

        Args:
            world: from `world_of`.
            mode: "udp" or "lockstep".
            faults: from the start, see `enki_plant.Faults`.

        Raises:
            HigvfError: Enki is not installed, or the plant does not start.
        """
        if not has_enki():
            raise HigvfError(NO_ENKI)
        self.process = subprocess.Popen(
            [PYTHON, "-u", str(_PROGRAM)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )
        self.say({"mode": mode, "world": world, "faults": faults})
        self.port = int(self._hear()["port"]) if mode == "udp" else 0

    def say(self, line: dict[str, Any]) -> None:
        """Sends it a line."""
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps(line) + "\n")

    def ask(self, line: dict[str, Any]) -> dict[str, Any]:
        """Sends it a line; returns its answer."""
        self.say(line)
        return self._hear()

    def break_(self, **faults: Any) -> None:
        """Changes what is wrong, see `enki_plant.Faults`."""
        self.say({"faults": faults})

    def judgement(self) -> Judgement:
        """What it has seen."""
        return Judgement(**self.ask({"judge": True}))

    def close(self) -> None:
        """Ends it."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        try:
            self.process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()

    def __enter__(self) -> "Enki":
        """To be closed at the end of a block."""
        return self

    def __exit__(self, *_: object) -> None:
        """Ends it."""
        self.close()

    def _hear(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        if not (line := self.process.stdout.readline()):
            raise HigvfError(f"the plant of Enki has ended with status {self.process.wait(_PATIENCE)}")
        return json.loads(line)
