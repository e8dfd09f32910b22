"""The tables that explain a robot: parts of its velocity, active constraints, fires in sight, certificates."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from higvf_console.analysis.active_constraints import ActiveConstraint
from higvf_console.analysis.explain import Part
from higvf_console.analysis.sight import Sight, hider_names
from higvf_console.core.arrays import Floats
from higvf_console.core.numbers import metres
from higvf_console.sim.certificates import CONNECTED, Certificate
from higvf_console.sim.guard import Guard
from higvf_console.ui.scene.reasons import part_colours
from higvf_console.ui.theme import CSS
from higvf_console.ui.widgets.html import DASH, dot, text
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

PART_NAMES = {
    Part.TARGET: ("Own target", "Robot intention v_t"),
    Part.HUMAN: ("Human", "Human intention v_h"),
    Part.NEIGHBOURS: ("Neighbours", "Their shared intentions"),
    Part.CARRIED_OVER: ("Carried over", "The shared intention of the last control period"),
    Part.FORMATION: ("Formation", "Formation velocity v_f"),
    Part.DETOUR: ("Detour", "Bump functions and circulation round obstacles"),
    Part.LIMIT: ("Speed limit or pause", "Speed limit; or a pause, or STOP"),
    Part.SAFETY: ("Safety", "What the safety filter corrects"),
}
PART_COLOUR = part_colours(CSS)
MOST_ROWS = 4  # active constraints that are named
MOST_HIDERS = 2  # obstacles that are named for one fire
_MINUS, _LEAST, _MOST = "\u2212", "\u2265", "\u2264"


def parts_html(robot: int, parts: Floats, velocity: Floats, digits: int = 1) -> str:
    """The parts (8, 2) of a robot's velocity (2,) [m/s] and their sum, with so many decimals."""
    least = 0.5 * 10.0**-digits  # a shorter one is shown as zero
    rows = "".join(
        f'<tr class="{"" if np.hypot(*vector) >= least else "out"}" title="{text(PART_NAMES[part][1])}">'
        f"<td>{dot(PART_COLOUR[part])}{PART_NAMES[part][0]}</td>{_components(vector, digits)}</tr>"
        for part, vector in zip(Part, parts, strict=True)
    )
    head = "<tr><th>Part m/s</th><th>x</th><th>y</th><th>length</th></tr>"
    return (
        f'<div class="title">Why robot {robot + 1} moves</div><table class="numbers"><thead>{head}</thead>'
        f"<tbody>{rows}</tbody><tfoot><tr><td>Velocity</td>{_components(velocity, digits)}</tr></tfoot></table>"
    )


def _components(vector: Floats, digits: int) -> str:
    x, y = vector.tolist()
    return f"<td>{signed(x, digits)}</td><td>{signed(y, digits)}</td><td>{math.hypot(x, y):.{digits}f}</td>"


def signed(value: float, digits: int = 1) -> str:
    """A number with so many decimals and a true minus; never minus zero."""
    shown = f"{abs(value):.{digits}f}"
    return f"{_MINUS}{shown}" if value < 0.0 and float(shown) != 0.0 else shown


def rows_html(rows: Sequence[ActiveConstraint]) -> str:
    """What holds the robot back, with its distance and the least one."""
    if not rows:
        return '<div class="held dim">No barrier holds it back.</div>'
    named = "<br>".join(
        f'<b>{text(row.name)}</b>, {metres(row.distance)} <span class="dim">({_LEAST} {metres(row.least)})</span>'
        for row in rows[:MOST_ROWS]
    )
    more = f' <span class="dim">and {len(rows) - MOST_ROWS} more</span>' if len(rows) > MOST_ROWS else ""
    return f'<div class="held"><span class="dim">Held back by</span><span>{named}{more}</span></div>'


def guard_html(guard: Guard, robot: int) -> str:
    """Whether a robot stands while others drive, and by how much clearances grow; nothing in a run without a team."""
    lines: list[str] = []
    if robot in guard.standing:
        lines.append(f"Robot {robot + 1} must stand; it is an obstacle to the others.")
    if guard.budget > 0.0:
        lines.append(f"Clearances are {metres(guard.budget)} wider, for latency and the error of poses.")
    return "".join(f'<div class="dim">{line}</div>' for line in lines)


def sight_html(found: Sequence[Sight], snapshot: "Snapshot", robot: int, setup: Setup) -> str:
    """The target score of each burning fire, what it would be unhidden, and what hides it; the target is marked."""
    title = '<div class="title">Seen fires</div>'
    if not found:
        return f'{title}<span class="dim">No fire burns.</span>'
    target = snapshot.last.after.target[robot]
    rows = "".join(
        f'<tr class="{"" if sight.value > 0.0 else "out"}"><td>{sight.fire + 1}{_target(sight.fire == target)}</td>'
        f"<td>{_why_hidden(sight, setup)}</td><td>{math.degrees(sight.value):.1f}°</td>"
        f"<td>{math.degrees(sight.whole):.1f}°</td></tr>"
        for sight in found
    )
    head = "<tr><th>Fire</th><th>Hidden by</th><th>Seen</th><th>unobstructed</th></tr>"
    return f"{title}<table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def _target(chosen: bool) -> str:
    return ' <span class="chosen">target</span>' if chosen else ""


def _why_hidden(sight: Sight, setup: Setup) -> str:
    if not sight.in_range:
        return "out of range"
    names = hider_names(sight, setup)
    more = f" +{len(names) - MOST_HIDERS}" if len(names) > MOST_HIDERS else ""
    return text(", ".join(names[:MOST_HIDERS])) + more if names else DASH


def certificate_html(found: Sequence[Certificate]) -> str:
    """Each condition with its value, its limit, whether it is met and, where it is not, what that means."""
    head = "<tr><th>Condition</th><th>Value</th><th>Limit</th><th></th></tr>"
    return (
        f'<div class="title">Does the method hold?</div><table class="numbers"><thead>{head}</thead>'
        f"<tbody>{''.join(map(_certificate_row, found))}</tbody></table>"
    )


def _certificate_row(certificate: Certificate) -> str:
    meaning = text(certificate.meaning)
    met, failing = "met", ""
    if not certificate.met:
        met, failing = "<span class=alarm>not met</span>", f'<tr><td colspan="4" class="warn">{meaning}</td></tr>'
    return (
        f'<tr title="{text(certificate.symbol)}. {meaning}"><td>{text(certificate.name)}</td>'
        f"<td>{_number(certificate.value)}</td><td>{_limit(certificate)}</td><td>{met}</td></tr>{failing}"
    )


def _limit(certificate: Certificate) -> str:
    if certificate.least and 0.0 < certificate.limit <= CONNECTED:
        return "> 0"
    return f"{_LEAST if certificate.least else _MOST} {certificate.limit:g}"


def _number(value: float) -> str:
    if math.isinf(value):
        return "none" if value > 0.0 else DASH
    if abs(value) < 5e-5:
        return "0"
    return f"{value:.3g}".replace("-", _MINUS)
