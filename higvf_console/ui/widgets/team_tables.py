"""The tables of the Team panel: whether the team may drive, the lamps of a stop, and each robot with its link."""

import math
from collections.abc import Sequence

import numpy as np

from higvf_console.core.arrays import Bools, Floats
from higvf_console.core.numbers import metres
from higvf_console.team.guard import budgets
from higvf_console.team.state import Arming, TeamState
from higvf_console.team.tracking import Rules
from higvf_console.ui.widgets.html import DASH, text

MOST_ROWS = 24  # robots of a larger team have a line only where something is the matter
LIT, DARK = "\u25cf", "\u25cb"
ARMING_TEXT = {
    Arming.DISARMED: "Not armed: no robot drives.",
    Arming.CHECKING: "Check: each robot moves a little, then hears nothing and must stand by itself.",
    Arming.CHECKED: "Silence stops every robot. Arm to let the team drive.",
    Arming.ARMED: "Armed: the team may drive.",
}


def arming_html(team: TeamState) -> str:
    """Whether the team may drive, and why it cannot be talked to if so."""
    colour = {Arming.ARMED: "good", Arming.CHECKED: "good"}.get(team.arming, "warn")
    failure = f'<div class="alarm">{text(_sentence(team.failure))}</div>' if team.failure else ""
    return f'<div><span class="{colour}">{ARMING_TEXT[team.arming]}</span></div>{failure}'


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."


def lamps_html(team: TeamState) -> str:
    """What has become of the order to stand: sent, acknowledged, measured standing; how many robots, where not all."""
    told = np.isfinite(team.told_at)
    if not told.any():
        return '<div class="dim">No robot is told to stand.</div>'
    confirms = np.array([link.acknowledged >= 0 for link in team.links])
    lamps = (
        ("stop sent", told, True),
        ("acknowledged", team.acknowledged, bool(confirms[told].any())),
        ("standing", team.track.stands(), True),
    )
    return "".join(_lamp(name, lit & told, int(told.sum()), known=known) for name, lit, known in lamps)


def _lamp(name: str, lit: Bools, of: int, *, known: bool) -> str:
    count = int(lit.sum())
    if not known:
        return f'<span class="lamp dim">{DARK} {name}: unknown</span>'
    every = count == of
    share = "" if every else f" {count} of {of}"
    return f'<span class="lamp {"good" if every else "warn"}">{LIT if every else DARK} {name}{share}</span>'


def robots_html(team: TeamState, rules: Rules, commanded: Floats, digits: int) -> str:
    """A row for each robot: state, age of its pose, clearance budget, speed told and measured, battery.

    Args:
        team: as it was last heard of.
        rules: what its robots can do.
        commanded: (N,) speeds that they are told [m/s].
        digits: of a speed.
    """
    words = [robot_word(team, robot) for robot in range(len(team.links))]
    shown = [robot for robot, (_, colour) in enumerate(words) if len(words) <= MOST_ROWS or colour in ("warn", "alarm")]
    budget = budgets(team, rules)
    rows = "".join(
        _row(team, robot, words[robot], float(budget[robot]), commanded, digits) for robot in shown[:MOST_ROWS]
    )
    rest = len(words) - min(len(shown), MOST_ROWS)
    more = f'<div class="dim">and {rest} more robots</div>' if rest else ""
    head = "<tr><th>Robot</th><th></th><th>pose</th><th>budget</th><th>told / moves</th><th>battery</th></tr>"
    return f'<table class="team"><thead>{head}</thead><tbody>{rows}</tbody></table>{more}'


def _row(
    team: TeamState, robot: int, word: tuple[str, str], budget: float, commanded: Floats, digits: int
) -> str:  # fmt: skip
    link, age = team.links[robot], float(team.track.age(team.now)[robot])
    battery = DASH if math.isnan(link.battery) else f"{link.battery:.0%}"
    pose = DASH if not math.isfinite(age) else f"{1e3 * age:.0f} ms" if age < 1.0 else f"{age:.1f} s"
    moves = math.hypot(*team.track.velocity[robot].tolist())
    speed = f"{float(commanded[robot]):.{digits}f} / {moves:.{digits}f}"
    refused = int(team.track.refused[robot])
    hint = f"{refused} poses refused. {link.detail}" if refused else link.detail
    return (
        f'<tr title="{text(hint)}"><td>{robot + 1}</td><td class="{word[1]}">{word[0]}</td><td>{pose}</td>'
        f"<td>{metres(budget)}</td><td>{speed}</td><td>{battery}</td></tr>"
    )


def robot_word(team: TeamState, robot: int) -> tuple[str, str]:
    """What a robot does, in a word, and in which colour; the gravest first."""
    told, stands = bool(np.isfinite(team.told_at[robot])), bool(team.track.stands()[robot])
    cases: Sequence[tuple[bool, str, str]] = (
        (bool(team.disobedient[robot]), "drives on", "alarm"),
        (not team.links[robot].connected, "no link", "alarm"),
        (not bool(team.track.seen[robot]), "never seen", "warn"),
        (bool(team.stale[robot]), "not seen", "warn"),
        (bool(team.faults[robot]), "pose refused", "warn"),
        (bool(team.stopped[robot]), "stopped", "warn"),
        (told and stands, "stands", "dim"),
        (told, "told to stand", "dim"),
        (True, "drives", ""),
    )
    return next((word, colour) for holds, word, colour in cases if holds)
