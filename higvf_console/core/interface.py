"""The contracts that every operator interface stands on: what it is opened with, asked, and told."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import NamedTuple, Protocol

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.command import CONSOLE
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.errors import InputError
from higvf_console.core.viewport import Arena, Viewport

# Present names of channels by their former ones, which are still read in command lines, scenarios, scripts, recordings.
RENAMED_CHANNELS: Mapping[str, str] = MappingProxyType({"mouse": CONSOLE})


LINK_OPTIONS = ("latency", "jitter", "dropout")  # options of every channel: its emulated link


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
        seed: of the errors that the interface emulates, where the link of the channel has taken the option `seed`.
    """

    channel: str
    source: str = ""
    options: Mapping[str, str] = field(default_factory=lambda: {})
    settings: Mapping[str, object] = field(default_factory=lambda: {})
    arena: Arena = field(default_factory=lambda: Arena(0.0, 0.0, 1200.0, 700.0))
    robots: int | None = None
    seed: int = 0


@dataclass(frozen=True)
class Capabilities:
    """What a channel is to the session and to the console's pages, beside its commands.

    The defaults are those of a device or a replay that is only polled.

    Attributes:
        takes_pointer: whether it is a `PointerSink`: the pages' commands are pushed to the first channel that is one.
            Such a channel is live, never a replay.
        self_acknowledging: whether any of its commands but a cursor acknowledges that it is back after a loss, because
            a person gives them by hand.
        draws_previewed: whether the console ends its strokes, so that they are previewed with the path terms chosen
            there; the strokes of other channels are previewed as ordinary paths.
        stale_after: silence after which it is stale where the scenario gives no other [s].
    """

    takes_pointer: bool = False
    self_acknowledging: bool = False
    draws_previewed: bool = False
    stale_after: float = 1.0


class Interface(Protocol):
    """An operator's device, live or replayed. An entry point is a callable `(InputSpec) -> Interface`.

    It may also have an attribute `capabilities`, see `Capabilities`; without it, it has the defaults.
    """

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


def capabilities_of(interface: Interface) -> Capabilities:
    """The capabilities that an interface offers; the defaults where it offers none.

    Raises:
        InputError: what it offers is no `Capabilities`, or cannot be.
    """
    offered: object = getattr(interface, "capabilities", None)
    if offered is None:
        return Capabilities()
    place = f"interface '{interface.name}'"
    if not isinstance(offered, Capabilities):
        raise InputError(f"{place}: its capabilities are {offered!r:.60}, not a Capabilities of core.interface")
    missing = [method for method in ("push", "heartbeat") if not callable(getattr(interface, method, None))]
    if offered.takes_pointer and missing:
        raise InputError(f"{place}: takes_pointer, but it has no method {' and no method '.join(missing)}")
    if not 0.0 < offered.stale_after < math.inf:
        raise InputError(f"{place}: stale_after: {offered.stale_after!r} is not a time above 0 s")
    return offered


def current_channel(name: str) -> str:
    """The present name of a channel, of one that may be its former name."""
    return RENAMED_CHANNELS.get(name, name)


def renamed_channel(name: str) -> str:
    """A warning that gives the present name of a channel; empty where that is the name given."""
    return f"channel '{name}' is renamed; write '{RENAMED_CHANNELS[name]}'" if name in RENAMED_CHANNELS else ""
