"""Fires: growth, crews, progress that is kept, and the orders in which Table I's fires go out."""

from collections.abc import Sequence

import numpy as np
import pytest

from higvf_console.core.commands import OperatorCommand, Pause, Pick, Resume
from higvf_console.core.state import Motion, SimState
from higvf_console.operator.reducer import apply_command
from higvf_console.scenario.scenario import load_scenario
from higvf_console.sim.events import events_between
from higvf_console.sim.simulation import advance
from higvf_console.world.setup import Setup
from tests.teams import stroke, team

PRIORITY = [(520.0, 190.0), (450.0, 130.0), (370.0, 100.0), (300.0, 90.0)]
HIDDEN = [(640.0, 530.0), (740.0, 520.0), (840.0, 490.0), (920.0, 440.0)]
ROUND_THE_BAR = [(430.0, 400.0), (540.0, 410.0), (640.0, 410.0), (730.0, 370.0), (780.0, 310.0)]


def unnamed(_robot: int, _motion: Motion) -> str:
    return "is too near"


def order_and_loss(
    setup: Setup, after_fire: int | None = None, commands: Sequence[OperatorCommand] = ()
) -> tuple[list[int], list[float]]:
    """Fire numbers in the order in which they went out, and their loss areas; `commands` when `after_fire` is out."""
    state, out = setup.start, list[int]()
    for _ in range(6000):
        was = state.motion.fire_burning
        state, trace = advance(state, setup.world, setup.params)
        assert trace.clearance.min() >= 0.0
        gone = [int(fire) + 1 for fire in np.flatnonzero(was & ~state.motion.fire_burning)]
        out += gone
        if after_fire in gone:
            for command in commands:
                state, _ = apply_command(state, command, setup)
        if not state.motion.fire_burning.any():
            break
    return out, list(np.pi * state.motion.fire_radius**2)


def test_without_operator_the_fires_go_out_in_their_order_and_two_strokes_improve_on_it() -> None:
    setup = load_scenario("firefighting").setup(0)
    order, loss = order_and_loss(setup)
    priority_order, priority = order_and_loss(setup, 1, stroke(PRIORITY, robot=0))
    hidden_order, hidden = order_and_loss(setup, 4, stroke(HIDDEN, robot=0))
    assert order == [1, 2, 3, 4, 5]
    assert priority_order == [1, 3, 2, 4, 5]
    assert hidden_order == [1, 2, 3, 4, 5]
    assert sum(priority) < sum(loss)
    assert [p > n for p, n in zip(priority, loss, strict=True)] == [False, True, False, False, False]
    assert priority[0] == loss[0]
    assert hidden[:4] == loss[:4]
    assert hidden[4] < loss[4]


def test_behind_the_barrier_the_operator_changes_the_order_and_reduces_the_loss() -> None:
    setup = load_scenario("barrier-gaze").setup(0)
    alone, alone_loss = order_and_loss(setup)
    guided, guided_loss = order_and_loss(setup, 2, [Pause(), *stroke(ROUND_THE_BAR), Pick(1), Resume()])
    assert alone == [2, 1, 3]
    assert guided == [2, 3, 1]
    assert sum(guided_loss) < sum(alone_loss)


def near_a_fire(robots: int, needs: int) -> Setup:
    places = [(150.0, 100.0), (100.0, 150.0), (50.0, 100.0)]
    return team(robots=places[:robots], fires=[(100.0, 100.0, 30.0)], needs=needs)


def advanced(setup: Setup, ticks: int) -> SimState:
    state = setup.start
    for _ in range(ticks):
        state, _ = advance(state, setup.world, setup.params)
    return state


def test_a_fire_with_too_small_a_crew_grows_and_one_with_enough_stands_still() -> None:
    assert advanced(near_a_fire(1, needs=2), 50).motion.fire_radius[0] == pytest.approx(31.0)
    worked = advanced(near_a_fire(2, needs=2), 50)
    assert worked.motion.fire_radius[0] == 30.0
    assert worked.motion.fire_progress[0] == pytest.approx(1.0)


def test_a_fire_goes_out_after_kappa_times_its_radius() -> None:
    setup = near_a_fire(2, needs=2)
    seconds = setup.params.fires.extinguish_time * 30.0
    assert advanced(setup, round(seconds / 0.02) - 1).motion.fire_burning[0]
    assert not advanced(setup, round(seconds / 0.02) + 1).motion.fire_burning[0]


def test_progress_is_kept_while_the_crew_is_away() -> None:
    setup = near_a_fire(2, needs=2)
    worked = advanced(setup, 25)
    apart = worked._replace(motion=worked.motion._replace(position=worked.motion.position + 400.0))
    left, _ = advance(apart, setup.world, setup.params)
    assert left.motion.fire_progress[0] == worked.motion.fire_progress[0] > 0.0
    assert left.motion.fire_radius[0] > 30.0


def test_robots_led_by_the_human_do_not_extinguish() -> None:
    setup = near_a_fire(2, needs=2)
    state = setup.start
    for command in stroke([(150, 100), (180, 100), (400, 100)], robot=0):
        state, _ = apply_command(state, command, setup)
    _, trace = advance(state, setup.world, setup.params)
    assert trace.crew.tolist() == [0]


def test_the_end_of_a_fire_is_an_event_with_its_loss() -> None:
    setup = near_a_fire(2, needs=2)
    before = advanced(setup, 74)
    found: list[str] = []
    for _ in range(4):
        state, trace = advance(before, setup.world, setup.params)
        found += [e.text for e in events_between(before, state, None, trace, setup.params, unnamed)]
        before = state
    assert found == ["Fire 1 is out; it burnt 2\u202f827 m²."]


def test_a_stopped_robot_that_a_fire_grows_to_is_reported_once_and_a_paused_one_yields() -> None:
    setup = team(robots=[(100.0, 100.0), (400.0, 400.0)], fires=[(130.0, 100.0, 15.0)], growth=2.0)
    found: dict[bool, list[str]] = {True: [], False: []}
    for stopped, texts in found.items():
        state, trace = setup.start._replace(intent=setup.start.intent._replace(stopped=stopped, paused=True)), None
        for _ in range(500):
            before, last = state, trace
            state, trace = advance(state, setup.world, setup.params)
            events = events_between(before, state, last, trace, setup.params, unnamed)
            texts += [e.text for e in events if e.kind == "clearance"]
    assert found == {True: ["Robot 1 is too near."], False: []}
