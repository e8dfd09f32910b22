"""A script of operator actions as an interface: the way to repeat a run, and to test adapter and controller alike."""

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.commands import OperatorCommand, Pick, Prioritise, ResetRun, StrokeBegin, StrokePoints
from higvf_console.core.edits import AddEntity, EntityKind
from higvf_console.core.errors import InputError, ScriptError
from higvf_console.core.interface import LINK_OPTIONS, ChannelHealth, ChannelState, InputSpec, OperatorContext
from higvf_interfaces.paths import named
from higvf_interfaces.scripts.file import Script, Stroke, read_script
from higvf_interfaces.streams import CLOCK_GRAIN, RunClock, Stamp


class ScriptPlayer:
    """Plays a script on the session clock: each entry fires once in a run, in file order where times agree.

    Attributes:
        warnings: what the script says under a former name.
    """

    def __init__(self, name: str, script: Script) -> None:
        """Starts with no entry fired."""
        self._name = name
        self._entries, self.warnings = script
        self._stamp = Stamp(name)
        self._clock = RunClock()
        self._resets: set[int] = set()
        self._forget()

    @property
    def name(self) -> str:
        """Channel name, shown in the status line."""
        return self._name

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        """Commands that have fallen due, in order of time."""
        if self._clock.was_reset(context.time):
            self._forget()
        given: list[OperatorCommand] = []
        for due, index in self._due(context):
            given += self._drawn_until(due, context)
            given += self._fire(index, due, context)
        return given + self._drawn_until(self._clock.now + CLOCK_GRAIN, context)

    def health(self, now: float) -> ChannelHealth:  # noqa: ARG002 - a script cannot fall silent
        """How many entries have fired; ended after the last."""
        detail = f"{len(self._fired)} of {len(self._entries)} actions done"
        done = len(self._fired) == len(self._entries) and not self._growing
        return ChannelHealth(ChannelState.ENDED if done else ChannelState.LIVE, detail)

    def close(self) -> None:
        """Has nothing to let go of: the file was closed after reading."""

    def _forget(self) -> None:
        """Starts like new, because the run has; a restart that the script itself gave is not given again."""
        self._fired: set[int] = set(self._resets)
        self._event_times: dict[int, float] = {}
        self._growing: list[tuple[float, OperatorCommand]] = []

    def _due(self, context: OperatorContext) -> list[tuple[float, int]]:
        """(time, entry) of what fires now, in order."""
        due: list[tuple[float, int]] = []
        for index, entry in enumerate(self._entries):
            if index in self._fired:
                continue
            if index not in self._event_times:
                met = entry.trigger.met(self._clock.now, context.extinguished)
                if met is None:
                    continue
                self._event_times[index] = met + entry.trigger.after
            if self._event_times[index] <= self._clock.now + CLOCK_GRAIN:
                due.append((self._event_times[index], index))
        return sorted(due)

    def _fire(self, index: int, due: float, context: OperatorContext) -> list[OperatorCommand]:
        self._fired.add(index)
        action = self._entries[index].action
        if isinstance(action, ResetRun):
            self._resets.add(index)
        if not isinstance(action, Stroke):
            return [self._stamp(action, due, context)]
        self._growing = _schedule(action, due)
        return self._drawn_until(due, context)

    def _drawn_until(self, time: float, context: OperatorContext) -> list[OperatorCommand]:
        """What the growing stroke has given by `time`; a new stroke takes the place of an unfinished one."""
        ready = [item for item in self._growing if item[0] <= time]
        self._growing = self._growing[len(ready) :]
        return [self._stamp(command, due, context) for due, command in ready]


def open_script(spec: InputSpec) -> ScriptPlayer:
    """Entry point `script`; it has no options of its own.

    Raises:
        ScriptError: the script cannot be used, or names a robot that the team does not have.
        InputError: an option is given.
    """
    if given := [*spec.options, *spec.settings]:
        raise InputError(
            f"input {spec.channel}={spec.source}: a script has no option {given[0]!r}; options of every channel: "
            f"{', '.join(LINK_OPTIONS)}, seed"
        )
    script = read_script(named(spec.source))
    actions = [entry.action for entry in script.entries]
    added = sum(isinstance(action, AddEntity) and action.kind == EntityKind.ROBOT for action in actions)
    for entry in script.entries:
        robot = _robot(entry.action)
        if robot is not None and spec.robots is not None and robot >= spec.robots + added:
            raise ScriptError(f"{entry.place}: robot: there is no robot {robot + 1}; give 1 to {spec.robots + added}")
    return ScriptPlayer(spec.channel, script)


def _robot(action: Stroke | OperatorCommand) -> int | None:
    """Index of the robot that an action is for, where it names one."""
    if isinstance(action, Stroke):
        return action.end.robot
    return action.robot if isinstance(action, Pick | Prioritise) else None


def _schedule(stroke: Stroke, start: float) -> list[tuple[float, OperatorCommand]]:
    """A stroke's commands and their times, the points evenly over its duration."""
    end = start + stroke.duration
    begin = (start, StrokeBegin())
    close = (end, stroke.end)
    if stroke.duration == 0:
        return [begin, (start, StrokePoints(stroke.points)), close]
    times = np.linspace(start, end, len(stroke.points))
    points = zip(times.tolist(), stroke.points, strict=True)
    return [begin, *((time, StrokePoints(floats(point, 1, 2))) for time, point in points), close]
