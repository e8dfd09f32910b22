"""Evidence required for each action: less for `stop` and `pause`, more for actions whose errors are costly.

inputs: {bci: {votes: 3/5, hysteresis: 0.8/0.5, refractory: 1.5, evidence: {stop: {votes: 1/3}, robot: {votes: 5/5}}}}
"""

import math
from collections.abc import Mapping
from typing import cast

from higvf_interfaces.decisions.actions import ACTIONS
from higvf_interfaces.decisions.debouncer import LONGEST_VOTE, Evidence
from higvf_interfaces.fields import Fields, shown

NEEDS = ("threshold", "votes", "hysteresis", "refractory", "memory")
ROBOT = "robot"  # the actions `robot:NUMBER`
LEAST = ("stop", "pause")
MORE = (
    "resume",
    "next_task",
    "ask_reset",
    "reset_stop",
    "reset_run",
    "acknowledge",
    "clear_path",
    "reverse_path",
    ROBOT,
)
STREAMING = Evidence(votes=3, of=5, enter=0.8, leave=0.5, refractory=1.0)  # default with a decoder


class EvidenceTable:
    """Required evidence by action."""

    def __init__(self, options: Fields, base: Evidence) -> None:
        """Read the channel's options and its table `evidence`.

        Args:
            options: options of the channel.
            base: defaults.

        Raises:
            InputError: If a value is invalid or an action is unknown; the message lists the known actions.
        """
        self._base = _evidence(options, base)
        self._own: dict[str, Evidence] = {}
        known = (*ACTIONS, ROBOT)
        for action, needs in cast(Mapping[object, object], options.mapping("evidence")).items():
            place = f"{options.place}: evidence: {action}"
            if action not in known:
                options.fail(f"evidence: {shown(action)} is not an action; known actions: {', '.join(known)}")
            if not isinstance(needs, dict):
                options.fail(f"evidence: {action}: {shown(needs)} is not a mapping with the keys {', '.join(NEEDS)}")
            fields = Fields(cast(dict[str, object], needs), NEEDS, place)
            self._own[str(action)] = _evidence(fields, usual(str(action), self._base))

    def of(self, action: str) -> Evidence:
        """Return the evidence required for `action`, for example `pause` or `robot:2`."""
        kind = ROBOT if action.startswith(f"{ROBOT}:") else action
        return self._own.get(kind) or usual(kind, self._base)


def usual(action: str, base: Evidence) -> Evidence:
    """Return the default of an action.

    `stop` and `pause` need one vote and a support halfway between LEAVE and ENTER; costly actions need one vote more.
    """
    if action in LEAST:
        return base._replace(votes=1, of=1, enter=(base.enter + base.leave) / 2)
    return base._replace(votes=min(base.votes + 1, base.of)) if action in MORE else base


def _evidence(fields: Fields, base: Evidence) -> Evidence:
    votes, of = _pair(fields, "votes", (base.votes, base.of), "n/m with 1 <= n <= m <= 50, such as 3/5")
    if not (votes == int(votes) and of == int(of) and 1 <= votes <= of <= LONGEST_VOTE):
        fields.fail(f"votes: {votes:g}/{of:g} is not n/m with 1 <= n <= m <= {LONGEST_VOTE}, such as 3/5")
    enter, leave = _pair(fields, "hysteresis", (base.enter, base.leave), "ENTER/LEAVE, such as 0.8/0.5")
    if not 0 <= leave <= enter <= 1:
        fields.fail(f"hysteresis: {enter:g}/{leave:g} is not ENTER/LEAVE with 0 <= LEAVE <= ENTER <= 1")
    return Evidence(
        threshold=fields.number("threshold", base.threshold, 0.0, 1.0),
        votes=int(votes),
        of=int(of),
        enter=enter,
        leave=leave,
        refractory=fields.number("refractory", base.refractory, 0.0, 3600.0, "s"),
        memory=fields.number("memory", base.memory, 0.01, 3600.0, "s"),
    )


def _pair(fields: Fields, key: str, default: tuple[float, float], form: str) -> tuple[float, float]:
    if not fields.has(key):
        return default
    parts = str(fields.values[key]).split("/")
    try:
        first, second = (float(part) for part in parts)
    except ValueError:
        first = second = math.nan
    if not math.isfinite(first + second):
        fields.fail(f"{key}: {shown(fields.values[key])} is not {form}")
    return first, second
