"""The same session as fast as the machine can, and one report at its end."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from higvf_console.core.arguments import instance, number
from higvf_console.runtime.interrupts import held_back
from higvf_console.runtime.phase import Phase
from higvf_console.runtime.report import run_report
from higvf_console.runtime.run import Tick, TrajectoryDigest
from higvf_console.runtime.session import Session
from higvf_console.runtime.snapshot import Snapshot

LONGEST = 1e6  # [s]
MOST_TIMES = 2**16  # computing times of control periods that are kept


class EvenSample:
    """Values of a series of any length, evenly spaced over it."""

    def __init__(self, most: int) -> None:
        """Starts empty.

        Args:
            most: that are kept, an even number; beyond, every second one goes.
        """
        self.values = list[float]()
        self._most, self._spacing, self._added = most, 1, 0

    def add(self, value: float) -> None:
        """The next value of the series."""
        if self._added % self._spacing == 0:
            self.values.append(value)
        if len(self.values) > self._most:
            self.values, self._spacing = self.values[::2], 2 * self._spacing
        self._added += 1


def run_headless(
    session: Session, duration: float | None = None, each: Callable[[Tick], object] | None = None
) -> dict[str, Any]:
    """Ticks until the run ends as its scenario says, or `duration` does, then reports; the caller closes the session.

    A clock that a command froze stands until the duration ends, for nobody else can thaw it.

    Args:
        session: fresh, with its interfaces.
        duration: [s]; None = the scenario's.
        each: called after every control period.

    Raises:
        ArgumentError: no session, or a duration that is no time.

    Returns:
        The report, ready for JSON: fires are numbered from 1; `min_clearance_margin_m` is the smallest distance beyond
        the required clearance, null when no robot came near anything; `channels` gives the state of each input at the
        end, and why; `attention` is null without gaze; `digest` is the SHA-256 of `TrajectoryDigest`.
    """
    instance("session", session, Session)
    dt = session.setup.params.safety.control_period
    duration = session.scenario.duration if duration is None else number("duration", duration, 0.0, LONGEST)
    digest, tick_ms, done = TrajectoryDigest(), EvenSample(MOST_TIMES), 0
    with held_back() as give_interrupt:
        for _ in range(math.ceil(duration / dt - 1e-9)):
            give_interrupt()
            session.tick()
            if session.ticks > done:
                done = session.ticks
                digest.add(session.snapshot.state.motion)
                tick_ms.add(session.snapshot.tick_ms)
                if each is not None:
                    each(_tick(session.snapshot))
            if session.snapshot.phase.phase is Phase.ENDED:
                break
    return {
        **run_report(session, done),
        "tick_ms": {f"p{share}": round(float(np.percentile(tick_ms.values or [0.0], share)), 4) for share in (50, 99)},
        "digest": digest.hex(),
    }


def _tick(now: Snapshot) -> Tick:
    return Tick(now.time, now.state, now.trace, now.setup)
