"""The built-in channel of the console: its pages' pointer, keys, panels and edits, pushed by threads of the browser."""

import threading
from collections import deque
from collections.abc import Iterable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from higvf_console.core.awake import AwakeClock
from higvf_console.core.command import CONSOLE
from higvf_console.core.commands import Command, Cursor, EmergencyStop, OperatorCommand, Release, StrokePoints
from higvf_console.core.errors import InputError
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, InputSpec, OperatorContext
from higvf_console.core.reading.node import Node

CAPACITY = 4096  # commands that wait at most; a session polls some 50 times a second
_Stamped = TypeVar("_Stamped", bound=Command)
_POINTS = 16_384  # of a stroke that waits; beyond, every second point goes


class ConsoleChannel:
    """An `Interface` that is also a `PointerSink`.

    STOP does not queue: the newest one is kept apart and taken first, and what would reset it and waits is dropped. A
    full queue makes room by losing least first: all cursors but the newest, then the joints between stroke points
    (their points stay), then the oldest command. So the end of a stroke is lost only behind thousands of later
    commands.

    Attributes:
        capabilities: of a person's hand at the pages of the console.
    """

    capabilities = Capabilities(takes_pointer=True, self_acknowledging=True, draws_previewed=True, stale_after=2.0)

    def __init__(self, name: str = CONSOLE, capacity: int = CAPACITY) -> None:
        """Starts with an empty queue.

        Args:
            name: channel name.
            capacity: commands that wait at most.
        """
        self._name = name
        self._capacity = capacity
        self._waiting: deque[OperatorCommand] = deque()
        self._stop: deque[EmergencyStop] = deque(maxlen=1)
        self._lock = threading.Lock()
        self._given = 0  # commands so far
        self._last_used: float | None = None
        self._clock = AwakeClock()
        self._last_heartbeat: float | None = None  # [s] of that clock

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    def push(self, command: OperatorCommand) -> None:
        """Appends a command, from any thread; waits for nothing but another push or poll, and a STOP for nothing."""
        if isinstance(command, EmergencyStop):
            self._stop.append(command)
            return
        with self._lock:
            self._waiting.append(command)
            if len(self._waiting) > self._capacity:
                self._waiting = _make_room(self._waiting, self._capacity)

    def heartbeat(self) -> None:
        """A page is there; from the first time on, silence of all pages counts."""
        self._last_heartbeat = self._clock.now()

    def take_stop(self, context: OperatorContext) -> EmergencyStop | None:
        """The newest STOP that was pushed since the last call or poll."""
        try:
            stop = self._stop.popleft()
        except IndexError:
            return None
        with self._lock:
            self._waiting = deque(command for command in self._waiting if not isinstance(command, Release))
        self._last_used = context.time
        return self._stamped(stop, context)

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Everything pushed since the last poll, STOP first and the rest in order, given now."""
        stop = self.take_stop(context)
        with self._lock:
            taken, self._waiting = self._waiting, deque()
        if taken:
            self._last_used = context.time
        return ([] if stop is None else [stop]) + [self._stamped(command, context) for command in taken]

    def health(self, now: float) -> ChannelHealth:
        """Last seen when a page reported its presence; a console that nobody uses is no fault."""
        awake = self._clock.now()
        used = "not used yet" if self._last_used is None else f"last used {max(0.0, now - self._last_used):.0f} s ago"
        if self._last_heartbeat is not None:
            return ChannelHealth(ChannelState.LIVE, used, now - (awake - self._last_heartbeat))
        if self._last_used is None:
            return ChannelHealth(ChannelState.NEVER_SEEN, "nothing from the browser yet")
        return ChannelHealth(ChannelState.LIVE, used)

    def close(self) -> None:
        """Drops what still waits."""
        with self._lock:
            self._waiting.clear()
        self._stop.clear()

    def _stamped(self, command: _Stamped, context: OperatorContext) -> _Stamped:
        """The command as given now; by the operator whom it names, of several pages the one that gave it."""
        operator = context.operator if command.operator == Command.operator else command.operator
        sequence, self._given = self._given, self._given + 1
        return replace(command, time=context.time, source=self._name, operator=operator, sequence=sequence)


def open_console(spec: InputSpec) -> ConsoleChannel:
    """The built-in channel.

    Raises:
        InputError: it is given a file or an option, and has neither.
    """
    if spec.source:
        raise InputError(f"input {spec.channel}={spec.source}: the console's channel reads the browser, not a file")
    Node({**spec.settings, **spec.options}, f"input {spec.channel}", raises=InputError).section(())
    return ConsoleChannel(spec.channel)


def _make_room(commands: Iterable[OperatorCommand], capacity: int) -> deque[OperatorCommand]:
    kept = deque(_join_strokes(_newest_cursor(list(commands))))
    if len(kept) > capacity:
        kept.popleft()
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
