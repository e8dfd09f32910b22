"""The tables of the Inputs panel: each channel and why, the debouncer's stages, what was looked at, the calibration."""

import math
from collections.abc import Sequence

from higvf_console.core.interface import ChannelHealth
from higvf_console.core.numbers import percent
from higvf_console.core.reports import AttentionReport, CalibrationReport, CaptureReport, DecisionReport
from higvf_console.ui.widgets.channel_mark import CHANNEL_MARK
from higvf_console.ui.widgets.html import DASH, text

MOST_ROBOTS = 12  # that have a line of their own
STAGE_WORDS = {
    "threshold": "low confidence",
    "vote": "too few votes",
    "hysteresis": "too little support",
    "onset": "no new onset",
    "refractory": "repeated too soon",
    "passed": "passed",
    "unknown": "unknown label",
    "idle": "no action for this label",
    "": "no decision yet",
}


def channels_html(channels: Sequence[tuple[str, ChannelHealth]]) -> str:
    """A row for each input: its mark, its name, its state, and below them why."""
    rows = "".join(_channel(name, health) for name, health in channels)
    return f'<div class="title">Channels</div><div class="inputs">{rows}</div>'


def _channel(name: str, health: ChannelHealth) -> str:
    mark, colour = CHANNEL_MARK[health.state]
    return (
        f'<span class="mark" style="color:{colour}">{mark}</span><b>{text(name)}</b>'
        f"<span>{text(health.state.value)}</span>"
        f'<span class="why dim">{text(health.detail)}</span>'
    )


def decisions_html(name: str, report: DecisionReport) -> str:
    """The stages of one channel's debouncer, in the order in which a decision meets them."""
    rows = "".join(
        f"<tr><td>{stage}</td><td>{now}</td><td>{needed}</td><td>{count or DASH}</td></tr>"
        for stage, now, needed, count in _stages(report)
    )
    head = "<tr><th>Stage</th><th>Now</th><th>Needs</th><th>Rejected</th></tr>"
    ghosts = f", {report.proposed} of them as a proposal" if report.proposed else ""
    return (
        f'<div class="title">Decisions of {text(name)}</div><div>{_latest(report)}</div>'
        f'<table class="numbers"><thead>{head}</thead><tbody>{rows}</tbody></table>'
        f'<div class="dim">{report.passed} passed{ghosts}; {report.unknown} unknown</div>'
    )


def _latest(report: DecisionReport) -> str:
    word = f'<span class="dim">{STAGE_WORDS.get(report.stage, text(report.stage))}</span>'
    if not report.label:
        return word
    held = "active, " if report.enter > 0.0 and report.active == report.label else ""
    return f"<b>{text(report.label)}</b> {held}{word}"


def _stages(report: DecisionReport) -> list[tuple[str, str, str, int]]:
    """Name, present value, what is needed, and how many decisions were held, of each stage."""
    held = dict(report.held)
    confidence = DASH if report.confidence is None else f"{report.confidence:.2f}"
    known = bool(report.label)
    wait = f"{report.refractory:.1f} s" if report.refractory > 0.0 else "free"
    trust = f"{report.threshold:g}" if report.threshold > 0.0 else "any"
    levels = f"{report.enter:g} / {report.leave:g}" if report.enter > 0.0 else "any"
    onset = "a new one" if report.enter > 0.0 else "any"
    return [
        ("Confidence", confidence, trust, _of(held, "threshold")),
        ("Votes", f"{report.votes}/{report.of}" if known else DASH, f"{report.votes_needed}/{report.of}",
         _of(held, "vote")),
        ("Support", f"{report.support:.2f}" if known else DASH, levels, _of(held, "hysteresis")),
        ("Onset", (text(report.active) or "none") if report.enter > 0.0 else DASH, onset, _of(held, "onset")),
        ("Refractory", wait, "free", _of(held, "refractory")),
    ]  # fmt: skip


def _of(held: dict[str, int], stage: str) -> int:
    return held.get(stage, 0)


def attention_html(report: AttentionReport | None) -> str:
    """Time of fixations on each fire and robot with its share, and the signs of workload."""
    title = '<div class="title">Attention</div>'
    if report is None:
        return f'{title}<span class="dim">No input reports your gaze.</span>'
    total = float(report.fires.sum() + report.robots.sum()) + report.elsewhere
    named = [(f"Fire {k + 1}", float(spent)) for k, spent in enumerate(report.fires.tolist())]
    robots = [(f"Robot {k + 1}", float(spent)) for k, spent in enumerate(report.robots.tolist())]
    named += robots[:MOST_ROBOTS]
    if len(robots) > MOST_ROBOTS:
        rest = sum(spent for _, spent in robots[MOST_ROBOTS:])
        named.append((f"Robots {MOST_ROBOTS + 1} to {len(robots)}", rest))
    named.append(("Elsewhere", report.elsewhere))
    rows = "".join(
        f'<tr class="{"" if spent > 0.0 else "out"}"><td>{name}</td><td>{spent:.1f}</td><td>{_share(spent, total)}</td>'
        f"<td>{_bar(spent, total)}</td></tr>"
        for name, spent in named
    )
    head = "<tr><th>Looked at</th><th>s</th><th>Share</th><th></th></tr>"
    return (
        f'{title}<table class="numbers attention"><thead>{head}</thead><tbody>{rows}</tbody></table>'
        f'<div class="title">Workload</div><dl class="wide">{_workload(report)}</dl>'
    )


def _share(spent: float, total: float) -> str:
    return percent(spent / total) if total > 0.0 else DASH


def _bar(spent: float, total: float) -> str:
    return f'<span class="bar" style="width:{100 * spent / total:.0f}%"></span>' if spent > 0.0 else ""


def _workload(report: AttentionReport) -> str:
    duration = f"{1e3 * report.fixation_duration:.0f} ms" if math.isfinite(report.fixation_duration) else DASH
    entropy = f"{report.transition_entropy:.2f}" if math.isfinite(report.transition_entropy) else DASH
    rows = (
        ("Fixation rate", f"{report.fixation_rate:.2f} /s", "Fixations per second of valid gaze"),
        ("Mean fixation", duration, "Longer and fewer fixations indicate workload"),
        ("Transition entropy", entropy, "0: gaze moves in a fixed order; 1: at random"),
    )
    return "".join(f'<dt title="{hint}">{name}</dt><dd>{value}</dd>' for name, value, hint in rows)


def calibration_html(calibrations: Sequence[tuple[str, CalibrationReport]], capture: CaptureReport | None) -> str:
    """The calibration in use, and how the making of one stands."""
    lines = [f"<div>{_calibration(name, report)}</div>" for name, report in calibrations]
    if not lines:
        lines.append('<div class="dim">None in use.</div>')
    if capture is not None and capture.target is not None:
        lines.append(f"<div>Target {capture.number} of {capture.targets}, {percent(capture.progress)}</div>")
    elif capture is not None and (capture.refusal or capture.outcome):
        lines.append(f'<div class="dim">{text(capture.refusal or capture.outcome)}</div>')
    return f'<div class="title">Calibration</div>{"".join(lines)}'


def _calibration(name: str, report: CalibrationReport) -> str:
    stored = f", {text(report.file)}" if report.file else ""
    return (
        f"<b>{text(name)}</b>: {len(report.points_px)} points, off by {report.residual_px:.1f} px, "
        f'{report.residual_m:.2f} m <span class="dim">{text(report.made)}{stored}</span>'
    )
