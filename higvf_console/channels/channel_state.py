"""How a channel is: a pure state machine, fed with the time, the last sign of life and the operator's acknowledgement.

    never seen -> live <-> stale -> lost -> back, not resumed -- acknowledged --> live
                                      ^----------'

Nothing resumes by itself: what was lost and is heard again waits until the operator has acknowledged it. A device that
says itself that it is gone is lost at once; a replay judges itself by the session clock, and its quiet is no loss.
"""

from enum import StrEnum
from typing import NamedTuple

from higvf_console.core.interface import ChannelHealth, ChannelState


class OnLost(StrEnum):
    """What becomes of the human intention when the channel that steered is lost."""

    AUTONOMY = "autonomy"  # it ends, and the team goes on with its own task
    HOLD = "hold"  # the team holds until somebody resumes
    KEEP = "keep"  # the path in force stays


class Limits(NamedTuple):
    """When silence matters.

    Attributes:
        stale: silence after which a channel is stale [s].
        lost: silence after which it is lost [s].
        on_lost: what becomes of the human intention then.
    """

    stale: float
    lost: float
    on_lost: OnLost = OnLost.AUTONOMY


LOST_BY_STALE = 4.0  # a channel is lost after so many times the silence that makes it stale
STALE_AFTER = {"gaze": 0.5, "emg": 1.0, "bci": 1.0, "mouse": 2.0}  # [s]
STALE_AFTER_ELSE = 1.0  # [s]
OUT_OF_SERVICE = frozenset({ChannelState.LOST, ChannelState.RECOVERED})


def default_limits(channel: str) -> Limits:
    """The limits of a channel of which the scenario says nothing."""
    stale = STALE_AFTER.get(channel, STALE_AFTER_ELSE)
    return Limits(stale, LOST_BY_STALE * stale)


def judged(health: ChannelHealth, now: float, limits: Limits) -> ChannelState:
    """How a channel is by itself at session time `now` [s], whatever has been before."""
    if health.last_seen is None or health.state in (ChannelState.NEVER_SEEN, ChannelState.LOST, ChannelState.ENDED):
        return health.state
    quiet = now - health.last_seen
    if quiet > limits.lost:
        return ChannelState.LOST
    return ChannelState.STALE if quiet > limits.stale else ChannelState.LIVE


def observed(state: ChannelState, seen: ChannelState) -> ChannelState:
    """The state after `state`, when the channel by itself is as `seen`."""
    if state not in OUT_OF_SERVICE or seen not in (ChannelState.LIVE, ChannelState.STALE):
        return seen
    return ChannelState.RECOVERED if seen is ChannelState.LIVE else state


def acknowledged(state: ChannelState) -> ChannelState:
    """The state after the operator has acknowledged that the channel is back; one that is still lost stays so."""
    return ChannelState.LIVE if state is ChannelState.RECOVERED else state
