"""What must hold in every control period, judged apart from the engine: distances by NumPy, not by its kernels.

    numbers     everything that moves is finite
    STOP        under a STOP nothing moves, and nothing but its reset in two steps ends it
    clearance   a robot that keeps its clearances goes on to keep them, or is flagged infeasible in the same control
                period; one that violates a clearance (after a STOP beside a fire, or an infeasible moment) comes no
                nearer, or is flagged
    commands    no command makes a team that keeps its clearances violate one

Robots are judged at their centres; what they owe is judged at their controlled points, whose clearances are larger, see
`sim.unicycle`. Under a STOP clearances are not judged: robots stand, whatever comes. While positions are measured with
errors, a robot that violates a clearance already is not judged: it leaves along a direction that it does not know.
"""

import math
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Bools, floats
from higvf_console.core.commands import OperatorCommand, Redo, ResetEmergencyStop, Undo
from higvf_console.core.state import Motion
from higvf_console.lab.safety.margins import ROUNDING, Margins, Measure
from higvf_console.runtime.history import RunState
from higvf_console.runtime.run import Run
from higvf_console.sim.unicycle import body_centres


class Broken(StrEnum):
    """What does not hold; the words of the report."""

    UNFLAGGED = "unflagged"  # a violation of a clearance that is not flagged infeasible in the same control period
    MISMATCH = "mismatches"  # a replay that differs from the run
    EXCEPTION = "exceptions"  # a command or a step that fails, or gives what is no number
    MOVED = "moved_under_stop"


class Failure(NamedTuple):
    """What does not hold, and a sentence about it."""

    broken: Broken
    text: str


class Watch:
    """Follows one run, from command to command and from step to step."""

    def __init__(self, run: Run) -> None:
        """Starts with the run as it is.

        Args:
            run: before its first command and step.
        """
        self._run = run
        self._measure = Measure(run.setup)
        self._owed: Margins | None = None  # of the controlled points as they are

    def commanded(self, before: RunState, goal: RunState | None, command: OperatorCommand) -> Failure | None:
        """Judges a command that was just applied.

        Args:
            before: the run before it.
            goal: of an undo or a redo, the moment that it goes back or forward to.
            command: what was applied.
        """
        run = self._run
        stopped = before.state.intent.stopped and not run.state.intent.stopped
        if stopped and not isinstance(command, ResetEmergencyStop):
            return Failure(Broken.MOVED, f"{type(command).__name__} has ended a STOP")
        if run.setup is before.setup and run.state.motion is before.state.motion:
            return None
        if run.setup is not self._measure.setup:
            self._measure = Measure(run.setup)
        self._owed = None
        if (failure := _not_finite(run.state.motion)) is not None:
            return failure
        worst = self._measure.worst(_bodies(self._measure, run.state.motion))
        if not worst or _violates(before) or (goal is not None and _violates(goal)):
            return None
        return Failure(Broken.UNFLAGGED, f"{type(command).__name__} puts {worst}")

    def stepped(self, before: Motion) -> Failure | None:
        """Judges the step from a motion to the present one."""
        run, after = self._run, self._run.state.motion
        if (failure := _not_finite(after)) is not None:
            return failure
        if run.state.intent.stopped:
            self._owed = None
            still = (before.position == after.position).all() and (before.heading == after.heading).all()
            return None if still else Failure(Broken.MOVED, "the team moves under a STOP")
        owed = self._points(before) if self._owed is None else self._owed
        self._owed = self._points(after)
        bodies = self._owed if run.setup.params.robots.look_ahead == 0.0 else _bodies(self._measure, after)
        return self._judge(owed, bodies, self._owed, run.trace.infeasible)

    def _judge(self, owed: Margins, bodies: Margins, points: Margins, flagged: Bools) -> Failure | None:
        noisy = self._run.setup.params.robots.position_noise > 0.0
        excused = Margins(floats(flagged[:, None]), floats(flagged[:, None] | flagged[None, :]))
        for had, has, point, excuse, name in zip(owed, bodies, points, excused, Margins._fields, strict=True):
            sound = had >= -ROUNDING
            wrong = sound & (has < -ROUNDING)
            if not noisy:
                wrong |= ~sound & (point < had - ROUNDING)
            wrong &= excuse == 0.0
            if wrong.any():
                i, k = (int(index[0]) for index in np.nonzero(wrong))
                what = self._measure.name(name, i, k)
                was = "" if sound[i, k] else f", from {had[i, k]:.6g} m"
                return Failure(Broken.UNFLAGGED, f"{what}: margin {has[i, k]:.6g} m{was}, not flagged infeasible")
        return None

    def _points(self, motion: Motion) -> Margins:
        return self._measure.margins(motion.position, motion, self._run.setup.params.robots.look_ahead)


def _bodies(measure: Measure, motion: Motion) -> Margins:
    """Margins of the robots' bodies."""
    ahead = measure.setup.params.robots.look_ahead
    return measure.margins(body_centres(motion.position, motion.heading, ahead), motion)


def goal_of(command: OperatorCommand, run: Run) -> RunState | None:
    """The moment to which an undo or a redo goes back or forward; None for other commands, or without one."""
    if isinstance(command, Undo) and run.history.done:
        return run.history.done[-1].before
    if isinstance(command, Redo) and run.history.undone:
        return run.history.undone[0].after
    return None


def _violates(run_state: RunState) -> bool:
    """Whether a robot is too near to something in a run state."""
    measure = Measure(run_state.setup)
    return bool(measure.worst(_bodies(measure, run_state.state.motion)))


def _not_finite(motion: Motion) -> Failure | None:
    for name in ("position", "heading", "velocity", "intention", "target_value", "fire_radius", "fire_progress"):
        if not np.isfinite(getattr(motion, name)).all():
            return Failure(Broken.EXCEPTION, f"motion.{name} is not a number")
    if math.isnan(motion.path_parameter):
        return Failure(Broken.EXCEPTION, "motion.path_parameter is not a number")
    return None
