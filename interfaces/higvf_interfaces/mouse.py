"""The browser's mouse and keyboard: threads of the browser push commands, the session polls them."""

import threading
from collections import deque
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from higvf_console.commands import (
    ChannelHealth,
    ChannelState,
    Cursor,
    InputSpec,
    OperatorCommand,
    OperatorContext,
    Stop,
    StrokePoints,
)
from higvf_interfaces.fields import option_fields
from higvf_interfaces.streams import Stamp

CAPACITY = 4096  # commands that wait at most; a session polls some 50 times a second
_POINTS = 16_384  # of a stroke that waits; beyond, every second point goes


class Mouse:
    """An `Interface` that is also a `PointerSink`.

    A full queue makes room by losing least first: all cursors but the newest, then the joints between stroke points
    (their points stay), then the oldest command that is not the newest `Stop`. So a STOP is never lost, and the end of
    a stroke only behind thousands of later commands.
    """

    def __init__(self, name: str = "mouse", stale_after: float = 60.0, capacity: int = CAPACITY) -> None:
        """Starts with an empty queue.

        Args:
            name: channel name.
            stale_after: silence after which the channel is called stale [session s].
            capacity: commands that wait at most.
        """
        self._name = name
        self._stale_after = stale_after
        self._capacity = capacity
        self._waiting: deque[OperatorCommand] = deque()
        self._lock = threading.Lock()
        self._stamp = Stamp(name)
        self._last_seen: float | None = None

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    def push(self, command: OperatorCommand) -> None:
        """Appends a command, from any thread; waits for nothing but another push or poll."""
        with self._lock:
            self._waiting.append(command)
            if len(self._waiting) > self._capacity:
                self._waiting = _make_room(self._waiting, self._capacity)

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Everything pushed since the last poll, in order, given now."""
        with self._lock:
            taken, self._waiting = self._waiting, deque()
        if taken:
            self._last_seen = context.time
        return [self._stamp(command, context.time, context) for command in taken]

    def health(self, now: float) -> ChannelHealth:
        """Never seen, live, or stale after a long silence; a hand off the mouse is no fault."""
        if self._last_seen is None:
            return ChannelHealth(ChannelState.NEVER_SEEN, "nothing from the browser yet")
        quiet = max(0.0, now - self._last_seen)
        state = ChannelState.STALE if quiet > self._stale_after else ChannelState.LIVE
        return ChannelHealth(state, f"last used {quiet:.0f} s ago")

    def close(self) -> None:
        """Drops what still waits."""
        with self._lock:
            self._waiting.clear()


def open_mouse(spec: InputSpec) -> Mouse:
    """Entry point `mouse`; option `stale` [s]."""
    stale = option_fields(spec, ("stale",)).number("stale", 60.0, 0.1, 86_400.0, "s")
    return Mouse(spec.channel, stale)


def _make_room(commands: Iterable[OperatorCommand], capacity: int) -> deque[OperatorCommand]:
    kept = deque(_join_strokes(_newest_cursor(list(commands))))
    if len(kept) > capacity:
        newest_stop = max((index for index, command in enumerate(kept) if isinstance(command, Stop)), default=-1)
        del kept[1 if newest_stop == 0 else 0]
    return kept


def _newest_cursor(commands: list[OperatorCommand]) -> list[OperatorCommand]:
    newest = max((index for index, command in enumerate(commands) if isinstance(command, Cursor)), default=-1)
    return [c for index, c in enumerate(commands) if index == newest or not isinstance(c, Cursor)]


def _join_strokes(commands: list[OperatorCommand]) -> list[OperatorCommand]:
    joined: list[OperatorCommand] = []
    run: list[StrokePoints] = []
    for command in [*commands, None]:
        if isinstance(command, StrokePoints):
            run.append(command)
            continue
        if run:
            points = np.concatenate([part.points for part in run])
            joined.append(replace(run[0], points=points[:: 2 if len(points) > _POINTS else 1]))
            run = []
        if command is not None:
            joined.append(command)
    return joined
