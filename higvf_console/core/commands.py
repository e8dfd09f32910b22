"""The closed list of operator commands; `interface` has the contract of those who give them.

Whatever the device, its wishes arrive as these commands; nothing else changes the intent of a run. A command is data:
`operator.reducer.apply_command` gives it its meaning (StartRun, ContinueRun, Freeze, Step, SetSpeed, Acknowledge,
InjectFault, LoadScenario, Undo, Redo, HandOver and the commands of `edits`: the session). A word that is none of those
known is an `ArgumentError` where the command is made.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from higvf_console.core.arguments import one_of
from higvf_console.core.arrays import Floats
from higvf_console.core.command import Command
from higvf_console.core.edits import (
    AddEntity,
    AddOutlines,
    ChangeEntity,
    DeleteEntity,
    LinkByRange,
    MoveEntity,
    SetArena,
    SetParameters,
    ToggleLink,
)
from higvf_console.core.state import PathEnding

PATH_ENDINGS = tuple(ending.name.lower() for ending in PathEnding)  # as people write them


class StrokeUse(StrEnum):
    """What a stroke is drawn for."""

    PATH = "path"  # the new desired path
    REDRAW = "redraw"  # the part of the desired path between the stroke's ends is drawn anew
    PRIORITY = "priority"  # the fires inside the stroke matter more to the robot that is influenced
    OBSTACLE = "obstacle"  # the outline of a new obstacle


@dataclass(frozen=True)
class StrokeBegin(Command):
    """A stroke starts; whatever was being drawn is dropped."""


@dataclass(frozen=True)
class StrokePoints(Command):
    """The stroke grows by `points` (n, 2) [m]."""

    points: Floats


@dataclass(frozen=True)
class StrokeEnd(Command):
    """The stroke is complete: it becomes the desired path, or what `use` says.

    Attributes:
        smoothing: standard deviation by which the path may leave the points [m]; None = the scenario's.
        robot: index of the robot that shall feel it; None = the one that is influenced now.
        preview: the path, new or redrawn, waits for a Confirm; nothing moves along it before.
        use: a `StrokeUse`, or its word.
        ending: of a new path, see `path_terms.PathTerms`.
        pace: likewise.
        duration: likewise [s].
    """

    smoothing: float | None = None
    robot: int | None = None
    preview: bool = False
    use: str = "path"
    ending: str = "release"
    pace: float = 1.0
    duration: float = 0.0

    def __post_init__(self) -> None:
        """Checks the words."""
        one_of("StrokeEnd.use", self.use, tuple(StrokeUse))
        one_of("StrokeEnd.ending", self.ending, PATH_ENDINGS)


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
    """What waits is dropped: the pending path and the proposed robot.

    Attributes:
        proposal: whether the robot too; else the path alone.
    """

    proposal: bool = True


@dataclass(frozen=True)
class Pause(Command):
    """Robots hold and still yield; the world goes on."""


@dataclass(frozen=True)
class Resume(Command):
    """Ends a pause."""


@dataclass(frozen=True)
class EmergencyStop(Command):
    """All velocities zero, latched until it is reset in two steps."""


@dataclass(frozen=True)
class AskReset(Command):
    """First step out of a latched STOP."""


@dataclass(frozen=True)
class ResetEmergencyStop(Command):
    """Second step out of a latched STOP; the team stays paused until Resume."""


@dataclass(frozen=True)
class AskArm(Command):
    """First step towards a team that drives: every robot is tried, and must stand when it hears nothing more."""


@dataclass(frozen=True)
class Arm(Command):
    """Second step: the team may drive."""


@dataclass(frozen=True)
class Disarm(Command):
    """The team stands, and may not drive before it is armed again."""


@dataclass(frozen=True)
class StopRobot(Command):
    """Robot `robot` (index from 0) of a team stands until it is released; the others keep clear of it."""

    robot: int


@dataclass(frozen=True)
class ReleaseRobot(Command):
    """Robot `robot` (index from 0) may drive with the team again."""

    robot: int


@dataclass(frozen=True)
class ClearPath(Command):
    """End the human intention and remove the path."""


@dataclass(frozen=True)
class ReversePath(Command):
    """Reverse the pending path or, if none is pending, the active one."""


@dataclass(frozen=True)
class ShapePath(Command):
    """Change how the pending path or, if none is pending, the active one is followed; None leaves a term unchanged.

    Attributes:
        ending: see `path_terms.PathTerms`.
        pace: likewise.
        duration: how long it is followed from now on [s]; 0 = as long as it takes.
        closed: whether its end is joined to its start.
    """

    ending: str | None = None
    pace: float | None = None
    duration: float | None = None
    closed: bool | None = None

    def __post_init__(self) -> None:
        """Checks the word."""
        if self.ending is not None:
            one_of("ShapePath.ending", self.ending, PATH_ENDINGS)


@dataclass(frozen=True)
class MovePathPoint(Command):
    """Move a point of the pending path or, if none is pending, of the active one; the path bends smoothly there.

    Attributes:
        grip: (2,) where the path is gripped: its nearest point [m].
        point: (2,) where that goes [m].
        preview: whether the changed path is pending until a Confirm.
    """

    grip: Floats
    point: Floats
    preview: bool = False


@dataclass(frozen=True)
class TakeUpPath(Command):
    """Path `number` (index from 0) of those drawn so far is followed again."""

    number: int


@dataclass(frozen=True)
class ForgetPath(Command):
    """Path `number` (index from 0) of those drawn so far leaves the list."""

    number: int


@dataclass(frozen=True)
class Prioritise(Command):
    """Robot `robot` (index from 0; None = the influenced one) values `fires` more, and no others.

    Attributes:
        fires: indices from 0; empty = it chooses by itself again.
        robot: which one.
        factor: by how much; None = `perception.priority`.
    """

    fires: tuple[int, ...] = ()
    robot: int | None = None
    factor: float | None = None


@dataclass(frozen=True)
class NextTask(Command):
    """The human intention counts as finished; the team goes on with its own task."""


@dataclass(frozen=True)
class StartRun(Command):
    """The clock of a run that waits for it begins to run."""


@dataclass(frozen=True)
class ContinueRun(Command):
    """A run that has ended goes on, without another end."""


@dataclass(frozen=True)
class ResetRun(Command):
    """The run starts again from the scenario's initial state; one that waits for a StartRun goes on waiting."""


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


@dataclass(frozen=True)
class LoadScenario(Command):
    """A run of another scenario begins.

    Attributes:
        text: of its file.
        name: of its file.
        polygons: what its polygons and masks came to when they were read before; None = read them.
        waits: whether the run waits for a StartRun.
    """

    text: str
    name: str
    polygons: tuple[Floats, ...] | None = None
    waits: bool = False


@dataclass(frozen=True)
class Undo(Command):
    """Undo the latest action that is not undone yet."""


@dataclass(frozen=True)
class Redo(Command):
    """What was undone last is done again."""


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

    def __post_init__(self) -> None:
        """Checks the word."""
        one_of("InjectFault.kind", self.kind, tuple(FaultKind))


class ControlChange(StrEnum):
    """What becomes of control, which one page of the console has at a time."""

    FIRST = "first"  # nobody had it
    ASKED = "asked"
    REFUSED = "refused"
    GRANTED = "granted"
    TAKEN = "taken"
    RELEASED = "released"
    LOST = "lost"  # its holder timed out


@dataclass(frozen=True)
class HandOver(Command):
    """Control passes from page to page, or is asked for; `operator` is the page that did it, or that was lost.

    Attributes:
        page: name of the page that has control from now on, that asks or is refused; empty = nobody has it.
        how: a `ControlChange`, or its word.
    """

    page: str
    how: str

    def __post_init__(self) -> None:
        """Checks the word."""
        one_of("HandOver.how", self.how, tuple(ControlChange))


OperatorCommand: TypeAlias = (
    StrokeBegin | StrokePoints | StrokeEnd | StrokeCancel | Cursor | Clutch | Pick | ProposePick | Confirm
    | Discard | Pause | Resume | EmergencyStop | AskReset | ResetEmergencyStop | ClearPath | ReversePath
    | ShapePath | MovePathPoint | TakeUpPath | ForgetPath | Prioritise | NextTask | StartRun | ContinueRun
    | ResetRun | Freeze | Step | SetSpeed | Acknowledge | InjectFault | LoadScenario | Undo | Redo | AddEntity
    | AddOutlines | MoveEntity | ChangeEntity | DeleteEntity | ToggleLink | LinkByRange | SetArena
    | SetParameters | HandOver | AskArm | Arm | Disarm | StopRobot | ReleaseRobot
)  # fmt: skip

TeamCommand: TypeAlias = AskArm | Arm | Disarm | StopRobot | ReleaseRobot
Release: TypeAlias = AskReset | ResetEmergencyStop | Resume  # what lets a stopped team move again
