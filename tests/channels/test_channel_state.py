"""A channel's states, by the clock and by what is heard of it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.channels.channel_state import (
    OUT_OF_SERVICE,
    Limits,
    OnLost,
    acknowledged,
    default_limits,
    judged,
    observed,
)
from higvf_console.core.errors import ScenarioError
from higvf_console.core.interface import ChannelHealth, ChannelState
from higvf_console.core.reading.document import read_yaml
from higvf_console.scenario.channel_settings import read_inputs

LIVE, STALE, LOST, BACK = ChannelState.LIVE, ChannelState.STALE, ChannelState.LOST, ChannelState.RECOVERED
LIMITS = Limits(0.5, 2.0)


def last_seen_at(time: float) -> ChannelHealth:
    return ChannelHealth(LIVE, "", time)


@pytest.mark.parametrize(("quiet", "state"), [(0.0, LIVE), (0.5, LIVE), (0.51, STALE), (2.0, STALE), (2.01, LOST)])
def test_silence_is_judged_by_the_limits(quiet: float, state: ChannelState) -> None:
    assert judged(last_seen_at(10.0), 10.0 + quiet, LIMITS) is state


def test_a_quiet_replay_is_not_dead() -> None:
    assert judged(ChannelHealth(LIVE, "a log"), 1e6, LIMITS) is LIVE


@pytest.mark.parametrize("state", [ChannelState.NEVER_SEEN, LOST, ChannelState.ENDED])
def test_what_a_device_says_of_its_end_needs_no_silence(state: ChannelState) -> None:
    assert judged(ChannelHealth(state, "", 10.0), 10.0, LIMITS) is state


def test_a_lost_channel_that_is_heard_again_waits_for_the_operator() -> None:
    assert observed(LOST, LIVE) is BACK
    assert observed(BACK, LIVE) is BACK
    assert acknowledged(BACK) is LIVE
    assert acknowledged(LOST) is LOST, "nobody can acknowledge what is not there"


def test_a_channel_that_is_back_can_be_lost_again_and_its_pauses_do_not_count() -> None:
    assert observed(BACK, STALE) is BACK
    assert observed(BACK, LOST) is LOST
    assert observed(LOST, STALE) is LOST


@given(st.lists(st.floats(0.0, 5.0), max_size=40))
def test_nothing_resumes_by_itself(quiet: list[float]) -> None:
    state, lost = LIVE, False
    for silence in quiet:
        state = observed(state, judged(last_seen_at(0.0), silence, LIMITS))
        lost = lost or state is LOST
        assert (state in OUT_OF_SERVICE) == lost


def test_the_limits_of_a_scenario_go_over_the_defaults_and_do_not_reach_the_interface() -> None:
    text = "{gaze: {stale: 0.3, clutch: held}, emg: {lost: 9, on_lost: hold}, bci: {stale: 6}}"
    settings, limits = read_inputs(read_yaml(text, "s.yaml"))
    assert settings == {"gaze": {"clutch": "held"}, "emg": {}, "bci": {}}
    assert limits["gaze"] == (0.3, 2.0, OnLost.AUTONOMY)
    assert limits["emg"] == (1.0, 9.0, OnLost.HOLD)
    assert limits["bci"].lost > limits["bci"].stale == 6.0
    assert [default_limits(name).stale for name in ("gaze", "emg", "bci", "mouse")] == [0.5, 1.0, 1.0, 2.0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{gaze: {stale: 3, lost: 2}}", "gaze: lost: 2 s is not longer than stale, 3 s"),
        ("{gaze: {stale: soon}}", "gaze.stale"),
        ("{gaze: {on_lost: panic}}", "'panic' is not one of autonomy, hold, keep"),
    ],
)
def test_limits_that_cannot_be_are_refused(text: str, said: str) -> None:
    with pytest.raises(ScenarioError) as refusal:
        read_inputs(read_yaml(text, "s.yaml"))
    assert said in str(refusal.value)
