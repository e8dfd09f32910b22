"""What a run starts from: arena, world, gains and the initial state."""

from enum import StrEnum
from typing import NamedTuple

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats
from higvf_console.core.state import SimState, World
from higvf_console.core.viewport import Arena


class Setup(NamedTuple):
    """A run before its first tick; made from a scenario file by `scenario.scenario`.

    Attributes:
        arena: what the operator sees.
        world: what does not move.
        params: all tunables.
        start: the state before the first tick.
        polygons: irregular obstacles, for views: closed chains (n, 2) [m], whose edges are the last of `world.bars`.
            A counter-clockwise one is an obstacle; a clockwise one is a free area that the one before it encloses.
    """

    arena: Arena
    world: World
    params: Parameters
    start: SimState
    polygons: tuple[Floats, ...] = ()


class Severity(StrEnum):
    """How much an event wants the operator's attention."""

    INFO = "info"
    GOOD = "good"
    WARNING = "warning"
    ALARM = "alarm"


class Event(NamedTuple):
    """Something that happened and that a person should read.

    Attributes:
        time: session time [s].
        severity: how loud.
        kind: machine-readable word, e.g. "extinguished", "target", "path", "infeasible", "refused".
        text: one sentence.
    """

    time: float
    severity: Severity
    kind: str
    text: str
