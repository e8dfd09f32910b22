"""The contracts that every operator interface stands on: what it is opened with, asked, and told."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple, Protocol

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.viewport import Arena, Viewport


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
        last_seen: session time of a live device's last sign of life [s], judged by the session's limits; None where the
            interface judges itself, as a replay does: silence alone does not mean loss.
    """

    state: ChannelState
    detail: str
    last_seen: float | None = None


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

    def heartbeat(self) -> None:
        """A page has told that it is there; callable from any thread."""
        ...
