"""The same session as fast as the machine can, and one report at its end."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from higvf_console.channels.attention_report import attention_section
from higvf_console.control.forms import name_of
from higvf_console.core.arguments import instance, number
from higvf_console.runtime.interrupts import held_back
from higvf_console.runtime.run import Tick, TrajectoryDigest
from higvf_console.runtime.session import Session
from higvf_console.runtime.snapshot import Snapshot
from higvf_console.sim.certificates import certificates

LONGEST = 1e6  # [s]


def run_headless(
    session: Session, duration: float | None = None, each: Callable[[Tick], object] | None = None
) -> dict[str, Any]:
    """Ticks until all fires are out or `duration` ends, then reports; the caller closes the session.

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
    digest, tick_ms, done = TrajectoryDigest(), list[float](), 0
    with held_back() as give_interrupt:
        for _ in range(math.ceil(duration / dt - 1e-9)):
            give_interrupt()
            session.tick()
            if session.ticks > done:
                done = session.ticks
                digest.add(session.snapshot.state.motion)
                tick_ms.append(session.snapshot.tick_ms)
                if each is not None:
                    each(_tick(session.snapshot))
            burning = session.snapshot.state.motion.fire_burning
            if len(burning) and not burning.any():
                break
    inputs = session.input_reports
    return {
        "scenario": session.scenario.name,
        "forms": name_of(session.scenario.params.forms),
        "seed": session.seed,
        "duration_s": round(done * dt, 9),
        "ticks": done,
        **_outcome(session),
        "commands": [
            {"time": round(time, 9), "source": command.source, "kind": type(command).__name__}
            for time, command in session.commands
        ],
        "channels": {
            name: {"state": health.state.value, "detail": health.detail} for name, health in session.snapshot.channels
        },
        "attention": attention_section(inputs.attention),
        "calibrations": {name: report._asdict() for name, report in inputs.calibrations},
        "tick_ms": {f"p{share}": round(float(np.percentile(tick_ms or [0.0], share)), 4) for share in (50, 99)},
        "digest": digest.hex(),
    }


def _tick(now: Snapshot) -> Tick:
    return Tick(now.time, now.state, now.trace, now.setup)


def _outcome(session: Session) -> dict[str, Any]:
    now, setup = session.snapshot, session.setup
    return {
        "extinguished": [fire + 1 for fire in now.extinguished],
        "loss_area_m2": now.loss_area.tolist(),
        "loss_area_total_m2": float(now.loss_area.sum()),
        "min_clearance_margin_m": now.min_clearance if math.isfinite(now.min_clearance) else None,
        "infeasible_ticks": now.infeasible_ticks,
        "deadlock_s": round(now.deadlock_s, 9),
        "certificates": [
            {**item._asdict(), "value": item.value if math.isfinite(item.value) else None, "met": item.met}
            for item in certificates(setup.world, setup.params, setup.start, now.state, now.trace, now.worst)
        ],
    }
