"""What each operator command means, and what refusing one leaves untouched."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from higvf_console.arrays import floats
from higvf_console.commands import (
    AskReset,
    ClearPath,
    Clutch,
    Cursor,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    ResetRun,
    ResetStop,
    Resume,
    ReversePath,
    Stop,
    StrokeBegin,
    StrokeCancel,
    StrokePoints,
)
from higvf_console.control.paths import path_points
from higvf_console.sim.operator import apply_command
from higvf_console.sim.setup import Event, Setup
from higvf_console.sim.simulation import advance
from higvf_console.state import PathKind, PathStatus, SimState
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
        state, said = apply_command(state, command, setup)
        events += said
    return state, events


def test_a_stroke_becomes_the_path_of_the_robot_that_it_names(setup: Setup) -> None:
    state, events = after(setup, stroke(LINE, robot=1))
    assert state.intent.influenced == 1
    assert state.motion.path_status == PathStatus.FOLLOWING
    assert state.intent.path.length == pytest.approx(400.0, abs=1.0)
    assert "new open path of 400 m" in events[-1].text
    assert len(state.drawing.stroke) == 0


def test_a_growing_stroke_is_seen_and_not_felt(setup: Setup) -> None:
    state, _ = after(setup, [StrokeBegin(), StrokePoints(floats(LINE)), StrokePoints(floats([(600, 400)]))])
    assert len(state.drawing.stroke) == 4
    assert state.intent.path.kind == PathKind.NONE


def test_points_of_another_source_do_not_enter_a_stroke(setup: Setup) -> None:
    state, _ = after(setup, [StrokeBegin(source="gaze"), StrokePoints(floats(LINE), source="mouse")])
    assert len(state.drawing.stroke) == 0


def test_a_cancelled_stroke_leaves_the_path_in_force(setup: Setup) -> None:
    state, _ = after(setup, [*stroke(LINE), StrokeBegin(), StrokePoints(floats(LINE)), StrokeCancel()])
    assert state.intent.path.length == pytest.approx(400.0, abs=1.0)
    assert len(state.drawing.stroke) == 0


def test_a_stroke_under_three_distinct_points_is_refused_with_the_reason_and_the_path_stays(setup: Setup) -> None:
    before, _ = after(setup, stroke(LINE))
    state, events = after(setup, stroke([(1, 1), (1, 1), (50, 1)], robot=2), before)
    assert events[-1].kind == "refused"
    assert "at least 3 distinct points; this one has 2" in events[-1].text
    assert state.intent == before.intent


def test_a_stroke_that_leaves_the_arena_is_clipped_and_said(setup: Setup) -> None:
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
        state, _ = advance(state, setup.world, setup.gains)
    picked, events = after(setup, [Pick(2)], state)
    assert picked.intent.influenced == 2
    assert picked.intent.path is state.intent.path
    assert picked.motion.path_parameter == state.motion.path_parameter
    assert events[0].text == "Robot 3 feels the human intention."


@pytest.mark.parametrize("robot", [-1, 3, 99])
def test_a_robot_that_does_not_exist_cannot_be_picked(setup: Setup, robot: int) -> None:
    state, events = after(setup, [Pick(robot)])
    assert state == setup.start
    assert f"no robot {robot + 1}: the team has robots 1 to 3" in events[0].text


def test_clear_removes_and_reverse_turns_the_path(setup: Setup) -> None:
    state, _ = after(setup, [*stroke(LINE), ReversePath()])
    assert state.intent.path.direction == -1.0
    assert state.motion.path_status == PathStatus.FOLLOWING
    cleared, _ = after(setup, [ClearPath()], state)
    assert cleared.intent.path.kind == PathKind.NONE
    assert after(setup, [ReversePath()], cleared)[1][0].kind == "refused"


def test_next_task_ends_the_human_intention_and_keeps_the_path_to_see(setup: Setup) -> None:
    state, _ = after(setup, [*stroke(LINE), NextTask()])
    assert state.motion.path_status == PathStatus.FINISHED
    assert state.intent.path.kind == PathKind.SPLINE


def test_a_stop_is_latched_until_two_steps_and_leaves_the_team_paused(setup: Setup) -> None:
    stopped, _ = after(setup, [Stop()])
    assert stopped.intent.stopped
    still, events = after(setup, [Resume(), ResetStop()], stopped)
    assert still.intent.stopped
    assert [e.kind for e in events] == ["refused", "refused"]
    free, _ = after(setup, [AskReset(), ResetStop()], stopped)
    assert (free.intent.stopped, free.intent.paused) == (False, True)
    assert not after(setup, [Resume()], free)[0].intent.paused


def test_a_second_stop_forgets_a_half_made_reset(setup: Setup) -> None:
    state, _ = after(setup, [Stop(), AskReset(), Stop(), ResetStop()])
    assert state.intent.stopped


def test_pause_resume_clutch_and_cursor_are_state(setup: Setup) -> None:
    state, _ = after(setup, [Pause(), Clutch(True), Cursor(floats([3.0, 4.0]))])
    assert (state.intent.paused, state.drawing.clutch, state.drawing.cursor.tolist()) == (True, True, [3.0, 4.0])
    state, _ = after(setup, [Resume(), Clutch(False), Cursor(floats([math.nan, math.nan]))], state)
    assert (state.intent.paused, state.drawing.clutch) == (False, False)
    assert np.isnan(state.drawing.cursor).all()


def test_a_reset_run_starts_from_the_scenarios_own_state(setup: Setup) -> None:
    state, _ = after(setup, stroke(LINE))
    for _ in range(20):
        state, _ = advance(state, setup.world, setup.gains)
    assert after(setup, [ResetRun()], state)[0] == setup.start
