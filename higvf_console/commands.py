"""The closed list of operator commands, and the contracts that every interface stands on.

Whatever the device, its wishes arrive as these commands; nothing else changes the intent of a run. A command is data:
`sim.operator.apply_command` gives it its meaning (Freeze, Step, SetSpeed, Acknowledge and InjectFault: the session).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple, Protocol, TypeAlias

from higvf_console.arrays import Floats, floats
from higvf_console.viewport import Arena, Viewport


@dataclass(frozen=True, kw_only=True)
class Command:
    """What every command carries.

    Attributes:
        time: session time when it was given [s].
        source: name of the interface that gave it.
        operator: who gave it.
        sequence: count of commands of this source.
        confidence: of the decoder in [0, 1]; None where nothing was decoded.
    """

    time: float = 0.0
    source: str = "mouse"
    operator: str = "operator"
    sequence: int = 0
    confidence: float | None = None


@dataclass(frozen=True)
class StrokeBegin(Command):
    """A stroke starts; whatever was being drawn is dropped."""


@dataclass(frozen=True)
class StrokePoints(Command):
    """The stroke grows by `points` (n, 2) [m]."""

    points: Floats


@dataclass(frozen=True)
class StrokeEnd(Command):
    """The stroke is complete and becomes the desired path.

    Attributes:
        smoothing: standard deviation by which the path may leave the points [m]; None = the scenario's.
        robot: index of the robot that shall feel it; None = the one that is influenced now.
        preview: the path waits for a Confirm; nothing moves along it before.
    """

    smoothing: float | None = None
    robot: int | None = None
    preview: bool = False


@dataclass(frozen=True)
class StrokeCancel(Command):
    """The growing stroke is thrown away; the path in force stays."""


@dataclass(frozen=True)
class Cursor(Command):
    """Where the operator looks or points: `point` (2,) [m]; NaN when the device lost it."""

    point: Floats


@dataclass(frozen=True)
class Clutch(Command):
    """The operator holds (or lets go) the clutch that lets gaze draw."""

    closed: bool


@dataclass(frozen=True)
class Pick(Command):
    """Robot `robot` (index from 0) is the influenced one from now on; the path is kept."""

    robot: int


@dataclass(frozen=True)
class ProposePick(Command):
    """A decoder is unsure whether robot `robot` (index from 0) was asked for: it waits for a Confirm.

    Attributes:
        robot: as in `Pick`.
        within: how long it waits [s].
    """

    robot: int
    within: float = 5.0


@dataclass(frozen=True)
class Confirm(Command):
    """What waits becomes real: the proposed robot is picked, the pending path is followed from where it is then."""


@dataclass(frozen=True)
class Discard(Command):
    """What waits is dropped: the pending path and the proposed robot."""


@dataclass(frozen=True)
class Pause(Command):
    """Robots hold and still yield; the world goes on."""


@dataclass(frozen=True)
class Resume(Command):
    """Ends a pause."""


@dataclass(frozen=True)
class Stop(Command):
    """All velocities zero, latched until it is reset in two steps."""


@dataclass(frozen=True)
class AskReset(Command):
    """First step out of a latched STOP."""


@dataclass(frozen=True)
class ResetStop(Command):
    """Second step out of a latched STOP; the team stays paused until Resume."""


@dataclass(frozen=True)
class ClearPath(Command):
    """The human intention ends; the path is removed."""


@dataclass(frozen=True)
class ReversePath(Command):
    """The path is followed the other way round."""


@dataclass(frozen=True)
class NextTask(Command):
    """The human intention counts as finished; the team goes on with its own task."""


@dataclass(frozen=True)
class ResetRun(Command):
    """The run starts again from the scenario's initial state."""


@dataclass(frozen=True)
class Freeze(Command):
    """The simulation clock stands (`frozen`) or runs."""

    frozen: bool


@dataclass(frozen=True)
class Step(Command):
    """One control period while the clock stands."""


@dataclass(frozen=True)
class SetSpeed(Command):
    """The simulation clock runs at `factor` times real time."""

    factor: float


@dataclass(frozen=True)
class Acknowledge(Command):
    """The operator has seen that lost channels are back: their commands count again.

    Attributes:
        channel: which one; empty = all.
    """

    channel: str = ""


class FaultKind(StrEnum):
    """What a channel can be made to suffer."""

    FREEZE = "freeze"  # nothing comes; what was said meanwhile comes all at once when the fault ends
    DROP = "drop"  # nothing comes, and what was said is lost
    DELAY = "delay"  # everything comes late


@dataclass(frozen=True)
class InjectFault(Command):
    """A channel fails on purpose, for a test or a lesson.

    Attributes:
        channel: which one.
        kind: a `FaultKind`, or its word.
        seconds: how long the fault lasts [s].
        delay: of everything that comes, with `FaultKind.DELAY` [s].
    """

    channel: str
    kind: str = FaultKind.FREEZE
    seconds: float = 3.0
    delay: float = 0.5


OperatorCommand: TypeAlias = (
    StrokeBegin | StrokePoints | StrokeEnd | StrokeCancel | Cursor | Clutch | Pick | ProposePick | Confirm | Discard
    | Pause | Resume | Stop | AskReset | ResetStop | ClearPath | ReversePath | NextTask | ResetRun | Freeze | Step
    | SetSpeed | Acknowledge | InjectFault
)  # fmt: skip


class Targets(NamedTuple):
    """What there is to look at now; arrays of the state, not to be written.

    Attributes:
        fires: (M, 2) where the fires are [m], those that are out included.
        fire_radius: (M,) [m].
        robots: (N, 2) where the robots are [m].
    """

    fires: Floats
    fire_radius: Floats
    robots: Floats


NO_TARGETS = Targets(floats([], 0, 2), floats([]), floats([], 0, 2))


class OperatorContext(NamedTuple):
    """What an interface may know when it is polled.

    Attributes:
        time: session time [s].
        operator: who operates.
        viewport: how the operator's screen lies over the arena; None until a browser has told.
        clutch: whether the drawing clutch is held.
        paused: whether the team is paused.
        influenced: index of the influenced robot.
        extinguished: fire indices, in the order in which they went out.
        robots: how many there are.
        targets: what there is to look at.
    """

    time: float
    operator: str
    viewport: Viewport | None
    clutch: bool
    paused: bool
    influenced: int
    extinguished: tuple[int, ...]
    robots: int
    targets: Targets = NO_TARGETS


class ChannelState(StrEnum):
    """How a channel is; a quiet device is not a dead one."""

    NEVER_SEEN = "never seen"
    LIVE = "live"
    STALE = "stale"
    LOST = "lost"
    RECOVERED = "back, not resumed"  # heard again after a loss; waits for the operator's acknowledgement
    ENDED = "ended"  # a replayed log is at its end


class ChannelHealth(NamedTuple):
    """How a channel is, in one word and one sentence.

    Attributes:
        state: as the interface sees it.
        detail: why.
        heard: session time of a live device's last sign of life, by which the session's limits judge it [s]; None where
            the interface's own word holds, as with a replay, which may be quiet and is not dead.
    """

    state: ChannelState
    detail: str
    heard: float | None = None


@dataclass(frozen=True)
class InputSpec:
    """What an interface is opened with.

    Attributes:
        channel: entry-point name, e.g. "gaze".
        source: file or stream address; empty for a device that needs none.
        options: from the command line, `--input gaze=FILE:frame=screen` -> {"frame": "screen"}.
        settings: the scenario's `inputs: {gaze: ...}` section.
        arena: the arena that the input is to steer in.
        robots: how many the team has; None = not known yet.
    """

    channel: str
    source: str = ""
    options: Mapping[str, str] = field(default_factory=lambda: {})
    settings: Mapping[str, object] = field(default_factory=lambda: {})
    arena: Arena = field(default_factory=lambda: Arena(0.0, 0.0, 1200.0, 700.0))
    robots: int | None = None


class Interface(Protocol):
    """An operator's device, live or replayed. An entry point is a callable `(InputSpec) -> Interface`."""

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        ...

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        """Commands that are due by `context.time`, in order; returns at once."""
        ...

    def health(self, now: float) -> ChannelHealth:
        """How the channel is at session time `now` [s]."""
        ...

    def close(self) -> None:
        """Lets go of files, threads and devices; may be called twice."""
        ...


class PointerSink(Protocol):
    """Where the browser's threads leave commands; the session takes them at its next poll."""

    def push(self, command: OperatorCommand) -> None:
        """Appends a command; never waits, callable from any thread."""
        ...

    def beat(self) -> None:
        """A page has told that it is there; callable from any thread."""
        ...
