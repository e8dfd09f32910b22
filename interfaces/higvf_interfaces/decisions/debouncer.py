"""From a stream of decoded labels to one command per onset: a pure state machine whose every step says why.

    threshold -> n-of-m vote -> hysteresis -> one per onset -> refractory time -> passed

A label's support is the mean over its last m decisions of their confidence (a decision without one is a plain vote, 1;
another label is 0). A label becomes active when its support reaches `enter`, gives its command then, and gives none
again before its support has fallen to `leave`. Voting keeps a good decoder from stuttering and does not rescue a weak
one: motor imagery that is right 34 times in 100 singly is right 40 times after it.
"""

import math
from collections.abc import Callable
from enum import StrEnum
from typing import NamedTuple

from higvf_interfaces.formats.records import Decision

LONGEST_VOTE = 50  # decisions that a vote may look at


class Stage(StrEnum):
    """Where a decision was held, or that it passed."""

    THRESHOLD = "threshold"
    VOTE = "vote"
    HYSTERESIS = "hysteresis"
    ONSET = "onset"
    REFRACTORY = "refractory"
    PASSED = "passed"


class Evidence(NamedTuple):
    """What it takes before a label gives its command; the defaults let everything pass.

    Attributes:
        threshold: decisions of lower confidence abstain; one without confidence votes.
        votes: so many of the last `of` decisions must say the label.
        of: decisions that vote.
        enter: support that makes a label active; 0 = every decision that is voted for is an onset.
        leave: support at which an active label is released.
        refractory: the same label is not accepted again for so long [s].
        memory: older decisions are forgotten [s].
    """

    threshold: float = 0.0
    votes: int = 1
    of: int = 1
    enter: float = 0.0
    leave: float = 0.0
    refractory: float = 0.0
    memory: float = 3.0


class Verdict(NamedTuple):
    """What became of one decision: the stage that held it, and why; `PASSED` where none did."""

    time: float
    label: str
    stage: Stage
    reason: str


class Debounced(NamedTuple):
    """What is remembered from decision to decision.

    Attributes:
        recent: the last decisions, oldest first; one that abstained has the label "".
        active: the label that has given its command and is not released yet; "" = none.
        accepted: when each label last passed [s].
    """

    recent: tuple[Decision, ...] = ()
    active: str = ""
    accepted: tuple[tuple[str, float], ...] = ()


def observe(state: Debounced, decision: Decision, evidence: Callable[[str], Evidence]) -> Debounced:
    """The state after a decision has been heard, which may release the active label; nothing is accepted here."""
    if _abstains(decision, evidence(decision.label)):
        decision = decision._replace(label="")
    recent = (*state.recent, decision)[-LONGEST_VOTE:]
    active = state.active
    if active and support(recent, active, evidence(active)) <= evidence(active).leave:
        active = ""
    return state._replace(recent=recent, active=active)


def judge(state: Debounced, decision: Decision, evidence: Callable[[str], Evidence]) -> tuple[Debounced, Verdict]:
    """The state after a decision, and the verdict on it.

    Args:
        state: before.
        decision: not earlier than those before it.
        evidence: what a label needs.
    """
    state = observe(state, decision, evidence)
    label, time, needed = decision.label, decision.time, evidence(decision.label)
    held = _held(state, decision, needed)
    if held is not None:
        return state, Verdict(time, label, *held)
    accepted = (*((other, when) for other, when in state.accepted if other != label), (label, time))
    return state._replace(active=label, accepted=accepted), Verdict(time, label, Stage.PASSED, "passed")


def support(recent: tuple[Decision, ...], label: str, needed: Evidence) -> float:
    """Mean confidence, in [0, 1], with which the last decisions say `label`."""
    votes = [1.0 if vote.confidence is None else vote.confidence for vote in _electorate(recent, needed)
             if vote.label == label]  # fmt: skip
    return sum(votes) / needed.of


def votes_for(recent: tuple[Decision, ...], label: str, needed: Evidence) -> int:
    """How many of the decisions that vote now say `label`."""
    return sum(vote.label == label for vote in _electorate(recent, needed))


def _electorate(recent: tuple[Decision, ...], needed: Evidence) -> tuple[Decision, ...]:
    """The decisions that vote now: the last m that are not forgotten."""
    since = recent[-1].time - needed.memory if recent else 0.0
    return tuple(vote for vote in recent[-needed.of :] if vote.time >= since)


def _held(state: Debounced, decision: Decision, needed: Evidence) -> tuple[Stage, str] | None:
    """The stage that holds a decision which has been observed, and why; None where none does."""
    label = decision.label
    votes = votes_for(state.recent, label, needed)
    since = decision.time - dict(state.accepted).get(label, -math.inf)
    stages = (
        (_abstains(decision, needed), Stage.THRESHOLD, f"confidence below {needed.threshold:g}"),
        (votes < needed.votes, Stage.VOTE, f"fewer than {needed.votes} of {needed.of} votes"),
        (needed.enter > 0 and label == state.active, Stage.ONSET, "given at its onset"),
        (support(state.recent, label, needed) < needed.enter, Stage.HYSTERESIS, f"support below {needed.enter:g}"),
        (since < needed.refractory, Stage.REFRACTORY, "repeated within the refractory time"),
    )
    return next(((stage, reason) for holds, stage, reason in stages if holds), None)


def _abstains(decision: Decision, needed: Evidence) -> bool:
    return decision.confidence is not None and decision.confidence < needed.threshold
