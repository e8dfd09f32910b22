"""Where a run is between its beginning and its end: pure functions from one phase to the next.

READY --StartRun--> RUNNING --its end--> ENDED --ContinueRun--> CONTINUED
ResetRun leads back to RUNNING, or leaves READY; LoadScenario begins at READY or RUNNING
"""

import math
from enum import StrEnum
from typing import NamedTuple

from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import Motion, PathStatus
from higvf_console.scenario.ends import Ends, EndWhen

_SLACK = 1e-9  # of a control period: what rounding may take


class Phase(StrEnum):
    """Where a run is; the clock runs in RUNNING and CONTINUED."""

    READY = "ready"
    RUNNING = "running"
    ENDED = "ended"
    CONTINUED = "continued"  # after its end: it does not end again


class EndReason(StrEnum):
    """Why a run has ended."""

    ALL_FIRES_OUT = "all_fires_out"
    PATH_FINISHED = "path_finished"
    DURATION = "duration"


END_TEXTS = {
    EndReason.ALL_FIRES_OUT: "all fires are out",
    EndReason.PATH_FINISHED: "the path is finished",
    EndReason.DURATION: "the time is over",
}


class RunPhase(NamedTuple):
    """The phase of a run.

    Attributes:
        phase: where it is.
        held: control periods in a row at whose end the end condition held.
        reason: why it has ended; kept while it is continued; None before.
    """

    phase: Phase = Phase.RUNNING
    held: int = 0
    reason: EndReason | None = None

    @property
    def moves(self) -> bool:
        """Whether the clock may run."""
        return self.phase in (Phase.RUNNING, Phase.CONTINUED)


FIRST = RunPhase()


def begun(now: RunPhase) -> RunPhase:
    """After a StartRun.

    Raises:
        ScenarioError: the run does not wait for it.
    """
    if now.phase is not Phase.READY:
        raise ScenarioError("the run has begun already")
    return RunPhase()


def continued(now: RunPhase) -> RunPhase:
    """After a ContinueRun.

    Raises:
        ScenarioError: the run has not ended.
    """
    if now.phase is not Phase.ENDED:
        raise ScenarioError("the run has not ended")
    return now._replace(phase=Phase.CONTINUED)


def again(now: RunPhase) -> RunPhase:
    """After a ResetRun."""
    return RunPhase(Phase.READY) if now.phase is Phase.READY else RunPhase()


def after_period(now: RunPhase, motion: Motion, ends: Ends, limit: float, period: float) -> RunPhase:
    """After one control period.

    Args:
        now: before it.
        motion: after it.
        ends: how the run ends.
        limit: when its time is over [s].
        period: length of a control period [s].
    """
    if now.phase is not Phase.RUNNING:
        return now
    held = now.held + 1 if _holds(motion, ends.when) else 0
    if held > math.ceil(ends.after / period - _SLACK):
        return RunPhase(Phase.ENDED, held, EndReason(ends.when.value))
    if motion.tick * period >= limit - _SLACK:
        return RunPhase(Phase.ENDED, held, EndReason.DURATION)
    return now if held == now.held else now._replace(held=held)


def _holds(motion: Motion, when: EndWhen) -> bool:
    match when:
        case EndWhen.ALL_FIRES_OUT:
            return len(motion.fire_burning) > 0 and not motion.fire_burning.any()
        case EndWhen.PATH_FINISHED:
            return motion.path_status in (PathStatus.FINISHED, PathStatus.HOLDING)
        case EndWhen.NEVER:
            return False
