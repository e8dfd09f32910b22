"""One command: which part of the run it changes, whether it can be undone, and what is reported."""

from dataclasses import replace

import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    ContinueRun,
    Cursor,
    Discard,
    EmergencyStop,
    LoadScenario,
    OperatorCommand,
    Pause,
    Pick,
    ProposePick,
    Redo,
    ResetRun,
    ReversePath,
    StartRun,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    StrokeUse,
    Undo,
)
from higvf_console.core.edits import DeleteEntity, MoveEntity
from higvf_console.core.errors import ScenarioError
from higvf_console.core.events import Event
from higvf_console.runtime.dispatch import dispatch, prepare, seed_of
from higvf_console.runtime.history import History, RunState, Tally
from higvf_console.runtime.phase import Phase, RunPhase
from higvf_console.scenario.scenario import Scenario, parse_scenario
from tests.teams import stroke

LINE = [(700.0, 300.0), (500.0, 450.0), (300.0, 450.0)]
ROUND = [(900.0, 500.0), (980.0, 500.0), (980.0, 580.0), (900.0, 580.0)]
OTHER = "version: 1\nname: other\narena: {size_m: [400, 300]}\nrobots: {start_m: [[100, 150], [100, 200]]}\n"

pytestmark = pytest.mark.usefixtures("plain_kernels")


@pytest.fixture(name="now")
def _now(team: Scenario) -> RunState:
    """A run of three robots and a fire that waits for its start."""
    setup = team.setup(3)
    return RunState(setup, setup.start, Tally(), team.filter, team, RunPhase(Phase.READY))


def given(
    now: RunState, *commands: OperatorCommand, history: History | None = None
) -> tuple[RunState, History, list[Event]]:
    """What becomes of a run by some commands, and the events of the last."""
    history, events = history or History(), tuple[Event, ...]()
    for command in commands:
        now, history, events = dispatch(now, history, command)
    return now, history, list(events)


def kinds(history: History) -> list[str]:
    return [action.kind for action in history.done]


def test_a_run_begins_by_its_start_and_the_history_knows_nothing_of_it(now: RunState) -> None:
    run, history, (event,) = given(now, StartRun())
    assert run.phase.phase is Phase.RUNNING
    assert run.state is now.state
    assert kinds(history) == []
    assert (event.kind, event.text) == ("run", "The run begins.")
    with pytest.raises(ScenarioError, match="the run has not ended"):
        dispatch(run, history, ContinueRun())


def test_what_the_operator_asks_of_the_team_can_be_undone_and_done_again(now: RunState) -> None:
    picked, history, (event,) = given(now, Pick(2))
    assert (picked.state.intent.influenced, kinds(history)) == (2, ["Pick"])
    assert (history.done[0].text, event.robot) == (event.text, 2)
    undone, history, (event,) = given(picked, Undo(), history=history)
    assert (undone.state.intent.influenced, event.kind) == (0, "undone")
    again, history, _ = given(undone, Redo(), history=history)
    assert (again.state.intent.influenced, kinds(history)) == (2, ["Pick"])


@pytest.mark.parametrize(
    "command",
    [Cursor(floats([1.0, 2.0])), StrokeBegin(), Pick(0), Pick(9), ReversePath()],
    ids=["pointer", "beginning of a stroke", "same robot", "no such robot", "no path"],
)
def test_what_changes_nothing_of_the_team_is_no_action_of_the_history(now: RunState, command: OperatorCommand) -> None:
    assert kinds(given(now, command)[1]) == []


def test_a_proposal_that_is_discarded_is_no_action_either_though_it_is_reported(now: RunState) -> None:
    _, history, (event,) = given(now, ProposePick(1), Discard())
    assert (event.kind, kinds(history)) == ("discarded", [])


def test_a_change_of_the_path_in_force_is_told_from_a_new_path(now: RunState) -> None:
    _, history, _ = given(now, *stroke(LINE), ReversePath())
    assert [(action.kind, action.repairs) for action in history.done] == [("StrokeEnd", False), ("ReversePath", True)]


def test_a_stop_cannot_be_undone_and_takes_the_pauses_before_it_along(now: RunState) -> None:
    run, history, (alarm,) = given(now, Pick(1), Pause(), EmergencyStop())
    assert (run.state.intent.stopped, alarm.kind, kinds(history)) == (True, "stop", ["Pick"])


def test_an_edit_changes_the_world_and_a_deleted_fire_leaves_the_tally(now: RunState) -> None:
    out = now._replace(tally=now.tally._replace(extinguished=(0,)))
    moved, history, (event,) = given(out, MoveEntity("fire", 0, floats([900.0, 600.0])))
    assert (moved.tally.extinguished, event.kind, kinds(history)) == ((0,), "edited", ["MoveEntity"])
    assert moved.setup.world.fire_position.tolist() == [[900.0, 600.0]]
    assert given(out, DeleteEntity("fire", 0))[0].tally.extinguished == ()


def test_an_edit_of_what_does_not_exist_is_refused(now: RunState) -> None:
    with pytest.raises(ScenarioError, match="circle 1"):
        dispatch(now, History(), MoveEntity("circle", 0, floats([1.0, 1.0])))


def outline(points: list[tuple[float, float]]) -> list[OperatorCommand]:
    return [StrokeBegin(), StrokePoints(floats(points)), StrokeEnd(use=StrokeUse.OBSTACLE)]


def test_a_stroke_round_free_ground_makes_an_obstacle_and_ends(now: RunState) -> None:
    run, history, events = given(now, *outline(ROUND))
    assert (events[0].kind, kinds(history)) == ("edited", ["AddOutlines"])
    assert (len(run.setup.layout.obstacles.polygons), len(run.state.pointer_state.stroke)) == (1, 0)


def test_a_stroke_that_goes_round_nothing_makes_no_obstacle_and_ends_too(now: RunState) -> None:
    run, history, (event,) = given(now, *outline(ROUND[:2]))
    assert event.kind == "refused"
    assert event.text.startswith("No obstacle: ")
    assert run.setup is now.setup
    assert (len(run.state.pointer_state.stroke), kinds(history)) == (0, [])


def test_a_reset_begins_anew_and_is_undone_as_a_whole(now: RunState) -> None:
    late = now._replace(
        state=now.state._replace(motion=now.state.motion._replace(tick=500)),
        tally=now.tally._replace(extinguished=(0,)),
        phase=RunPhase(Phase.RUNNING),
    )
    run, history, _ = given(late, ResetRun())
    assert run.state.motion.tick == 0
    assert run.tally.extinguished == ()
    assert history.done[-1].whole
    assert given(run, Undo(), history=history)[0].tally.extinguished == (0,)


@pytest.mark.parametrize(("waits", "phase"), [(True, Phase.READY), (False, Phase.RUNNING)])
def test_another_scenario_replaces_world_and_state_and_keeps_the_seed(now: RunState, waits: bool, phase: Phase) -> None:
    run, history, events = given(now, LoadScenario(OTHER, "other.yaml", waits=waits))
    assert (len(run.state.motion.position), run.phase.phase, seed_of(run.setup)) == (2, phase, 3)
    assert events[0].text == "The scenario 'other' is loaded."
    assert history.done[-1].whole


def test_a_scenario_that_was_prepared_ahead_is_taken_over_and_not_read_again(now: RunState) -> None:
    prepared = prepare(LoadScenario(OTHER, "other.yaml"), 5)
    run, _, _ = dispatch(now, History(), LoadScenario("not: yaml: at all", "other.yaml"), prepared)
    assert run.setup is prepared.setup
    assert run.scenario is prepared.scenario


def test_a_scenario_that_cannot_be_read_is_refused(now: RunState) -> None:
    with pytest.raises(ScenarioError, match=r"other\.yaml"):
        dispatch(now, History(), LoadScenario("version: 1\nrobots: none\n", "other.yaml"))


def test_what_a_scenario_warns_of_is_reported(now: RunState) -> None:
    old = replace(parse_scenario(OTHER, "other.yaml"), warnings=("a key is renamed",))
    prepared = prepare(LoadScenario(OTHER, "other.yaml"), 0)._replace(scenario=old)
    _, _, events = dispatch(now, History(), LoadScenario(OTHER, "other.yaml"), prepared)
    assert [(event.time, event.kind, event.text) for event in events[1:]] == [(0.0, "scenario", "a key is renamed")]
