"""E-pucks of Enki, a physics simulator that is not ours: a program of its own, which stands for a laboratory.

It runs under the system's Python with Debian's `python3-enki2` and the standard library alone; nothing of the console
is imported. One JSON line on its input says what the world is (`World` below names the keys); then

    {"mode": "udp"}       robots live in real time and speak UDP, which the `udp` team hears; it prints {"port": ...}
    {"mode": "lockstep"}  nothing passes until a line {"now": s, "commands": [...]} comes; it answers
                          {"reports": [...]} for that time, so that a run is as fast as the machine, and repeatable

Datagrams are JSON objects, one for each robot, in metres, radians and seconds of the machine's monotonic clock:

    to a robot    {"robot": 1, "n": 7, "v": 0.1, "w": 0.2, "valid_s": 0.3, "at": 12.30}
    from a robot  {"robot": 1, "id": "e-puck 1", "t": 12.31, "x": 0.6, "y": 1.0, "theta": 0.0, "n": 7}

Further lines of the input: {"faults": {...}} changes what is wrong with link and robots, see `Faults`; {"judge": true}
asks what the plant itself saw, see `Plant.judgement`. The end of the input ends the program.
"""

import heapq
import json
import math
import random
import select
import socket
import sys
import time
from dataclasses import dataclass, field, replace
from importlib import import_module
from itertools import count
from typing import Any

STEP = 0.01  # of the physics [s]
REPORT_EVERY = 2  # steps
CM = 100.0  # Enki's units in a metre
AXLE = 0.0515  # distance between the wheels, as measured: Enki does not tell it [m]
FASTEST_WHEEL = 0.128  # [m/s]
CONTACT = 0.0002  # gap below which bodies touch [m]
STANDS = 1e-6  # speed of a wheel below which it stands [m/s]
_JUMP = 1.0  # [m]
_AHEAD = 10.0  # of stamps from the future [s]
_MOST_LATENCIES = 20_000


@dataclass(frozen=True)
class World:
    """What is to be built: lengths in metres, robots as (x, y, heading), obstacles as circles (x, y, radius)."""

    width: float
    height: float
    robots: list[list[float]]
    obstacles: list[list[float]] = field(default_factory=lambda: [])
    seed: int = 0


@dataclass(frozen=True)
class Faults:
    """What is wrong; robots count from 1, 0 = none.

    Attributes:
        latency_s: of each command and of each report on its way [s].
        noise_m: largest error of a reported position [m].
        loss: share of commands and of reports that are lost.
        dead: it stands and reports no more.
        deaf: it obeys no more, and drives on with its last command.
        dropped: whether the network is down, both ways.
        blind: whether no poses are reported, of any robot.
        jump: its poses are off by 1 m.
        nan: its poses are no numbers.
        future: its stamps lie 10 s ahead.
        twin: another one reports by its name, from elsewhere.
        watchdog: whether a robot stands when its last command has expired.
    """

    latency_s: float = 0.0
    noise_m: float = 0.0
    loss: float = 0.0
    dead: int = 0
    deaf: int = 0
    dropped: bool = False
    blind: bool = False
    jump: int = 0
    nan: int = 0
    future: int = 0
    twin: int = 0
    watchdog: bool = True


class Link:
    """One direction of a network: what is sent arrives later, in its own order of arrival, or never."""

    def __init__(self, draw: random.Random) -> None:
        """Nothing is on its way; `draw` decides what is lost."""
        self._draw, self._tie = draw, count()
        self._way: list[tuple[float, int, dict[str, Any]]] = []

    def send(self, message: dict[str, Any], now: float, faults: Faults) -> None:
        """Sends a message."""
        if not faults.dropped and self._draw.random() >= faults.loss:
            heapq.heappush(self._way, (now + faults.latency_s, next(self._tie), message))

    def arrived(self, now: float) -> list[dict[str, Any]]:
        """What has arrived."""
        messages: list[dict[str, Any]] = []
        while self._way and self._way[0][0] <= now:
            messages.append(heapq.heappop(self._way)[2])
        return messages

    def next_arrival(self) -> float:
        """When the next message arrives; inf = none is on its way [s]."""
        return self._way[0][0] if self._way else math.inf


class Robot:
    """One e-puck: its body in Enki, its last command, its own watchdog."""

    def __init__(self, number: int, body: Any) -> None:
        """Stands.

        Args:
            number: from 1.
            body: a `pyenki.EPuck`, or what has its attributes.
        """
        self.number, self.body = number, body
        self.acknowledged, self._expires = 0, -math.inf
        self.stood_since = 0.0  # its wheels; inf = they turn

    def hear(self, command: dict[str, Any], now: float) -> None:
        """Turns its wheels as it is told; both slower in the same share where one would be too fast.

        An older command than the one in force is ignored; once that has expired, another console may count anew.
        """
        if int(command["n"]) < self.acknowledged and now <= self._expires:
            return
        v, w = float(command["v"]), float(command["w"])
        left, right = v - w * AXLE / 2.0, v + w * AXLE / 2.0
        share = min(1.0, FASTEST_WHEEL / max(abs(left), abs(right), 1e-9))
        self.acknowledged = int(command["n"])
        self._expires = now + float(command["valid_s"])
        self._turn(share * left, share * right, now)

    def watch(self, now: float) -> None:
        """Stands when nothing was heard for as long as the last command is valid."""
        if now > self._expires:
            self._turn(0.0, 0.0, now)

    def halt(self, now: float) -> None:
        """Stands."""
        self._turn(0.0, 0.0, now)

    def _turn(self, left: float, right: float, now: float) -> None:
        self.body.leftSpeed, self.body.rightSpeed = CM * left, CM * right
        moves = max(abs(left), abs(right)) > STANDS
        if moves:
            self.stood_since = math.inf
        elif math.isinf(self.stood_since):
            self.stood_since = now

    @property
    def pose(self) -> tuple[float, float, float]:
        """Centre [m] and heading [rad]."""
        x, y = self.body.pos
        return x / CM, y / CM, self.body.angle


class Plant:
    """The world of Enki, its robots, the link to each of them, and a judge of what happens."""

    def __init__(self, world: World, faults: Faults, now: float) -> None:
        """Builds the world at `now` [s]."""
        enki = import_module("pyenki")
        self._world, self.faults, self._now, self._steps = world, faults, now, 0
        self._draw = random.Random(world.seed)
        self._enki = enki.World(CM * world.width, CM * world.height)
        self._enki.setRandomSeed(world.seed)
        self.robots: list[Robot] = []
        for number, (x, y, heading) in enumerate(world.robots, 1):
            body = enki.EPuck()
            body.pos, body.angle = (CM * x, CM * y), heading
            self._enki.addObject(body)
            self.robots.append(Robot(number, body))
        for x, y, radius in world.obstacles:
            body = enki.CircularObject(CM * radius, 10.0, -1.0, enki.Color(0.5, 0.5, 0.5, 1.0))  # -1 = it stays
            body.pos = (CM * x, CM * y)
            self._enki.addObject(body)
        self._radius = self.robots[0].body.radius / CM
        self._to_robots, self._from_robots = Link(self._draw), Link(self._draw)
        self._contacts, self._touching = 0, False
        self._least_robots = self._least_obstacles = math.inf
        self._latencies: list[float] = []
        self.held_up = 0.0  # the longest time that a step came too late [s]

    def send(self, command: dict[str, Any], now: float) -> None:
        """A command sets off for its robot."""
        self._to_robots.send(command, now, self.faults)

    def hear(self, now: float) -> None:
        """The robots obey what has arrived."""
        for command in self._to_robots.arrived(now):
            number = int(command["robot"])
            if 1 <= number <= len(self.robots) and number not in (self.faults.dead, self.faults.deaf):
                self.robots[number - 1].hear(command, now)
                if "at" in command and len(self._latencies) < _MOST_LATENCIES:
                    self._latencies.append(now - float(command["at"]))
        for robot in self.robots:
            if robot.number == self.faults.dead:
                robot.halt(now)
            elif self.faults.watchdog and robot.number != self.faults.deaf:
                robot.watch(now)

    def step(self) -> None:
        """Passes one step of the physics."""
        self._now += STEP
        self._enki.step(STEP, 3)
        self._steps += 1
        self._judge()
        if self._steps % REPORT_EVERY == 0:
            for robot in self.robots:
                self._report(robot)

    @property
    def due(self) -> float:
        """When the next step is due [s]."""
        return self._now + STEP

    def reports(self, now: float) -> list[dict[str, Any]]:
        """What has arrived from the robots."""
        return self._from_robots.arrived(now)

    def next_arrival(self) -> float:
        """When something arrives at either end [s]."""
        return min(self._to_robots.next_arrival(), self._from_robots.next_arrival())

    def judgement(self) -> dict[str, Any]:
        """What the plant itself saw since the start.

        `contacts`: times that bodies came to touch; `least_robots_m` and `least_obstacles_m`: least gap between bodies;
        `stood_since_s`: when the last wheel came to stand, null while one turns; `each_stood_since_s`: the same of each
        robot; `latencies_s`: from sending a command until the wheels have it; `poses`; `held_up_s`: by how much a step
        of the physics was late at most, for then the watchdogs of the robots are late too.
        """
        stood = [robot.stood_since for robot in self.robots]
        return {
            "now": self._now,
            "contacts": self._contacts,
            "least_robots_m": _or_none(self._least_robots),
            "least_obstacles_m": _or_none(self._least_obstacles),
            "stood_since_s": _or_none(max(stood)),
            "each_stood_since_s": [_or_none(since) for since in stood],
            "latencies_s": self._latencies,
            "poses": [robot.pose for robot in self.robots],
            "held_up_s": self.held_up,
        }

    def _judge(self) -> None:
        places = [robot.pose[:2] for robot in self.robots]
        robots = obstacles = math.inf
        for i, (x, y) in enumerate(places):
            for other in places[:i]:
                robots = min(robots, math.dist((x, y), other) - 2.0 * self._radius)
            for ox, oy, radius in self._world.obstacles:
                obstacles = min(obstacles, math.dist((x, y), (ox, oy)) - radius - self._radius)
            walls = min(x, y, self._world.width - x, self._world.height - y) - self._radius
            obstacles = min(obstacles, walls)
        touching = min(robots, obstacles) < CONTACT
        self._contacts += touching and not self._touching
        self._touching = touching
        self._least_robots = min(self._least_robots, robots)
        self._least_obstacles = min(self._least_obstacles, obstacles)

    def _report(self, robot: Robot) -> None:
        faults, number = self.faults, robot.number
        if number == faults.dead:
            return
        x, y, heading = robot.pose
        angle, length = self._draw.uniform(-math.pi, math.pi), faults.noise_m * math.sqrt(self._draw.random())
        x, y = x + length * math.cos(angle), y + length * math.sin(angle)
        told: dict[str, Any] = {"robot": number, "id": f"e-puck {number}", "n": robot.acknowledged}
        if not faults.blind:
            bad = math.nan if number == faults.nan else _JUMP if number == faults.jump else 0.0
            told |= {"t": self._now + _AHEAD * (number == faults.future), "x": x + bad, "y": y, "theta": heading}
        self._from_robots.send(told, self._now, faults)
        if number == faults.twin:
            elsewhere = {"id": "e-puck of another", "x": self._world.width - x, "y": self._world.height - y}
            self._from_robots.send(told | elsewhere, self._now, faults)


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None


class Lines:
    """The lines of the standard input, without waiting for them."""

    def __init__(self) -> None:
        """Nothing is read yet."""
        self._text, self.ended = b"", False

    def take(self) -> list[dict[str, Any]]:
        """What has come; `ended` once nothing can come any more."""
        while select.select([sys.stdin.fileno()], [], [], 0.0)[0]:
            read = sys.stdin.buffer.raw.read(65536)  # type: ignore[attr-defined]
            if not read:
                self.ended = True
                break
            self._text += read
        *whole, self._text = self._text.split(b"\n")
        return [json.loads(line) for line in whole]


def tell(message: dict[str, Any]) -> None:
    """Prints a line."""
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


def controlled(plant: Plant, line: dict[str, Any]) -> None:
    """Follows a line that changes faults or asks for the judgement."""
    if "faults" in line:
        plant.faults = replace(plant.faults, **line["faults"])
    if "judge" in line:
        tell(plant.judgement())


def live(world: World, faults: Faults) -> None:
    """Robots in real time, behind one UDP port of the loopback; they report to whoever has sent the last datagram."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as port:
        port.bind(("127.0.0.1", 0))
        port.setblocking(False)
        plant, lines, peer = Plant(world, faults, time.monotonic()), Lines(), None
        tell({"port": port.getsockname()[1]})
        while not lines.ended:
            rest = min(plant.due, plant.next_arrival()) - time.monotonic()
            select.select([port, sys.stdin.fileno()], [], [], max(rest, 0.0))
            for line in lines.take():
                controlled(plant, line)
            peer = receive(port, plant) or peer
            now = time.monotonic()
            plant.hear(now)
            plant.held_up = max(plant.held_up, now - plant.due)
            while plant.due <= now:
                plant.step()
            for report in plant.reports(now):
                if peer is not None:
                    _send(port, report, peer)


def receive(port: socket.socket, plant: Plant) -> Any:
    """Takes what has come; returns who sent the last of it."""
    peer = None
    while True:
        try:
            text, peer = port.recvfrom(65536)
            plant.send(json.loads(text), time.monotonic())
        except BlockingIOError:
            return peer
        except (OSError, ValueError):  # who was reported to is gone, or sent no JSON
            continue


def _send(port: socket.socket, report: dict[str, Any], peer: Any) -> None:
    try:
        port.sendto(json.dumps(report).encode(), peer)
    except OSError:  # it is gone: a robot tells it the next time
        return


def lockstep(world: World, faults: Faults) -> None:
    """Robots whose time passes as they are told."""
    plant: Plant | None = None
    for text in sys.stdin:
        line = json.loads(text)
        if "now" in line:
            now = float(line["now"])
            plant = plant or Plant(world, faults, now)
            while plant.due <= now + 1e-9:
                plant.hear(plant.due)
                plant.step()
            for command in line["commands"]:
                plant.send(command, now)
            tell({"reports": plant.reports(now)})
        elif plant is not None:
            controlled(plant, line)


def main() -> None:
    """Reads what to build, and runs it."""
    given: dict[str, Any] = json.loads(sys.stdin.buffer.raw.readline())  # type: ignore[attr-defined]
    run = {"udp": live, "lockstep": lockstep}[given["mode"]]
    run(World(**given["world"]), Faults(**given.get("faults", {})))


if __name__ == "__main__":
    main()
