"""The effect of each operator command, and that a refused command changes nothing."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from higvf_console.control.guidance.paths import path_points
from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    AskReset,
    ClearPath,
    Clutch,
    Confirm,
    ControlChange,
    Cursor,
    Discard,
    EmergencyStop,
    HandOver,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    ProposePick,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    ReversePath,
    StrokeBegin,
    StrokeCancel,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.core.events import Event, Severity
from higvf_console.core.state import NO_PATH, NOBODY, PathKind, PathStatus, SimState
from higvf_console.operator.reducer import apply_command
from higvf_console.sim.simulation import advance
from higvf_console.world.setup import Setup
from tests.teams import stroke, team

LINE = [(100.0, 350.0), (300.0, 350.0), (500.0, 350.0)]


@pytest.fixture
def setup() -> Setup:
    return team(fires=[(900.0, 350.0, 20.0)])


def after(
    setup: Setup, commands: Sequence[OperatorCommand], state: SimState | None = None
) -> tuple[SimState, list[Event]]:
    state, events = state or setup.start, []
    for command in commands:
        state, new = apply_command(state, command, setup)
        events += new
    return state, events


def test_a_stroke_becomes_the_path_of_the_robot_that_it_names(setup: Setup) -> None:
    state, events = after(setup, stroke(LINE, robot=1))
    assert state.intent.influenced == 1
    assert state.motion.path_status == PathStatus.FOLLOWING
    assert state.intent.path.length == pytest.approx(400.0, abs=1.0)
    assert "new open path of 400 m" in events[-1].text
    assert len(state.pointer_state.stroke) == 0


def test_a_growing_stroke_is_visible_and_influences_no_robot(setup: Setup) -> None:
    state, _ = after(setup, [StrokeBegin(), StrokePoints(floats(LINE)), StrokePoints(floats([(600, 400)]))])
    assert len(state.pointer_state.stroke) == 4
    assert state.intent.path.kind == PathKind.NONE


def test_points_of_another_source_do_not_enter_a_stroke(setup: Setup) -> None:
    state, _ = after(setup, [StrokeBegin(source="gaze"), StrokePoints(floats(LINE), source="console")])
    assert len(state.pointer_state.stroke) == 0


def test_a_cancelled_stroke_leaves_the_path_in_force(setup: Setup) -> None:
    state, _ = after(setup, [*stroke(LINE), StrokeBegin(), StrokePoints(floats(LINE)), StrokeCancel()])
    assert state.intent.path.length == pytest.approx(400.0, abs=1.0)
    assert len(state.pointer_state.stroke) == 0


def test_a_stroke_under_three_distinct_points_is_refused_with_the_reason_and_the_path_stays(setup: Setup) -> None:
    before, _ = after(setup, stroke(LINE))
    state, events = after(setup, stroke([(1, 1), (1, 1), (50, 1)], robot=2), before)
    assert events[-1].kind == "refused"
    assert "at least 3 distinct points; this one has 2" in events[-1].text
    assert state.intent == before.intent


def test_a_stroke_that_leaves_the_arena_is_clipped_and_reported(setup: Setup) -> None:
    state, events = after(setup, stroke([(100, 350), (800, 600), (900, 900), (1100, 600)]))
    points = path_points(state.intent.path, floats(np.linspace(0, state.intent.path.length, 300)))
    assert points[:, 1].max() < 710.0
    assert [e.kind for e in events][-1] == "clipped"


def test_open_closed_and_self_crossing_strokes_make_paths(setup: Setup) -> None:
    turn = np.linspace(0, 2 * np.pi, 200)
    circle = np.stack([600 + 150 * np.cos(turn), 350 + 150 * np.sin(turn)], axis=1)
    eight = np.stack([600 + 200 * np.sin(turn), 350 + 100 * np.sin(2 * turn)], axis=1)
    assert not after(setup, stroke(LINE))[0].intent.path.closed
    assert after(setup, stroke(floats(circle)))[0].intent.path.closed
    assert after(setup, stroke(floats(eight)))[0].intent.path.closed


def test_picking_another_robot_keeps_path_and_progress(setup: Setup) -> None:
    state, _ = after(setup, stroke(LINE, robot=0))
    for _ in range(100):
        state, _ = advance(state, setup.world, setup.params)
    picked, events = after(setup, [Pick(2)], state)
    assert picked.intent.influenced == 2
    assert picked.intent.path is state.intent.path
    assert picked.motion.path_parameter == state.motion.path_parameter
    assert events[0].text == "Robot 3 is now the influenced robot."


@pytest.mark.parametrize("robot", [-1, 3, 99])
def test_a_robot_that_does_not_exist_cannot_be_picked(setup: Setup, robot: int) -> None:
    state, events = after(setup, [Pick(robot)])
    assert state == setup.start
    assert f"no robot {robot + 1}: the team has robots 1 to 3" in events[0].text


UP = [(100, 350), (100, 500), (100, 600)]


def drawn(robot: int | None = None) -> list[OperatorCommand]:
    """A stroke that becomes a pending path."""
    return [*stroke(LINE)[:2], StrokeEnd(robot=robot, preview=True)]


def test_a_pending_path_influences_no_robot(setup: Setup) -> None:
    before, _ = after(setup, [*stroke(UP), Pick(1)])
    state, events = after(setup, drawn(robot=2), before)
    assert (state.motion, state.intent) == (before.motion, before.intent)
    assert state.pointer_state.pending.length == pytest.approx(400.0, abs=1.0)
    assert "400 m is pending" in events[-1].text


def test_a_confirmed_path_is_joined_from_the_present_position_of_the_robot(setup: Setup) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    circle = floats(np.stack([600.0 + 150.0 * np.cos(turn), 350.0 + 150.0 * np.sin(turn)], axis=1))
    pending, _ = after(setup, [*stroke(circle)[:2], StrokeEnd(preview=True)])
    position = pending.motion.position + np.array([600.0 - pending.motion.position[0, 0], 200.0])  # above the centre
    state, events = after(setup, [Confirm()], pending._replace(motion=pending.motion._replace(position=position)))
    assert state.motion.path_parameter == pytest.approx(150.0 * np.pi / 2, abs=2.0)
    assert state.intent.path is pending.pointer_state.pending
    assert state.pointer_state.pending is NO_PATH
    assert "Robot 1 follows" in events[-1].text


def test_a_confirmed_path_goes_to_the_named_robot_else_to_the_influenced_one(setup: Setup) -> None:
    assert after(setup, [*drawn(robot=2), Confirm()])[0].intent.influenced == 2
    assert after(setup, [*drawn(), Pick(1), Confirm()])[0].intent.influenced == 1


@pytest.mark.parametrize(
    "ending",
    [[Discard()], [Discard(proposal=False)], [EmergencyStop()], [ResetRun()], [ClearPath(), *stroke(UP), ClearPath()]],
)
def test_a_discard_a_stop_a_reset_and_a_new_path_drop_the_pending_path(
    setup: Setup, ending: list[OperatorCommand]
) -> None:
    state, _ = after(setup, [*drawn(), *ending])
    assert state.pointer_state.pending is NO_PATH
    confirmed, events = after(setup, [Confirm()], state)
    assert confirmed.intent.path is NO_PATH
    assert events[-1].text == "Nothing is pending."


@pytest.mark.parametrize("end", [StrokeCancel(), StrokeEnd(preview=True)])
def test_a_refused_stroke_keeps_the_pending_path(setup: Setup, end: OperatorCommand) -> None:
    before, _ = after(setup, drawn())
    state, _ = after(setup, [StrokeBegin(), StrokePoints(floats([(600, 400)])), end], before)
    assert state.pointer_state.pending is before.pointer_state.pending


def test_a_path_alone_can_be_discarded_and_the_proposed_robot_stays(setup: Setup) -> None:
    state, events = after(setup, [*drawn(), ProposePick(2, within=5.0), Discard(proposal=False)])
    assert (state.pointer_state.pending, state.pointer_state.proposed) == (NO_PATH, 2)
    assert events[-1].text == "The pending path or proposal is discarded."
    assert after(setup, [Discard(proposal=False)], state) == (state, [])


def test_a_pending_path_for_an_unknown_robot_is_refused(setup: Setup) -> None:
    state, events = after(setup, drawn(robot=7))
    assert state.pointer_state.pending is NO_PATH
    assert "no robot 8" in events[-1].text


def test_a_proposed_robot_waits_and_is_picked_by_a_confirm(setup: Setup) -> None:
    proposed, events = after(setup, [ProposePick(2, confidence=0.55)])
    assert proposed.intent.influenced == 0
    assert "Robot 3 is proposed (confidence 0.55)" in events[-1].text
    picked, _ = after(setup, [Confirm(source="emg")], proposed)
    assert (picked.intent.influenced, picked.pointer_state.proposed) == (2, NOBODY)


def test_a_confirm_gives_the_pending_path_to_the_proposed_robot(setup: Setup) -> None:
    state, _ = after(setup, [ProposePick(1), *drawn(), Confirm()])
    assert (state.intent.influenced, state.intent.path.kind) == (1, PathKind.SPLINE)


@pytest.mark.parametrize("ending", [Discard(), EmergencyStop(), ResetRun(), Pick(1), ProposePick(0)])
def test_a_discard_a_stop_a_reset_and_a_pick_drop_the_proposed_robot(setup: Setup, ending: OperatorCommand) -> None:
    state, _ = after(setup, [ProposePick(2), ending, Confirm()])
    assert state.intent.influenced != 2


def test_a_proposal_expires(setup: Setup) -> None:
    state, _ = after(setup, [ProposePick(2, within=0.5)])
    for _ in range(26):
        state, _ = advance(state, setup.world, setup.params)
    late, events = after(setup, [Confirm()], state)
    assert late.intent.influenced == 0
    assert events[-1].kind == "refused"


def test_a_proposal_of_an_unknown_robot_is_refused(setup: Setup) -> None:
    state, events = after(setup, [ProposePick(3)])
    assert state.pointer_state.proposed == NOBODY
    assert "no robot 4" in events[-1].text


def test_clear_removes_and_reverse_turns_the_path(setup: Setup) -> None:
    state, _ = after(setup, [*stroke(LINE), ReversePath()])
    assert state.intent.path.direction == -1.0
    assert state.motion.path_status == PathStatus.FOLLOWING
    cleared, _ = after(setup, [ClearPath()], state)
    assert cleared.intent.path.kind == PathKind.NONE
    assert after(setup, [ReversePath()], cleared)[1][0].kind == "refused"


def test_next_task_ends_the_human_intention_and_keeps_the_path_visible(setup: Setup) -> None:
    state, _ = after(setup, [*stroke(LINE), NextTask()])
    assert state.motion.path_status == PathStatus.FINISHED
    assert state.intent.path.kind == PathKind.SPLINE


def test_a_stop_is_latched_until_two_steps_and_leaves_the_team_paused(setup: Setup) -> None:
    stopped, _ = after(setup, [EmergencyStop()])
    assert stopped.intent.stopped
    still, events = after(setup, [Resume(), ResetEmergencyStop()], stopped)
    assert still.intent.stopped
    assert [e.kind for e in events] == ["refused", "refused"]
    free, _ = after(setup, [AskReset(), ResetEmergencyStop()], stopped)
    assert (free.intent.stopped, free.intent.paused) == (False, True)
    assert not after(setup, [Resume()], free)[0].intent.paused


def test_a_second_stop_cancels_the_first_step_of_a_reset(setup: Setup) -> None:
    state, _ = after(setup, [EmergencyStop(), AskReset(), EmergencyStop(), ResetEmergencyStop()])
    assert state.intent.stopped


def test_pause_resume_clutch_and_cursor_are_state(setup: Setup) -> None:
    state, _ = after(setup, [Pause(), Clutch(True), Cursor(floats([3.0, 4.0]))])
    assert (state.intent.paused, state.pointer_state.clutch, state.pointer_state.cursor.tolist()) == (
        True,
        True,
        [3.0, 4.0],
    )
    state, _ = after(setup, [Resume(), Clutch(False), Cursor(floats([math.nan, math.nan]))], state)
    assert (state.intent.paused, state.pointer_state.clutch) == (False, False)
    assert np.isnan(state.pointer_state.cursor).all()


def test_a_reset_run_restarts_from_the_initial_state_of_the_scenario(setup: Setup) -> None:
    state, _ = after(setup, stroke(LINE))
    for _ in range(20):
        state, _ = advance(state, setup.world, setup.params)
    assert after(setup, [ResetRun()], state)[0] == setup.start


@pytest.mark.parametrize("how", ControlChange)
def test_a_change_of_control_is_reported_with_its_page_and_moves_nothing(setup: Setup, how: ControlChange) -> None:
    state, events = after(setup, [HandOver("Browser 2", how, operator="Browser 1")])
    assert state is setup.start
    assert [event.kind for event in events] == ["control"]
    assert "Browser 2" in events[0].text


def test_the_report_of_a_lost_control_states_that_nobody_steers(setup: Setup) -> None:
    _, events = after(setup, [HandOver("", how, operator="Browser 1") for how in ("released", "lost")])
    assert all("Browser 1" in event.text and "nobody steers" in event.text for event in events)


def test_a_reset_of_the_run_leaves_a_stop_latched(setup: Setup) -> None:
    state, _ = after(setup, [EmergencyStop(), ResetRun()])
    assert state.intent.stopped and state.intent.paused
    state, _ = after(setup, [AskReset(), ResetEmergencyStop(), ResetRun()], state)
    assert not state.intent.stopped and not state.intent.paused


def test_a_stroke_for_an_unknown_robot_is_refused_as_a_whole(setup: Setup) -> None:
    state, events = after(setup, stroke(LINE, robot=8))
    assert [event.kind for event in events] == ["refused"]
    assert "There is no robot 9" in events[0].text
    assert state.intent.path.kind == PathKind.NONE
    assert state.pointer_state.paths == ()


@pytest.mark.parametrize("end", [StrokeEnd, StrokeCancel])
def test_only_the_drawing_interface_and_the_session_may_end_a_stroke(
    setup: Setup, end: type[StrokeEnd | StrokeCancel]
) -> None:
    begin, points, _ = stroke(LINE)
    drawn, _ = after(setup, [StrokeBegin(source="gaze"), begin, points])
    state, events = after(setup, [end(source="gaze")], drawn)
    assert state is drawn and events == []
    for source in ("console", "session"):
        state, _ = after(setup, [end(source=source)], drawn)
        assert len(state.pointer_state.stroke) == 0


@pytest.mark.parametrize(
    ("before", "reason"), [(EmergencyStop(), "the STOP is active"), (Pause(), "the team is paused")]
)
def test_a_path_that_is_drawn_while_the_team_stands_says_that_it_waits(
    setup: Setup, before: OperatorCommand, reason: str
) -> None:
    state, events = after(setup, [before, *stroke(LINE)])
    assert state.intent.path.kind == PathKind.SPLINE
    assert "waits" in events[-1].text
    assert reason in events[-1].text
    assert events[-1].severity == Severity.WARNING
