"""Pause, STOP and its reset in two steps: what each leaves latched, and what it says."""

import pytest

from higvf_console.core.commands import AskReset, EmergencyStop, Pause, ResetEmergencyStop, Resume
from higvf_console.core.events import Event, Severity
from higvf_console.core.state import NO_PATH, NOBODY, PathKind, SimState
from higvf_console.operator.outcome import with_pointer_state
from higvf_console.operator.stop_commands import StopCommand, pause_or_stop
from tests.teams import team

TIME = 12.5

pytestmark = pytest.mark.usefixtures("plain_kernels")


def start() -> SimState:
    return team().start


def after(state: SimState, *commands: StopCommand) -> tuple[SimState, list[Event]]:
    events: list[Event] = []
    for command in commands:
        state, new = pause_or_stop(state, command, TIME)
        events += new
    return state, events


def latched(state: SimState) -> tuple[bool, bool]:
    """Whether the team is paused, and whether it is stopped."""
    return state.intent.paused, state.intent.stopped


def test_a_pause_holds_the_team_until_it_resumes() -> None:
    before = start()
    paused, events = after(before, Pause())
    assert (latched(paused), events[0].kind, events[0].time) == ((True, False), "paused", TIME)
    resumed, events = after(paused, Resume())
    assert (latched(resumed), events[0].kind) == ((False, False), "resumed")
    assert resumed.motion is before.motion


def test_a_stop_is_an_alarm_and_stays_latched_whatever_is_resumed() -> None:
    stopped, (alarm,) = after(start(), EmergencyStop())
    assert latched(stopped) == (True, True)
    assert (alarm.kind, alarm.severity) == ("stop", Severity.ALARM)
    same, (refusal,) = after(stopped, Resume())
    assert latched(same) == (True, True)
    assert (refusal.kind, refusal.text) == ("refused", "The STOP is active: reset it before you resume.")


def test_a_reset_takes_two_steps_and_leaves_the_team_paused() -> None:
    stopped, _ = after(start(), EmergencyStop())
    same, (refusal,) = after(stopped, ResetEmergencyStop())
    assert latched(same) == (True, True)
    assert refusal.text == "A STOP is reset in two steps: request the reset first."
    asked, events = after(stopped, AskReset())
    assert (latched(asked), asked.pointer_state.ask_reset, events) == ((True, True), True, [])
    reset, (said,) = after(asked, ResetEmergencyStop())
    assert (latched(reset), reset.pointer_state.ask_reset) == ((True, False), False)
    assert (said.kind, said.severity) == ("stop", Severity.INFO)


def test_another_stop_takes_the_first_step_of_a_reset_back() -> None:
    state, events = after(start(), EmergencyStop(), AskReset(), EmergencyStop(), ResetEmergencyStop())
    assert latched(state) == (True, True)
    assert events[-1].kind == "refused"


def test_a_reset_that_nobody_needs_cannot_be_asked_for() -> None:
    assert not after(start(), AskReset())[0].pointer_state.ask_reset


@pytest.mark.parametrize("command", [EmergencyStop(), ResetEmergencyStop()], ids=["stop", "reset"])
def test_what_is_pending_does_not_outlast_a_stop_nor_its_reset(command: StopCommand) -> None:
    pending = NO_PATH._replace(kind=int(PathKind.LINE))
    waits = with_pointer_state(
        start(), pending=pending, pending_robot=1, proposed=2, proposed_until=99.0, ask_reset=True
    )
    left = after(waits, command)[0].pointer_state
    assert (left.pending.kind, left.pending_robot, left.proposed) == (PathKind.NONE, NOBODY, NOBODY)
