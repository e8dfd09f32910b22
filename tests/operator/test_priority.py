"""Priority: the operator multiplies the value of a fire for one robot."""

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import OperatorCommand, Prioritise, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.state import SimState
from higvf_console.operator.reducer import apply_command
from higvf_console.sim.simulation import advance
from higvf_console.world.setup import Setup
from tests.teams import team

FIRES = [(300.0, 350.0, 30.0), (600.0, 350.0, 10.0)]
ROUND_SECOND = [(560.0, 310.0), (640.0, 310.0), (640.0, 390.0), (560.0, 390.0)]


def after(setup: Setup, *commands: OperatorCommand) -> SimState:
    state = setup.start
    for command in commands:
        state, _ = apply_command(state, command, setup)
    return state


def targets(setup: Setup, state: SimState) -> list[int]:
    return advance(state, setup.world, setup.params)[0].motion.target.tolist()


def test_a_robot_goes_to_its_prioritised_fire_and_the_others_follow_their_perception() -> None:
    setup = team(fires=FIRES)
    assert targets(setup, setup.start) == [0, 0, 0]
    assert targets(setup, after(setup, Prioritise(fires=(1,), robot=2))) == [0, 0, 1]


def test_the_value_of_a_prioritised_fire_ignores_occlusion() -> None:
    setup = team([(100.0, 350.0)], FIRES, bars=[(400.0, 200.0, 400.0, 500.0, 6.0)])
    plain, pointed = (
        advance(state, setup.world, setup.params)[1].fire_value[0]
        for state in (setup.start, after(setup, Prioritise(fires=(1,), factor=3.0)))
    )
    free = team([(100.0, 350.0)], FIRES[1:])
    seen = advance(free.start, free.world, free.params)[1].fire_value[0, 0]
    assert plain[1] == 0.0
    assert pointed.tolist() == [plain[0], pytest.approx(3.0 * seen)]


def test_a_stroke_round_a_fire_prioritises_it_for_the_influenced_robot() -> None:
    setup = team(fires=FIRES)
    state = after(setup, StrokeBegin(), StrokePoints(floats(ROUND_SECOND)), StrokeEnd(use="priority"))
    assert state.intent.priority.tolist() == [[0.0, 1.0, setup.params.perception.priority]]
    assert state.intent.path is setup.start.intent.path
    assert len(state.pointer_state.stroke) == 0


def test_a_stroke_round_no_burning_fire_is_refused() -> None:
    setup = team(fires=FIRES)
    out = setup.start.motion._replace(fire_burning=np.array([True, False]))
    state = setup.start._replace(motion=out)
    for command in (StrokeBegin(), StrokePoints(floats(ROUND_SECOND))):
        state, _ = apply_command(state, command, setup)
    ended, events = apply_command(state, StrokeEnd(use="priority"), setup)
    assert ended.intent is state.intent
    assert events[0].text == "No priority: no burning fire has its centre inside the stroke."


def test_new_priorities_replace_only_those_of_the_same_robot() -> None:
    setup = team(fires=FIRES)
    state = after(setup, Prioritise(fires=(0, 1), robot=1), Prioritise(fires=(1,), robot=2, factor=2.0))
    state, _ = apply_command(state, Prioritise(fires=(0,), robot=1, factor=5.0), setup)
    assert sorted(state.intent.priority.tolist()) == [[1.0, 0.0, 5.0], [2.0, 1.0, 2.0]]
    state, events = apply_command(state, Prioritise(robot=1), setup)
    assert state.intent.priority.tolist() == [[2.0, 1.0, 2.0]]
    assert events[0].text == "Robot 2 has no prioritised fires."


def test_a_priority_of_an_extinguished_fire_has_no_effect() -> None:
    setup = team(fires=FIRES)
    state = after(setup, Prioritise(fires=(1,)))
    burning = state.motion._replace(fire_burning=np.array([True, False]))
    assert targets(setup, state._replace(motion=burning)) == [0, 0, 0]


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (Prioritise(fires=(2,)), "There is no fire 3: the fires are 1 to 2."),
        (Prioritise(fires=(0,), robot=3), "There is no robot 4: the team has robots 1 to 3."),
        (Prioritise(fires=(0,), factor=0.5), "Priority factor 0.5 is below 1."),
        (Prioritise(fires=(0,), factor=float("nan")), "Priority factor nan is below 1."),
    ],
)
def test_an_invalid_priority_is_refused_and_changes_nothing(command: OperatorCommand, message: str) -> None:
    setup = team(fires=FIRES)
    state, events = apply_command(setup.start, command, setup)
    assert state is setup.start
    assert [event.text for event in events] == [message]
