"""Alarms wait to be read, and are withdrawn when their cause has ended."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import ChannelHealth, ChannelState
from higvf_console.sim.simulation import advance
from higvf_console.ui.alarms import (
    ALARM_S,
    MOST_ALARMS,
    Alarms,
    acknowledge_alarms,
    add_alarms,
    cause_lasts,
    withdraw_alarms,
)
from higvf_console.ui.ui_state import UiState, UiStore
from tests.teams import team

SETUP = team()
STATE, TRACE = advance(SETUP.start, SETUP.world, SETUP.params)


def alarm(kind: str, text: str = "It happened.", **about: Any) -> Event:
    return Event(1.0, Severity.ALARM, kind, text, **about)


def snapshot(*events: Event, stopped: bool = False, gaze: ChannelState = ChannelState.LIVE, **trace: Any) -> Any:
    return SimpleNamespace(
        events=events,
        state=STATE._replace(intent=STATE.intent._replace(stopped=stopped)),
        trace=TRACE._replace(**trace),
        channels=(("gaze", ChannelHealth(gaze, "why")), ("console", ChannelHealth(ChannelState.LIVE, ""))),
    )


STOP = alarm("stop")
NO_VELOCITY = alarm("infeasible", robot=1)
NEAR = alarm("clearance", robot=1)
LOST = alarm("channel", channel="gaze")


@pytest.fixture
def ui() -> UiStore:
    return UiStore()


@pytest.fixture
def now() -> SimpleNamespace:
    """A clock that only the test moves."""
    return SimpleNamespace(seconds=100.0)


@pytest.fixture
def alarms(ui: UiStore, now: SimpleNamespace) -> Alarms:
    return Alarms(ui, lambda: now.seconds)


def test_an_alarm_is_withdrawn_when_its_cause_has_ended_but_not_before_it_could_be_seen(
    alarms: Alarms, ui: UiStore, now: SimpleNamespace
) -> None:
    alarms.update(snapshot(STOP, stopped=True))
    now.seconds += 2 * ALARM_S
    alarms.update(snapshot(STOP, stopped=True))
    assert ui.state.alarms == (STOP,)
    alarms.update(snapshot(STOP, stopped=False))
    assert ui.state.alarms == ()


def test_an_alarm_of_a_short_cause_stands_for_a_while(alarms: Alarms, ui: UiStore, now: SimpleNamespace) -> None:
    alarms.update(snapshot(STOP, stopped=False))
    now.seconds += 0.9 * ALARM_S
    alarms.update(snapshot(STOP, stopped=False))
    assert ui.state.alarms == (STOP,)
    now.seconds += 0.2 * ALARM_S
    alarms.update(snapshot(STOP, stopped=False))
    assert ui.state.alarms == ()


def test_a_withdrawn_or_acknowledged_alarm_does_not_come_back(alarms: Alarms, ui: UiStore) -> None:
    alarms.update(snapshot(STOP, stopped=True))
    ui.change(acknowledge_alarms())
    alarms.update(snapshot(STOP, stopped=True))
    assert ui.state.alarms == ()


def test_an_alarm_that_no_event_of_the_run_tells_is_withdrawn_by_the_same_rules(
    alarms: Alarms, ui: UiStore, now: SimpleNamespace
) -> None:
    ui.change(add_alarms([STOP, alarm("view")]))
    alarms.update(snapshot(stopped=False))
    now.seconds += 2 * ALARM_S
    alarms.update(snapshot(stopped=False))
    assert [one.kind for one in ui.state.alarms] == ["view"]


@pytest.mark.parametrize(
    ("one", "cause"),
    [
        (STOP, {"stopped": True}),
        (NO_VELOCITY, {"infeasible": np.array([False, True, False])}),
        (NEAR, {"barrier": np.array([0.1, -0.1, 0.1])}),
        (LOST, {"gaze": ChannelState.LOST}),
        (LOST, {"gaze": ChannelState.RECOVERED}),
    ],
)
def test_an_alarm_stands_as_long_as_its_cause(one: Event, cause: dict[str, Any]) -> None:
    assert cause_lasts(one, snapshot(**cause))
    assert not cause_lasts(one, snapshot())


def test_the_trouble_of_another_robot_is_another_alarm() -> None:
    assert not cause_lasts(NO_VELOCITY, snapshot(infeasible=np.array([True, False, True])))
    assert not cause_lasts(LOST._replace(channel="emg"), snapshot(gaze=ChannelState.LOST))


def test_an_alarm_that_is_about_no_robot_or_one_that_is_gone_stands_while_any_is_in_trouble() -> None:
    trouble = snapshot(infeasible=np.array([True, False, True]))
    assert cause_lasts(NO_VELOCITY._replace(robot=None), trouble)
    assert cause_lasts(NO_VELOCITY._replace(robot=7), trouble)


def test_an_alarm_whose_cause_cannot_be_seen_to_end_stands_until_it_is_read() -> None:
    assert cause_lasts(alarm("failure"), snapshot())


def test_alarms_wait_until_they_are_acknowledged_by_their_text_or_all_at_once() -> None:
    waiting = [alarm("stop", f"alarm {k}") for k in range(MOST_ALARMS + 5)]
    other = Event(0.0, Severity.WARNING, "path", "a warning")
    state = add_alarms([*waiting, other])(UiState())
    assert len(state.alarms) == MOST_ALARMS
    assert state.alarms[-1] is waiting[-1]
    assert len(acknowledge_alarms("alarm 50")(state).alarms) == MOST_ALARMS - 1
    assert acknowledge_alarms("something else")(state).alarms == state.alarms
    assert acknowledge_alarms()(state).alarms == ()


def test_alarms_whose_cause_has_ended_are_withdrawn_and_equal_ones_stay() -> None:
    first, second = alarm("stop"), alarm("stop")
    state = add_alarms([first, second])(UiState())
    left = withdraw_alarms([first])(state).alarms
    assert len(left) == 1
    assert left[0] is second
