"""An undo reverts one action; elapsed time stays, and no robot moves after a STOP."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    AskReset,
    ClearPath,
    Clutch,
    EmergencyStop,
    LoadScenario,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    ProposePick,
    Redo,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    ShapePath,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    Undo,
)
from higvf_console.core.edits import AddEntity, ChangeEntity, DeleteEntity, MoveEntity, SetParameters
from higvf_console.core.state import NOBODY, PathKind, PathStatus
from higvf_console.runtime.history import KEPT
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import parse_scenario
from tests.teams import stroke
from tests.world.editing.actions import GIVEN, HAIR, SCENE, assert_same, edited_run, give, go, refused, shortfalls

WAY = stroke([(700.0, 300.0), (500.0, 450.0), (300.0, 450.0), (200.0, 600.0)])


def test_without_an_action_there_is_nothing_to_undo_or_redo() -> None:
    run = edited_run()
    refused = run.apply(Undo())[0]
    assert (refused.text, refused.command) == ("Not done: nothing to undo.", "Undo")
    assert run.apply(Redo())[0].text == "Not done: nothing to redo."


def test_robots_that_an_action_did_not_move_stay_where_they_have_come_to() -> None:
    run = edited_run(ticks=10)
    started = run.state.motion.position[1].copy()
    give(run, MoveEntity("robot", 1, floats([200.0, 600.0])))
    go(run)
    came_to = run.state.motion.position.copy()
    give(run, Undo())
    assert run.state.motion.position[[0, 2, 3]].tobytes() == came_to[[0, 2, 3]].tobytes()
    assert np.hypot(*(run.state.motion.position[1] - started)) < 60.0
    assert run.state.motion.tick == 70


def test_a_fire_keeps_what_it_has_grown_and_a_deleted_one_comes_back_as_it_was() -> None:
    run = edited_run(ticks=10)
    give(run, MoveEntity("fire", 1, floats([1000.0, 100.0])), DeleteEntity("fire", 0))
    then = run.history.done[-1].before.state.motion.fire_radius[0]
    go(run)
    grown = run.state.motion.fire_radius[0]
    give(run, Undo(), Undo())
    assert run.state.motion.fire_radius.tolist() == [then, grown]
    assert run.setup.world.fire_position[1].tolist() == [900.0, 600.0]


def test_a_robot_that_was_deleted_comes_back_where_it_was_or_as_near_as_is_safe() -> None:
    run = edited_run(ticks=10)
    place = run.state.motion.position[2].copy()
    give(run, DeleteEntity("robot", 2))
    assert len(run.state.motion.position) == 3
    give(run, MoveEntity("robot", 0, place))
    give(run, Undo(), Undo())
    assert run.state.motion.position[2].tolist() == place.tolist()
    give(run, Redo())
    go(run, 5)
    give(run, Undo())
    assert np.hypot(*(run.state.motion.position[2] - place)) < 40.0


def test_robots_that_stand_where_a_body_comes_back_are_set_aside_and_that_is_said() -> None:
    run = edited_run()
    give(run, DeleteEntity("circle", 1))
    driven = run.state.motion.position + floats([-50.0, 100.0])
    run.state = run.state._replace(motion=run.state.motion._replace(position=driven))
    (event,) = give(run, Undo())
    assert event.text == "Undone: Circle 2 is deleted. Robots 1, 2, 3 were in the way and are set aside."
    assert len(run.setup.world.circles) == 2
    moved = np.hypot(*(run.state.motion.position - driven).T)
    assert moved[3] == 0.0
    assert ((moved[:3] > 0.0) & (moved[:3] < 60.0)).all()
    assert shortfalls(run).max() < HAIR
    give(run, Redo(), Undo())
    assert len(run.setup.world.circles) == 2


def test_robots_that_miss_the_margin_for_noise_are_set_aside_and_no_edit_takes_their_clearance() -> None:
    scenario = parse_scenario(SCENE + "parameters: {robots: {position_noise: 1.0}}\n", "noisy.yaml")
    run = Run(scenario.setup(3), scenario.filter, scenario)
    give(run, DeleteEntity("circle", 1))
    near = run.state.motion.position.copy()
    near[0], near[1] = (650.0, 420.0), (650.0, 446.0)  # 26 m: above robot_clearance, below what noise enlarges it to
    run.state = run.state._replace(motion=run.state.motion._replace(position=near))
    assert refused(run.apply(SetParameters({"safety.robot_clearance": 26.5})))
    give(run, SetParameters({"safety.robot_clearance": 25.5}), Undo())
    (event,) = give(run, Undo())
    assert event.text.endswith("Robots 1, 2 were in the way and are set aside.")
    assert shortfalls(run).max() < HAIR


def test_what_is_new_takes_the_place_of_what_was_undone() -> None:
    run = edited_run()
    give(run, Pick(1), Pick(2), Undo(), Pick(3))
    assert [entry.undone for entry in run.history.entries()] == [False, False]
    assert refused(run.apply(Redo()))


def test_the_history_says_what_was_done_and_when() -> None:
    run = edited_run(ticks=50)
    give(run, Pick(1), ChangeEntity("fire", 0, "growth", 2.0), Undo())
    assert [(entry.time, entry.text, entry.undone) for entry in run.history.entries()] == [
        (1.0, "Robot 2 is now the influenced robot.", False),
        (1.0, "Fire 1 has growth 2 m/s.", True),
    ]


def test_only_so_many_actions_are_kept() -> None:
    run = edited_run()
    for robot in range(KEPT + 5):
        run.apply(Pick(robot % 2 + 1))
    assert len(run.history.done) == KEPT


def test_after_a_stop_no_undo_sets_the_team_in_motion() -> None:
    run = edited_run()
    give(run, *WAY, Pause(), Pick(2), Resume(), MoveEntity("robot", 3, floats([200.0, 600.0])))
    go(run, 20)
    give(run, EmergencyStop())
    for command in (Undo(), Undo(), Undo(), Redo(), Redo()):
        run.apply(command)
        assert run.state.intent.stopped
        assert run.state.intent.paused
    give(run, AskReset(), ResetEmergencyStop())
    for command in (Undo(), Undo(), Undo(), Redo(), Redo()):
        run.apply(command)
        assert run.state.intent.paused
    position = run.state.motion.position.copy()
    go(run, 20)
    assert np.abs(run.state.motion.position - position).max() < 1e-9


STEPS = st.one_of(GIVEN, st.sampled_from([(Undo(),), (Redo(),), (ResetRun(),)]), st.integers(1, 20))


@settings(max_examples=40)
@given(before=st.lists(STEPS, max_size=6), after=st.lists(st.sampled_from([Undo(), Redo()]), min_size=1, max_size=6))
def test_whatever_was_done_undo_and_redo_never_lift_a_stop_or_the_pause_after_it(
    before: list[int | tuple[OperatorCommand, ...]], after: list[OperatorCommand]
) -> None:
    run = edited_run()
    for step in before:
        if isinstance(step, int):
            go(run, step)
        else:
            give(run, *step)
    give(run, EmergencyStop())
    for command in after:
        run.apply(command)
        assert run.state.intent.stopped
    give(run, AskReset(), ResetEmergencyStop())
    for command in after:
        run.apply(command)
        assert run.state.intent.paused
        assert not run.state.intent.stopped


def test_a_path_that_was_cleared_is_taken_up_where_it_was_left() -> None:
    run = edited_run()
    give(run, *WAY)
    go(run)
    path, left = run.state.intent.path, run.state.motion.path_parameter
    give(run, ClearPath())
    go(run, 10)
    give(run, Undo())
    assert run.state.intent.path is path
    assert run.state.motion.path_parameter == left
    assert run.state.motion.path_status == PathStatus.FOLLOWING


def test_the_influenced_robot_and_its_path_come_back_when_its_deletion_is_undone() -> None:
    run = edited_run()
    give(run, Pick(2), *WAY)
    go(run, 20)
    give(run, DeleteEntity("robot", 2))
    assert run.state.intent.influenced == 0
    assert run.state.motion.path_status == PathStatus.FINISHED
    go(run, 10)
    give(run, Undo())
    assert run.state.intent.influenced == 2
    assert run.state.motion.path_status == PathStatus.FOLLOWING


def test_priorities_follow_their_robots_and_fires_and_come_back() -> None:
    run = edited_run()
    give(run, Prioritise(fires=(1,), robot=2))
    go(run, 5)
    give(run, DeleteEntity("fire", 0))
    assert run.state.intent.priority[:, :2].tolist() == [[2, 0]]
    give(run, DeleteEntity("robot", 0))
    assert run.state.intent.priority[:, :2].tolist() == [[1, 0]]
    go(run, 5)
    give(run, Undo(), Undo())
    assert run.state.intent.priority[:, :2].tolist() == [[2, 1]]
    give(run, Undo())
    assert len(run.state.intent.priority) == 0


def test_a_reset_and_another_scenario_are_undone_as_a_whole() -> None:
    for command in (ResetRun(), LoadScenario(text=SCENE.replace("radius_m: 30", "radius_m: 10"), name="other.yaml")):
        run = edited_run(ticks=30)
        before = run.run_state
        run.apply(command)
        after = run.run_state
        go(run, 5)
        give(run, Undo())
        assert run.scenario is before.scenario
        assert_same(run.state, before.state)
        give(run, Redo())
        assert run.scenario is after.scenario
        assert_same(run.state, after.state)


def test_numbers_of_fires_that_are_out_follow_the_edits() -> None:
    run = edited_run()
    while not run.tally.extinguished:
        run.step()
    assert run.tally.extinguished == (0,)
    give(run, AddEntity("fire", floats([1000.0, 200.0])), DeleteEntity("fire", 0))
    assert run.tally.extinguished == ()
    go(run, 5)
    give(run, Undo())
    assert run.tally.extinguished == (0,)
    assert run.state.motion.fire_burning.tolist() == [False, True, True]


@pytest.mark.parametrize("command", [SetParameters({"blending.cruise_speed": 40.0}), Pick(1), ShapePath(pace=0.5)])
def test_a_second_undo_takes_out_the_action_before(command: OperatorCommand) -> None:
    run = edited_run()
    give(run, *WAY)
    go(run, 5)
    before = run.run_state
    run.apply(command)
    give(run, AddEntity("circle", floats([900.0, 100.0])))
    give(run, Undo(), Undo())
    assert run.setup is before.setup
    assert_same(run.state.intent, before.state.intent)


def test_a_larger_scenario_that_was_loaded_is_undone_and_loaded_again() -> None:
    run = edited_run(ticks=30)
    larger = SCENE.replace("[640, 300]]", "[640, 300], [760, 300], [760, 250]]").replace(
        "fires: [", "fires: [{at_m: [1100, 100], radius_m: 10}, "
    )
    before = run.run_state
    give(run, Pick(1), LoadScenario(text=larger, name="larger.yaml"))
    assert (len(run.state.motion.position), len(run.state.motion.fire_radius)) == (6, 3)
    give(run, Undo())
    assert_same(run.state.motion, before.state.motion)
    give(run, Redo(), Undo(), Undo())
    assert_same(run.state, before.state)


def test_undoing_a_reset_leaves_the_hand_as_it_is() -> None:
    run = edited_run(ticks=5)
    hand = (Clutch(True), StrokeBegin(source="gaze"), StrokePoints(floats([[700, 300], [500, 450]]), source="gaze"))
    give(run, *hand, ProposePick(2), ResetRun(), Clutch(False), Undo())
    pointer_state = run.state.pointer_state
    assert (pointer_state.clutch, pointer_state.stroke_source, len(pointer_state.stroke)) == (False, "", 0)
    assert pointer_state.proposed == NOBODY
    give(run, EmergencyStop(), AskReset(), LoadScenario(text=SCENE, name="other.yaml"), Undo())
    assert refused(run.apply(ResetEmergencyStop()))


def test_a_path_that_waited_comes_back_with_the_run_that_was_reset() -> None:
    run = edited_run(ticks=5)
    give(run, *WAY[:2], StrokeEnd(robot=2, preview=True))
    waits = run.state.pointer_state.pending
    give(run, ResetRun())
    assert run.state.pointer_state.pending.kind == PathKind.NONE
    give(run, Undo())
    assert run.state.pointer_state.pending is waits
    assert run.state.pointer_state.pending_robot == 2


def test_a_clipped_stroke_stands_in_the_history_as_the_path_that_it_is() -> None:
    run = edited_run()
    give(run, *stroke([(700.0, 300.0), (500.0, -50.0), (300.0, 200.0)]))
    assert run.history.entries()[-1].text.startswith("Robot 1 follows a new open path")
