"""How a channel is: a pure state machine, fed with the time, the last sign of life and the operator's acknowledgement.

    never seen -> live <-> stale -> lost -> back, not resumed -- acknowledged --> live
                                      ^----------'

Nothing resumes by itself: a channel that was lost and is back is used again once the operator has acknowledged it. A
device that reports itself as gone is lost at once; a replay goes by the session clock, and its silence is no loss.
"""

from enum import StrEnum
from typing import NamedTuple

from higvf_console.core.interface import ChannelHealth, ChannelState


class OnLost(StrEnum):
    """What becomes of the human intention when the channel that steered is lost."""

    AUTONOMY = "autonomy"  # it ends, and the team goes on with its own task
    HOLD = "hold"  # the team holds until somebody resumes
    KEEP = "keep"  # the path in force stays


class GivenLimits(NamedTuple):
    """What a scenario says of a channel; None = nothing.

    Attributes:
        stale: silence after which it is stale [s].
        lost: silence after which it is lost [s].
        on_lost: what becomes of the human intention then.
    """

    stale: float | None = None
    lost: float | None = None
    on_lost: OnLost = OnLost.AUTONOMY


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
OUT_OF_SERVICE = frozenset({ChannelState.LOST, ChannelState.RECOVERED})


def limits_of(given: GivenLimits, stale_after: float) -> Limits:
    """The limits of a channel.

    Args:
        given: by the scenario.
        stale_after: silence after which the channel is stale by its own `Capabilities` [s].

    Returns:
        A channel is lost after `LOST_BY_STALE` times the silence that makes it stale. Where the scenario says only when
        it is lost, and that is before its own `stale_after`, it is stale after the corresponding part of that.
    """
    own_lost = LOST_BY_STALE * stale_after
    if given.stale is not None:
        stale = given.stale
    else:
        stale = stale_after if given.lost is None or stale_after < given.lost else given.lost / LOST_BY_STALE
    lost = max(own_lost, LOST_BY_STALE * stale) if given.lost is None else given.lost
    return Limits(stale, lost, given.on_lost)


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
