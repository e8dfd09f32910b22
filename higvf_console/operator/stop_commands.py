"""Pause, resume, emergency stop and its reset in two steps."""

from typing import TypeAlias, assert_never

from higvf_console.core.commands import AskReset, EmergencyStop, Pause, ResetEmergencyStop, Resume
from higvf_console.core.events import Event, Severity
from higvf_console.core.state import SimState
from higvf_console.operator.outcome import Outcome, path_dropped, proposal_dropped, refuse, report, with_pointer_state

StopCommand: TypeAlias = Pause | Resume | EmergencyStop | AskReset | ResetEmergencyStop


def pause_or_stop(state: SimState, command: StopCommand, time: float) -> Outcome:  # noqa: PLR0911
    """Applies a command that pauses, stops or resumes the whole team.

    Args:
        state: present state.
        command: one of those above.
        time: session time [s].

    Returns:
        The next state, and the events to report.
    """
    match command:
        case Pause():
            return _paused(state, True), report(time, "paused", "Paused: the robots hold and only yield to hazards.")
        case Resume() if state.intent.stopped:
            return state, refuse(time, "The STOP is active: reset it before you resume.")
        case Resume():
            return _paused(state, False), report(time, "resumed", "The team resumes.")
        case EmergencyStop():
            return _stopped(state, True), (Event(time, Severity.ALARM, "stop", "STOP: all robots stand still."),)
        case AskReset():
            return with_pointer_state(state, ask_reset=state.intent.stopped), ()
        case ResetEmergencyStop() if not state.pointer_state.ask_reset:
            return state, refuse(time, "A STOP is reset in two steps: request the reset first.")
        case ResetEmergencyStop():
            text = "STOP is reset; the team stays paused until you resume."
            return _stopped(state, False), report(time, "stop", text)
        case _:
            assert_never(command)


def _paused(state: SimState, paused: bool) -> SimState:
    return state._replace(intent=state.intent._replace(paused=paused))


def _stopped(state: SimState, stopped: bool) -> SimState:
    state = with_pointer_state(path_dropped(proposal_dropped(state)), ask_reset=False)
    return state._replace(intent=state.intent._replace(stopped=stopped, paused=True))
