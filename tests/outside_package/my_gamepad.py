"""A gamepad from a file: each line is a time in seconds and a button, `1.5 A`."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from higvf_console.core.commands import EmergencyStop, NextTask, OperatorCommand, Pause, Resume
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelHealth, ChannelState, InputSpec, OperatorContext

BUTTONS = {"A": Pause(), "B": Resume(), "X": NextTask(), "Y": EmergencyStop()}


class Gamepad:
    """Presses of a file, on the session clock."""

    def __init__(self, name: str, presses: Sequence[tuple[float, str]]) -> None:
        """Starts before the first of `presses`, which are in order of time."""
        self.name = name
        self._presses = presses
        self._next, self._given, self._now = 0, 0, -math.inf

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """The presses that have fallen due; all of them again after a reset of the run."""
        if context.time < self._now:
            self._next = 0
        self._now = context.time
        given: list[OperatorCommand] = []
        while self._next < len(self._presses) and self._presses[self._next][0] <= context.time:
            time, button = self._presses[self._next]
            self._next += 1
            self._given += 1
            given.append(
                replace(BUTTONS[button], time=time, source=self.name, operator=context.operator, sequence=self._given)
            )
        return given

    def health(self, now: float) -> ChannelHealth:
        """Ended behind the last press."""
        state = ChannelState.ENDED if self._next == len(self._presses) else ChannelState.LIVE
        return ChannelHealth(state, f"{self._next} of {len(self._presses)} presses at {now:.1f} s")

    def close(self) -> None:
        """Has nothing to let go of."""


def open_gamepad(spec: InputSpec) -> Gamepad:
    """Entry point `gamepad`.

    Raises:
        InputError: the file is missing, or a line of it is no press; the message names line and buttons.
    """
    try:
        lines = Path(spec.source).read_text(encoding="utf-8").splitlines()
    except OSError as problem:
        raise InputError(f"{spec.source}: cannot be read: {problem.strerror}") from problem
    return Gamepad(
        spec.channel, sorted(_press(spec.source, k, line) for k, line in enumerate(lines, 1) if line.strip())
    )


def _press(source: str, number: int, line: str) -> tuple[float, str]:
    time, _, button = line.strip().partition(" ")
    try:
        seconds = float(time)
    except ValueError:
        seconds = math.nan
    if not math.isfinite(seconds) or button not in BUTTONS:
        raise InputError(f"{source}, line {number}: {line!r} is not SECONDS BUTTON with one of {', '.join(BUTTONS)}")
    return seconds, button
