"""After a run: what it came to, beside the run without an operator."""

import math

from higvf_console.core.numbers import percent
from higvf_console.runtime.history import Entry
from higvf_console.runtime.phase import END_TEXTS
from higvf_console.runtime.result import RunResult, WithoutOperator
from higvf_console.ui.widgets.html import DASH, area, clock, nearness, text

MOST_ACTIONS = 40  # that are listed
_ARROW, _MINUS = " \u2192 ", "\u2212"


def result_html(result: RunResult, title: str) -> str:
    """The card of a run that has ended."""
    reason = END_TEXTS[result.reason] if result.reason is not None else "the run goes on"
    rows = [
        ("Order", order_line(result)),
        ("Safety margin", f"minimum {nearness(result.min_clearance)}"),
    ]
    if result.infeasible_ticks or result.deadlock_s > 0.0:
        rows.append(("Safety filter", filter_line(result)))
    rows.append(("You", actions_line(result.actions)))
    lines = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in rows)
    return (
        f'<header><h2>{reason[:1].upper()}{reason[1:]} <span class="dim">after {clock(result.time)}</span></h2>'
        f'<button class="fold" data-fold></button></header><div class="body"><p class="dim">{text(title)}</p>'
        f"{losses_html(result)}<dl>{lines}</dl>{actions_html(result.actions)}</div>"
        '<footer><button class="act first" data-act="again">Again</button>'
        '<button class="act" data-act="continue">Continue</button>'
        '<button class="act" data-act="report">Save report</button>'
        '<button class="act" data-act="scenarios">Other scenario …</button></footer>'
    )


def losses_html(result: RunResult) -> str:
    """The loss area of each fire, here and without an operator; one line where there are none."""
    if not len(result.loss_area):
        return "<p>No fires burnt.</p>"
    without = result.without
    rows = "".join(
        f"<tr><td>{fire + 1}</td><td>{area(loss)}</td>{_beside(loss, _loss_of(without, fire))}</tr>"
        for fire, loss in enumerate(result.loss_area.tolist())
    )
    total = float(result.loss_area.sum())
    foot = f"<tr><td>All</td><td>{area(total)}</td>{_beside(total, _total_of(without))}</tr>"
    head = "<tr><th>Fire</th><th>Burnt m²</th><th>Without operator m²</th><th>Difference</th></tr>"
    return f"<table><thead>{head}</thead><tbody>{rows}</tbody><tfoot>{foot}</tfoot></table>"


def _loss_of(without: WithoutOperator | None, fire: int) -> float:
    return math.nan if without is None else float(without.loss_area[fire])


def _total_of(without: WithoutOperator | None) -> float:
    return math.nan if without is None else float(without.loss_area.sum())


def _beside(loss: float, other: float) -> str:
    """The other run's loss, and what this one saves."""
    if math.isnan(other):
        return f"<td>{DASH}</td><td>{DASH}</td>"
    gap = loss - other
    if abs(gap) < 0.5:
        return f'<td>{area(other)}</td><td class="dim">same</td>'
    sign, mood = ("+", "warn") if gap > 0 else (_MINUS, "good")
    share = f" ({sign}{percent(abs(gap) / other, 1)})" if other > 0.0 else ""
    return f'<td>{area(other)}</td><td class="{mood}">{sign}{area(abs(gap))}{share}</td>'


def order_line(result: RunResult) -> str:
    """In which order the fires went out, here and without an operator where that differs."""
    order = _order(result.order)
    if result.without is None:
        return order
    time = f"all out after {clock(result.without.time)}" if _all_out(result) else f"by {clock(result.without.time)}"
    other = "the same" if result.without.order == result.order else _order(result.without.order)
    return f'{order} <span class="dim">without operator: {other}, {time}</span>'


def _all_out(result: RunResult) -> bool:
    return result.without is not None and len(result.without.order) == len(result.loss_area)


def _order(fires: tuple[int, ...]) -> str:
    return _ARROW.join(str(fire + 1) for fire in fires) or "none out"


def filter_line(result: RunResult) -> str:
    """In what trouble the safety filter was."""
    found = (
        [f'<span class="alarm">{result.infeasible_ticks} ticks infeasible</span>'] if result.infeasible_ticks else []
    )
    if result.deadlock_s > 0.0:
        found.append(f"robots held for {result.deadlock_s:.1f} s")
    return ", ".join(found)


def actions_line(actions: tuple[Entry, ...]) -> str:
    """How much the operator did."""
    if not actions:
        return "did nothing"
    return "1 action" if len(actions) == 1 else f"{len(actions)} actions"


def actions_html(actions: tuple[Entry, ...]) -> str:
    """The operator's actions, oldest first."""
    if not actions:
        return ""
    lines = "".join(
        f'<span class="dim">{clock(entry.time)}</span><span>{text(entry.text)}</span>'
        for entry in actions[:MOST_ACTIONS]
    )
    more = f'<p class="dim">and {len(actions) - MOST_ACTIONS} more</p>' if len(actions) > MOST_ACTIONS else ""
    return f'<h3>What you did</h3><div class="actions">{lines}</div>{more}'
