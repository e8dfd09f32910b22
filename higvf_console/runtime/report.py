"""The report of a run as JSON has it: of a headless run, and of one that a person has watched."""

import math
from typing import Any

from higvf_console.channels.attention_report import attention_section
from higvf_console.control.forms import name_of
from higvf_console.runtime.phase import EndReason
from higvf_console.runtime.result import run_result
from higvf_console.runtime.session import Session
from higvf_console.sim.certificates import certificates


def run_report(session: Session, ticks: int) -> dict[str, Any]:
    """What every report has.

    Args:
        session: whose run.
        ticks: control periods that it took.
    """
    inputs, now = session.input_reports, session.snapshot
    period = session.setup.params.safety.control_period
    return {
        "scenario": session.scenario.name,
        "forms": name_of(session.scenario.params.forms),
        "seed": session.seed,
        "duration_s": round(ticks * period, 9),
        "ticks": ticks,
        "ended": (now.phase.reason or EndReason.DURATION).value,
        **_outcome(session),
        "commands": [
            {"time": round(time, 9), "source": command.source, "kind": type(command).__name__}
            for time, command in session.commands
        ],
        "channels": {name: {"state": health.state.value, "detail": health.detail} for name, health in now.channels},
        "attention": attention_section(inputs.attention),
        "calibrations": {name: report._asdict() for name, report in inputs.calibrations},
    }


def watched_report(session: Session) -> dict[str, Any]:
    """The report of the present run of a console.

    It has the keys of a headless one but for computing times and digest, which need the run as a whole, and besides:
    `without_operator`, null where that run is not known, and the operator's `actions` with the time of each.
    """
    now = session.snapshot
    result = run_result(now, session.baseline)
    report = run_report(session, int(now.state.motion.tick))
    if result.reason is None:
        report["ended"] = None
    without = result.without
    report["without_operator"] = without and {
        "time_s": round(without.time, 9),
        "extinguished": [fire + 1 for fire in without.order],
        "loss_area_m2": without.loss_area.tolist(),
        "loss_area_total_m2": float(without.loss_area.sum()),
    }
    report["actions"] = [{"time": round(entry.time, 9), "text": entry.text} for entry in result.actions]
    return report


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
