"""The browser's mouse and keyboard: threads of the browser push commands, the session polls them."""

import threading
from collections import deque
from collections.abc import Iterable
from dataclasses import replace
from time import monotonic

import numpy as np

from higvf_console.core.commands import Command, Cursor, EmergencyStop, OperatorCommand, StrokePoints
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelHealth, ChannelState, InputSpec, OperatorContext
from higvf_interfaces.fields import option_fields
from higvf_interfaces.streams import Stamp

CAPACITY = 4096  # commands that wait at most; a session polls some 50 times a second
_POINTS = 16_384  # of a stroke that waits; beyond, every second point goes


class Mouse:
    """An `Interface` that is also a `PointerSink`.

    A full queue makes room by losing least first: all cursors but the newest, then the joints between stroke points
    (their points stay), then the oldest command that is not the newest `EmergencyStop`. So a STOP is never lost, and
    the end of a stroke only behind thousands of later commands.
    """

    def __init__(self, name: str = "mouse", capacity: int = CAPACITY) -> None:
        """Starts with an empty queue.

        Args:
            name: channel name.
            capacity: commands that wait at most.
        """
        self._name = name
        self._capacity = capacity
        self._waiting: deque[OperatorCommand] = deque()
        self._lock = threading.Lock()
        self._stamp = Stamp(name)
        self._last_used: float | None = None
        self._last_heartbeat: float | None = None  # [s] of the wall clock

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

    def heartbeat(self) -> None:
        """A page is there; from the first time on, silence of all pages counts."""
        self._last_heartbeat = monotonic()

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Everything pushed since the last poll, in order, given now."""
        with self._lock:
            taken, self._waiting = self._waiting, deque()
        if taken:
            self._last_used = context.time
        return [self._stamp(command, context.time, _by(command, context)) for command in taken]

    def health(self, now: float) -> ChannelHealth:
        """Heard when a page last told that it is there; a hand off the mouse is no fault."""
        used = "not used yet" if self._last_used is None else f"last used {max(0.0, now - self._last_used):.0f} s ago"
        if self._last_heartbeat is not None:
            return ChannelHealth(ChannelState.LIVE, used, now - (monotonic() - self._last_heartbeat))
        if self._last_used is None:
            return ChannelHealth(ChannelState.NEVER_SEEN, "nothing from the browser yet")
        return ChannelHealth(ChannelState.LIVE, used)

    def close(self) -> None:
        """Drops what still waits."""
        with self._lock:
            self._waiting.clear()


def open_mouse(spec: InputSpec) -> Mouse:
    """Entry point `mouse`; it has no options."""
    option_fields(spec, ())
    if spec.source:
        raise InputError(f"input {spec.channel}={spec.source}: the mouse is the browser's and reads no file")
    return Mouse(spec.channel)


def _by(command: OperatorCommand, context: OperatorContext) -> OperatorContext:
    """The context with the operator whom a command names already: of several pages, the one that gave it."""
    return context if command.operator == Command.operator else context._replace(operator=command.operator)


def _make_room(commands: Iterable[OperatorCommand], capacity: int) -> deque[OperatorCommand]:
    kept = deque(_join_strokes(_newest_cursor(list(commands))))
    if len(kept) > capacity:
        newest_stop = max(
            (index for index, command in enumerate(kept) if isinstance(command, EmergencyStop)), default=-1
        )
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
