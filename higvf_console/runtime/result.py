"""What a run has come to: loss by fire against the run without an operator, order, clearance, actions."""

from typing import NamedTuple

import numpy as np

from higvf_console.analysis.baseline import Baseline
from higvf_console.core.arrays import Floats
from higvf_console.core.events import Severity
from higvf_console.runtime.history import Entry
from higvf_console.runtime.phase import EndReason
from higvf_console.runtime.snapshot import Snapshot

_BEGINNINGS = ("reset", "loaded")  # kinds of events with which another run begins


class WithoutOperator(NamedTuple):
    """The same world without an operator.

    Attributes:
        time: at which the runs are compared [s]: its end where all fires of this run are out, else the same time.
        loss_area: (M,) [m^2].
        order: fire indices in the order in which they went out.
    """

    time: float
    loss_area: Floats
    order: tuple[int, ...]


class RunResult(NamedTuple):
    """The result of a run, or what it has come to so far.

    Attributes:
        reason: why it has ended; None while it has not.
        time: session time [s].
        loss_area: (M,) burnt by each fire [m^2].
        order: fire indices in the order in which they went out.
        without: the run without an operator; None without fires, or while it is not known.
        min_clearance: smallest of the run [m]; inf where no robot came near anything.
        infeasible_ticks: control periods in which a robot could not meet all constraints.
        deadlock_s: time in which a robot was deadlocked [s].
        actions: what the operator did, oldest first.
    """

    reason: EndReason | None
    time: float
    loss_area: Floats
    order: tuple[int, ...]
    without: WithoutOperator | None
    min_clearance: float
    infeasible_ticks: int
    deadlock_s: float
    actions: tuple[Entry, ...]


def run_result(now: Snapshot, baseline: Baseline | None) -> RunResult:
    """The result of a run at one moment.

    Args:
        now: that moment.
        baseline: of the same world; None = not known.
    """
    known = baseline is not None and baseline.by_fire.shape[1] == len(now.loss_area)
    return RunResult(
        reason=now.phase.reason,
        time=now.time,
        loss_area=now.loss_area,
        order=now.extinguished,
        without=_without(now, baseline) if known and baseline is not None else None,
        min_clearance=now.min_clearance,
        infeasible_ticks=now.infeasible_ticks,
        deadlock_s=now.deadlock_s,
        actions=_actions(now),
    )


def _without(now: Snapshot, baseline: Baseline) -> WithoutOperator:
    out = not now.state.motion.fire_burning.any()
    last = len(baseline.time) - 1
    row = last if out else min(int(np.searchsorted(baseline.time, now.time - 1e-9)), last)
    burnt = baseline.burning[: row + 1]
    gone = [(int(burnt[:, fire].sum()), fire) for fire in np.flatnonzero(~burnt[-1]).tolist()]
    time = float(baseline.time[row])
    if not burnt[-1].any():
        time = float(baseline.time[max(ticks for ticks, _ in gone)])
    return WithoutOperator(time, baseline.by_fire[row], tuple(fire for _, fire in sorted(gone)))


def _actions(now: Snapshot) -> tuple[Entry, ...]:
    """The actions that are not undone since the run began; a STOP, which cannot be undone, is one."""
    done = list[Entry]()
    for action in now.history.done:
        if action.whole:
            done.clear()
        else:
            done.append(Entry(action.time, action.text, False))
    stops = list[Entry]()
    for event in now.events:
        if event.kind in _BEGINNINGS:
            stops.clear()
        elif event.kind == "stop" and event.severity is Severity.ALARM:
            stops.append(Entry(event.time, event.text, False))
    return tuple(sorted((*done, *stops), key=lambda entry: entry.time))
