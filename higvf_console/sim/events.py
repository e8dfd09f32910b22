"""What happened between two states, in words: fires out, targets changed, paths finished, robots in trouble."""

from collections.abc import Callable

import numpy as np

from higvf_console.control.guidance.recovery import ASK, MORE_HUMAN, OTHER_DIRECTION
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Bools
from higvf_console.core.events import Event, Severity
from higvf_console.core.numbers import measured
from higvf_console.core.state import NOBODY, Motion, PathStatus, SimState, Trace


def events_between(
    before: SimState,
    after: SimState,
    trace_before: Trace | None,
    trace: Trace,
    params: Parameters,
    violation: Callable[[int, Motion], str],
) -> tuple[Event, ...]:
    """The events of one tick; empty, and found in a few comparisons, when nothing happened.

    Args:
        before: the state before the tick.
        after: the state after it.
        trace_before: of the tick before; None = unknown, so that every trouble counts as new.
        trace: of this tick.
        params: all tunables.
        violation: says which clearance a robot violates, as `analysis.violation` does.
    """
    was, now = before.motion, after.motion
    time = now.tick * params.safety.control_period
    events: list[Event] = []
    if was.fire_burning.tobytes() != now.fire_burning.tobytes():
        for fire in np.flatnonzero(was.fire_burning & ~now.fire_burning).tolist():
            area = np.pi * now.fire_radius[fire] ** 2
            text = f"Fire {fire + 1} is out; it burnt {measured(area)} m²."
            events.append(Event(time, Severity.GOOD, "extinguished", text, fire=fire))
    if was.path_status != now.path_status:
        events.extend(_path_event(was.path_status, now.path_status, after.intent.influenced, time))
    if was.target.tobytes() != now.target.tobytes():
        target = _common_target(now.target)
        if target not in (NOBODY, _common_target(was.target)):
            text = f"The team's target is fire {target + 1}."
            events.append(Event(time, Severity.INFO, "target", text, fire=target))
    if trace.infeasible.any():
        fresh = trace.infeasible if trace_before is None else trace.infeasible & ~trace_before.infeasible
        events.extend(_alarm(time, "infeasible", i, _INFEASIBLE) for i in np.flatnonzero(fresh).tolist())
    if (near := too_near(trace)).any():
        fresh = near if trace_before is None else near & ~too_near(trace_before)
        robots = np.flatnonzero(fresh & ~trace.infeasible).tolist()
        events.extend(_alarm(time, "clearance", i, violation(i, now)) for i in robots)
    if was.recovery_stage.tobytes() != now.recovery_stage.tobytes():
        events.extend(_escalated(was.recovery_stage, now.recovery_stage, time))
    return tuple(events)


def too_near(trace: Trace) -> Bools:
    """(N,) robots that are nearer to something than their clearance, as a STOP beside a growing fire may leave them."""
    return trace.barrier < -_ROUNDING


_ROUNDING = 1e-6  # by which h of a robot that the filter holds right at a clearance may be below 0
_INFEASIBLE = "has no safe velocity: it takes the least violation"
_STAGES = {
    OTHER_DIRECTION: (Severity.INFO, "is held by its barriers: the team tries the other circulation direction"),
    MORE_HUMAN: (
        Severity.INFO,
        "is still held: the human intention gets more weight where that changes the direction of motion",
    ),
    ASK: (Severity.WARNING, "is held by its barriers: a new stroke can free it"),
}


def _escalated(was: np.ndarray, now: np.ndarray, time: float) -> list[Event]:
    return [
        Event(time, _STAGES[recovery_stage][0], "deadlock", f"Robot {i + 1} {_STAGES[recovery_stage][1]}.", robot=i)
        for i, recovery_stage in enumerate(now.tolist())
        if recovery_stage > was[i] and recovery_stage in _STAGES
    ]


def _alarm(time: float, kind: str, robot: int, trouble: str) -> Event:
    return Event(time, Severity.ALARM, kind, f"Robot {robot + 1} {trouble}.", robot=robot)


def _path_event(before: int, status: int, influenced: int, time: float) -> list[Event]:
    if before == PathStatus.BREAK_AWAY and status == PathStatus.FOLLOWING:
        return [Event(time, Severity.INFO, "break-away", "The team returns to its path.")]
    if status == PathStatus.FINISHED:
        text = f"Robot {influenced + 1} has finished its path."
        return [Event(time, Severity.GOOD, "path", text, robot=influenced)]
    if status == PathStatus.HOLDING:
        text = f"Robot {influenced + 1} has finished its path; the team waits."
        return [Event(time, Severity.GOOD, "path", text, robot=influenced)]
    if status == PathStatus.BREAK_AWAY:
        return [Event(time, Severity.INFO, "break-away", "The team leaves its path for a fire that it has found.")]
    if status == PathStatus.BLOCKED:
        text = f"Robot {influenced + 1} made no progress on its path; the human intention is released."
        return [Event(time, Severity.WARNING, "path", text, robot=influenced)]
    return []


def _common_target(target: np.ndarray) -> int:
    """The fire that the whole team wants, or NOBODY."""
    first = int(target[0]) if len(target) else NOBODY
    return first if (target == first).all() else NOBODY
