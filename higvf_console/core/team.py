"""The contract of a team of robots that the engine does not integrate itself: real ones, or a plant of another process.

    Team         hears velocities, tells where its robots are and what became of the commands
    PoseSource   tells where the robots are, where the team itself does not: an overhead camera, motion capture

Both are called once in each control period and answer at once: what waits for a network or a device has a thread of its
own and queues of bounded length. Times are those of the console's monotonic clock, which each call is given as `now`.
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from higvf_console.core.arrays import Floats
from higvf_console.core.errors import InputError
from higvf_console.core.quantity import quantities
from higvf_console.core.reading.node import Node
from higvf_console.core.viewport import Arena

Options = TypeVar("Options", bound=tuple[Any, ...])
VALID_FOR = 0.3  # for which a command drives a robot [s]; one that hears nothing longer than that must stand


class Poses(NamedTuple):
    """The newest pose of each of N robots.

    Attributes:
        position: (N, 2) centres of the bodies in the frame of the arena [m]; NaN = never seen.
        heading: (N,) counter-clockwise from the x axis [rad]; NaN = never seen, or unknown as of a robot without one.
        measured_at: (N,) when each was measured, on the clock of `now` [s]; NaN = never.
    """

    position: Floats
    heading: Floats
    measured_at: Floats


def never_seen(robots: int) -> Poses:
    """Poses of robots that nobody has seen yet."""
    return Poses(np.full((robots, 2), np.nan), np.full(robots, np.nan), np.full(robots, np.nan))


class Drive(NamedTuple):
    """What N robots shall do until the next command, at most `valid_for` seconds.

    Attributes:
        number: counts the commands, from 1.
        velocity: (N, 2) of the controlled points [m/s]; for robots that move any way.
        forward: (N,) speed along the heading [m/s]; for robots with a heading.
        turn: (N,) turn rate, counter-clockwise [rad/s].
        valid_for: after so long without another command a robot stands [s].
    """

    number: int
    velocity: Floats
    forward: Floats
    turn: Floats
    valid_for: float = VALID_FOR


def standing(robots: int, number: int) -> Drive:
    """The command to stand."""
    return Drive(number, np.zeros((robots, 2)), np.zeros(robots), np.zeros(robots))


class RobotLink(NamedTuple):
    """What a team knows of the link to one robot.

    Attributes:
        acknowledged: number of the latest command that the robot has confirmed; 0 = none yet, -1 = it confirms none.
        battery: charge in [0, 1]; NaN = unknown.
        connected: whether there is a link; a robot that tells nothing counts as connected.
        detail: what else a person should know, in a few words.
    """

    acknowledged: int = -1
    battery: float = math.nan
    connected: bool = True
    detail: str = ""


@dataclass(frozen=True)
class TeamSpec:
    """What a team or a source of poses is opened with.

    Attributes:
        name: of the entry point, e.g. "mqtt".
        address: of a broker, a network, a file; empty where none is needed.
        options: from the command line, `--team mqtt=mqtt://127.0.0.1:1883:prefix=lab` -> {"prefix": "lab"}.
        robots: how many the scenario has.
        arena: where they drive.
        start: (N, 2) where the scenario has the centres of their bodies at the start [m].
        headings: (N,) there [rad].
        look_ahead: distance of the controlled point from the centre [m]; 0 = robots that move any way.
        speed_limit: of the controlled points [m/s].
        body_radius: of a robot [m].
        period: control period [s].
    """

    name: str
    address: str = ""
    options: Mapping[str, str] = field(default_factory=lambda: {})
    robots: int = 1
    arena: Arena = field(default_factory=lambda: Arena(0.0, 0.0, 3.2, 2.0))
    start: Floats = field(default_factory=lambda: np.zeros((1, 2)))
    headings: Floats = field(default_factory=lambda: np.zeros(1))
    look_ahead: float = 0.0
    speed_limit: float = 1.0
    body_radius: float = 0.1
    period: float = 0.02

    @property
    def place(self) -> str:
        """How an error calls it."""
        return f"--team {self.name}={self.address}" if self.address else f"--team {self.name}"


def options_of(spec: TeamSpec, kind: type[Options]) -> Options:
    """The options of a team, checked.

    Args:
        spec: what it is opened with.
        kind: a NamedTuple; its fields are texts, annotated with a sentence, or numbers, annotated with a `Quantity`;
            all have a default.

    Raises:
        InputError: an option is unknown, no number, or out of range.
    """
    known, numbers = tuple(getattr(kind, "_fields")), quantities(kind)  # noqa: B009 (a tuple type has none for pyright)
    given: dict[str, Any] = {}
    for name, node in Node(dict(spec.options), spec.place, raises=InputError).section(known).items():
        given[name] = node.value
        if name in numbers:
            with suppress(TypeError, ValueError):
                node = node.__class__(float(node.value), node.source, node.place, node.raises)  # noqa: PLW2901
            given[name] = node.number(numbers[name])
    return kind(**given)


class Heard(NamedTuple):
    """A robot that a network shows.

    Attributes:
        name: as the network calls it.
        detail: what was heard of it, in a few words.
    """

    name: str
    detail: str


@runtime_checkable
class PoseSource(Protocol):
    """Tells where robots are. An entry point of `higvf_console.pose_sources` makes it of a `TeamSpec`."""

    @property
    def name(self) -> str:
        """That of its entry point."""
        ...

    def poses(self, now: float) -> Poses:
        """The newest pose of each robot; returns at once."""
        ...

    def close(self) -> None:
        """Ends it; returns within a second."""
        ...


class Picture(NamedTuple):
    """The ground as a camera sees it from straight above.

    Attributes:
        rgb: (rows, columns, 3) red, green, blue; row 0 is the top.
        extent: the ground that it covers.
        taken_at: when, on the clock of `now` [s].
    """

    rgb: NDArray[np.uint8]
    extent: Arena
    taken_at: float


@runtime_checkable
class PictureSource(Protocol):
    """A source of poses, or a team, that has a live picture of the arena besides."""

    def picture(self) -> Picture | None:
        """The newest one; None = there is none yet. Returns at once, also on another thread than `poses`."""
        ...


@runtime_checkable
class NoticeSource(Protocol):
    """A source of poses, or a team, that has something to tell people besides."""

    def notices(self) -> tuple[str, ...]:
        """What has happened since the last call, a sentence each; returns at once."""
        ...


@runtime_checkable
class Team(PoseSource, Protocol):
    """Robots that hear commands. An entry point of `higvf_console.teams` is a callable `(TeamSpec) -> Team`.

    An opener raises `InputError` where the address or an option cannot be used. A team stands until it hears a command,
    and again when the last one is older than its `valid_for`. What `higvf teams` shows besides the name comes from two
    attributes that an opener may have: `options`, the NamedTuple that it gives to `options_of`, and
    `heard(spec: TeamSpec, seconds: float) -> Sequence[Heard]`, the robots that its network shows in that time.
    """

    def drive(self, command: Drive, now: float) -> None:
        """Sends a command; it replaces the former one, and returns at once."""
        ...

    def stop(self, now: float) -> None:
        """Lets all robots stand, by the fastest way that there is; returns at once."""
        ...

    def links(self, now: float) -> tuple[RobotLink, ...]:
        """The link to each robot; returns at once."""
        ...
