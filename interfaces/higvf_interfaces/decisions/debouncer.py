"""Debouncing of decoded labels: a pure state machine that accepts one command per onset and gives its reasons.

    threshold -> n-of-m vote -> onset -> hysteresis -> refractory time -> passed

The support of a label is its mean confidence over the last m decisions; a decision without confidence counts 1, a
decision for another label counts 0. A label becomes active, and gives its command, when its support reaches `enter`; it
gives no further command until its support has fallen to `leave`. Voting suppresses repeated commands of a good decoder
but does not rescue a weak one: motor imagery with 34 % correct decisions reaches 40 % after the vote.
"""

import math
from collections.abc import Callable
from enum import StrEnum
from typing import NamedTuple

from higvf_interfaces.formats.records import Decision

LONGEST_VOTE = 50  # maximum number of decisions in a vote


class Stage(StrEnum):
    """The stage that held a decision, or `PASSED`."""

    THRESHOLD = "threshold"
    VOTE = "vote"
    HYSTERESIS = "hysteresis"
    ONSET = "onset"
    REFRACTORY = "refractory"
    PASSED = "passed"


class Evidence(NamedTuple):
    """Evidence required for a command; the defaults let every decision pass.

    Attributes:
        threshold: minimum confidence in [0, 1]; a decision below it abstains, a decision without confidence votes.
        votes: required votes for the label among the last `of` decisions.
        of: number of decisions in the vote.
        enter: support in [0, 1] at which a label becomes active; with 0 every decision that wins the vote is an onset.
        leave: support in [0, 1] at which an active label becomes inactive.
        refractory: minimum time between two commands of the same label [s].
        memory: age from which decisions are ignored [s].
    """

    threshold: float = 0.0
    votes: int = 1
    of: int = 1
    enter: float = 0.0
    leave: float = 0.0
    refractory: float = 0.0
    memory: float = 3.0


class Verdict(NamedTuple):
    """Outcome of one decision: the stage that held it and the reason, or `PASSED`."""

    time: float
    label: str
    stage: Stage
    reason: str


class Debounced(NamedTuple):
    """State of the debouncer.

    Attributes:
        recent: the last decisions, oldest first; an abstention has the label "".
        active: the active label; "" means none.
        accepted: session time at which each label last passed [s].
    """

    recent: tuple[Decision, ...] = ()
    active: str = ""
    accepted: tuple[tuple[str, float], ...] = ()


def observe(state: Debounced, decision: Decision, evidence: Callable[[str], Evidence]) -> Debounced:
    """Return the state after a decision that cannot be accepted; it may deactivate the active label."""
    if _abstains(decision, evidence(decision.label)):
        decision = decision._replace(label="")
    recent = (*state.recent, decision)[-LONGEST_VOTE:]
    active = state.active
    if active and support(recent, active, evidence(active)) <= evidence(active).leave:
        active = ""
    return state._replace(recent=recent, active=active)


def judge(state: Debounced, decision: Decision, evidence: Callable[[str], Evidence]) -> tuple[Debounced, Verdict]:
    """Return the state after a decision, and the verdict on the decision.

    Args:
        state: previous state.
        decision: next decision in order of time.
        evidence: evidence required for a label.
    """
    state = observe(state, decision, evidence)
    label, time, needed = decision.label, decision.time, evidence(decision.label)
    held = _held(state, decision, needed)
    if held is not None:
        return state, Verdict(time, label, *held)
    accepted = (*((other, when) for other, when in state.accepted if other != label), (label, time))
    return state._replace(active=label, accepted=accepted), Verdict(time, label, Stage.PASSED, "passed")


def support(recent: tuple[Decision, ...], label: str, needed: Evidence) -> float:
    """Return the support of `label`, in [0, 1]."""
    votes = [1.0 if vote.confidence is None else vote.confidence for vote in _electorate(recent, needed)
             if vote.label == label]  # fmt: skip
    return sum(votes) / needed.of


def votes_for(recent: tuple[Decision, ...], label: str, needed: Evidence) -> int:
    """Return the number of votes for `label`."""
    return sum(vote.label == label for vote in _electorate(recent, needed))


def _electorate(recent: tuple[Decision, ...], needed: Evidence) -> tuple[Decision, ...]:
    """Return the decisions that vote: the last m that are not too old."""
    since = recent[-1].time - needed.memory if recent else 0.0
    return tuple(vote for vote in recent[-needed.of :] if vote.time >= since)


def _held(state: Debounced, decision: Decision, needed: Evidence) -> tuple[Stage, str] | None:
    """Return the stage that holds an observed decision and the reason, or None if it passes."""
    label = decision.label
    votes = votes_for(state.recent, label, needed)
    since = decision.time - dict(state.accepted).get(label, -math.inf)
    stages = (
        (_abstains(decision, needed), Stage.THRESHOLD, f"confidence below {needed.threshold:g}"),
        (votes < needed.votes, Stage.VOTE, f"fewer than {needed.votes} of {needed.of} votes"),
        (needed.enter > 0 and label == state.active, Stage.ONSET, "already accepted at its onset"),
        (support(state.recent, label, needed) < needed.enter, Stage.HYSTERESIS, f"support below {needed.enter:g}"),
        (since < needed.refractory, Stage.REFRACTORY, "repeated within the refractory time"),
    )
    return next(((stage, reason) for holds, stage, reason in stages if holds), None)


def _abstains(decision: Decision, needed: Evidence) -> bool:
    return decision.confidence is not None and decision.confidence < needed.threshold
