"""Whether a team may drive: tried first, then armed in two steps; any loss leads back.

    DISARMED -> CHECKING -> CHECKED -> ARMED

In the check each robot moves a little, then hears nothing. Only a team whose robots are all measured to have moved, and
to stand `SILENCE_S` after the last command, can be armed: one that drives on in silence would drive on when the console
dies.
"""

import numpy as np

from higvf_console.core.events import Severity
from higvf_console.core.numbers import metres
from higvf_console.team.state import Arming, TeamState, Told, names
from higvf_console.team.tracking import Rules

MOVE_S = 0.6  # of the check: the robots move [s]
SILENCE_S = 0.5  # after the last command, by when a robot must stand [s]
WAIT_S = 1.5  # of silence after which a robot that has not stood is found out [s]


def arming_after(state: TeamState, rules: Rules) -> tuple[TeamState, list[Told]]:
    """Disarms a team that has lost something; goes on with the check."""
    if state.arming is Arming.DISARMED:
        return state, []
    if why := unfit(state, rules):
        return disarmed(state), [(Severity.ALARM, f"The team is disarmed: {why}.", None)]
    if state.arming is Arming.CHECKING and state.now - state.since > MOVE_S:
        return _checked(state)
    return state, []


def _checked(state: TeamState) -> tuple[TeamState, list[Told]]:
    """What the silence after the move has shown so far."""
    track, end = state.track, state.since + MOVE_S
    silent = state.now - end - state.latency
    moved, stands = track.anchored_at > state.since, track.stands()
    took = track.anchored_at - end - state.latency
    if not moved.all():
        why = f"{names((~moved).nonzero()[0])} did not move in the check" if silent > SILENCE_S else ""
    elif not stands.all():
        why = f"{names((~stands).nonzero()[0])} did not stand when nothing was sent any more" if silent > WAIT_S else ""
    elif (took > SILENCE_S).any():
        why = f"{names((took > SILENCE_S).nonzero()[0])} did not stand {SILENCE_S:g} s after the last command"
    else:
        text = (
            f"Silence stops every robot, within {max(float(took.max()), 0.0):.2f} s. Arm again to let the team drive."
        )
        return state._replace(arming=Arming.CHECKED, since=state.now), [(Severity.GOOD, text, None)]
    return (disarmed(state), [(Severity.ALARM, f"Not armed: {why}.", None)]) if why else (state, [])


def unfit(state: TeamState, rules: Rules) -> str:
    """Why the team must not drive; "" = it may."""
    if state.failure:
        return state.failure
    age = state.track.age(state.now)
    if (lost := (~state.track.seen | (age > rules.lost_after))).any():
        return f"{names(lost.nonzero()[0])} cannot be seen"
    if broken := [robot for robot, link in enumerate(state.links) if not link.connected]:
        return f"the link to {names(np.array(broken))} is broken"
    return ""


def asked_to_arm(state: TeamState, rules: Rules) -> tuple[TeamState, str]:
    """First step: the check begins; with the reason where it cannot."""
    if state.arming is not Arming.DISARMED:
        return state, f"the team is {state.arming.value} already"
    if why := unfit(state, rules):
        return state, why
    if state.stopped.any():
        return state, f"{names(state.stopped.nonzero()[0])} must be released first, for the check moves every robot"
    if not (stands := state.track.stands()).all():
        who, error = names((~stands).nonzero()[0]), metres(rules.error)
        return state, f"{who} must stand first (to within error_m, the error of poses, which is {error})"
    return state._replace(arming=Arming.CHECKING, since=state.now, told_at=np.full(len(stands), np.inf)), ""


def armed(state: TeamState) -> tuple[TeamState, str]:
    """Second step; with the reason where it cannot be taken."""
    if state.arming is not Arming.CHECKED:
        words = {Arming.ARMED: "it is armed already", Arming.CHECKING: "the check is not over"}
        return state, words.get(state.arming, "the check comes first")
    return state._replace(arming=Arming.ARMED, since=state.now), ""


def disarmed(state: TeamState) -> TeamState:
    """Nobody drives any more."""
    told_at = np.where(np.isinf(state.told_at), state.now, state.told_at)
    return state._replace(arming=Arming.DISARMED, since=state.now, told_at=told_at)
