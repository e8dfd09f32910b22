"""The operator commands that edit the world and the tunables; `world.editing` gives them their meaning."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from higvf_console.core.arguments import one_of
from higvf_console.core.arrays import Floats
from higvf_console.core.command import Command


class EntityKind(StrEnum):
    """What stands in the arena and can be edited."""

    ROBOT = "robot"
    FIRE = "fire"
    CIRCLE = "circle"
    BAR = "bar"
    POLYGON = "polygon"


@dataclass(frozen=True)
class Edit(Command):
    """A command that edits what a run is made of, not what the operator asks of the team."""


@dataclass(frozen=True)
class AddEntity(Edit):
    """A new robot, fire, circle or bar of ordinary size at `point` (2,) [m]."""

    kind: str
    point: Floats

    def __post_init__(self) -> None:
        """Checks the word."""
        _known_kind(self)


@dataclass(frozen=True)
class AddOutlines(Edit):
    """New obstacles of any shape, each a closed chain of corners (n, 2) [m] that does not cross itself."""

    outlines: tuple[Floats, ...]


@dataclass(frozen=True)
class MoveEntity(Edit):
    """The entity of that kind and index (from 0) moves to `point` (2,) [m]: its centre, or an obstacle's middle."""

    kind: str
    index: int
    point: Floats

    def __post_init__(self) -> None:
        """Checks the word."""
        _known_kind(self)


@dataclass(frozen=True)
class ChangeEntity(Edit):
    """A number of the entity of that kind and index (from 0) becomes `value`; see `world.editing.entities`."""

    kind: str
    index: int
    name: str
    value: float

    def __post_init__(self) -> None:
        """Checks the word."""
        _known_kind(self)


@dataclass(frozen=True)
class DeleteEntity(Edit):
    """The entity of that kind and index (from 0) is removed; the numbers of those after it move up."""

    kind: str
    index: int

    def __post_init__(self) -> None:
        """Checks the word."""
        _known_kind(self)


@dataclass(frozen=True)
class ToggleLink(Edit):
    """Two robots (indices from 0) become linked, or cease to be; from then on the links are given, not by range."""

    first: int
    second: int


@dataclass(frozen=True)
class LinkByRange(Edit):
    """The communication range decides again who is linked."""


@dataclass(frozen=True)
class SetArena(Edit):
    """The arena becomes `sides` (4,) x_min, y_min, x_max, y_max [m], with or without walls."""

    sides: Floats
    walls: bool


@dataclass(frozen=True)
class SetParameters(Edit):
    """Tunables become other values, all or none.

    Attributes:
        values: by group and name of `control.params`, e.g. {"safety.robot_clearance": 30.0}.
    """

    values: Mapping[str, float]


def _known_kind(edit: AddEntity | MoveEntity | ChangeEntity | DeleteEntity) -> None:
    one_of(f"{type(edit).__name__}.kind", edit.kind, tuple(EntityKind))
