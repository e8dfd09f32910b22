"""Pace, duration and ending of a path."""

import math

import numpy as np
import pytest

from higvf_console.core.commands import OperatorCommand, Pause, Resume, ReversePath, ShapePath
from higvf_console.core.state import PathStatus, SimState
from higvf_console.operator.reducer import apply_command
from higvf_console.sim.simulation import advance
from higvf_console.world.setup import Setup
from tests.teams import stroke, team

WAY = ((100.0, 350.0), (200.0, 360.0), (300.0, 350.0), (400.0, 350.0))
AWAY = [(1000.0, 600.0, 20.0)]  # a fire that the team would go to by itself


def led(setup: Setup, *commands: OperatorCommand) -> SimState:
    state = setup.start
    for command in (*stroke(WAY), *commands):
        state, _ = apply_command(state, command, setup)
    return state


def histories(setup: Setup, state: SimState, ticks: int) -> list[SimState]:
    states = [state]
    for _ in range(ticks):
        states.append(advance(states[-1], setup.world, setup.params)[0])
    return states


def statuses(states: list[SimState]) -> list[int]:
    return [state.motion.path_status for state in states]


def test_after_a_released_path_the_team_continues_its_own_task() -> None:
    setup = team(fires=AWAY)
    states = histories(setup, led(setup), 1200)
    assert states[-1].motion.path_status == PathStatus.FINISHED
    assert np.hypot(*(states[-1].motion.position[0] - (1000.0, 600.0))) < 100.0


def test_a_holding_path_keeps_the_whole_team_at_its_end() -> None:
    setup = team(fires=AWAY)
    states = histories(setup, led(setup, ShapePath(ending="hold")), 800)
    assert PathStatus.FINISHED not in statuses(states)
    assert states[-1].motion.path_status == PathStatus.HOLDING
    began = statuses(states).index(PathStatus.HOLDING)
    assert np.hypot(*(states[began].motion.position[0] - WAY[-1])) < 60.0
    assert np.abs(states[-1].motion.position - states[began + 1].motion.position).max() < 1e-9


def test_a_hold_ends_when_the_path_is_reversed() -> None:
    setup = team()
    state = histories(setup, led(setup, ShapePath(ending="hold")), 800)[-1]
    assert state.motion.path_status == PathStatus.HOLDING
    state, _ = apply_command(state, ReversePath(), setup)
    states = histories(setup, state, 800)
    assert states[0].motion.path_status == PathStatus.FOLLOWING
    assert np.hypot(*(states[-1].motion.position[0] - WAY[0])) < 60.0


def test_a_path_that_loops_starts_again_and_never_ends() -> None:
    setup = team()
    states = histories(setup, led(setup, ShapePath(ending="loop")), 1500)
    assert set(statuses(states)) == {PathStatus.FOLLOWING}
    travelled = np.array([state.motion.path_parameter for state in states])
    assert (np.diff(travelled) < -200.0).sum() >= 1


@pytest.mark.parametrize("pace", [0.5, 1.5])
def test_the_pace_is_a_share_of_the_velocity(pace: float) -> None:
    setup = team()
    usual, paced = (
        histories(setup, led(setup, *commands), 100)[-1].motion.path_parameter
        for commands in ((), (ShapePath(pace=pace),))
    )
    assert paced == pytest.approx(pace * usual, rel=0.1)


def test_no_robot_exceeds_the_speed_limit_at_any_pace() -> None:
    setup = team()
    limit = setup.params.safety.speed_limit
    for state in histories(setup, led(setup, ShapePath(pace=1.5)), 200):
        assert np.hypot(*state.motion.velocity.T).max() <= limit + 1e-9


@pytest.mark.parametrize(("ending", "status"), [("release", "FINISHED"), ("hold", "HOLDING"), ("loop", "FINISHED")])
def test_when_its_time_is_over_a_path_ends(ending: str, status: str) -> None:
    setup = team()
    states = histories(setup, led(setup, ShapePath(ending=ending, duration=1.0)), 80)
    period = setup.params.safety.control_period
    over = next(k for k, state in enumerate(states) if state.motion.path_status != PathStatus.FOLLOWING)
    assert over * period == pytest.approx(1.0, abs=2.0 * period)
    assert states[-1].motion.path_status == PathStatus[status]


@pytest.mark.parametrize("ending", ["release", "hold"])
def test_the_duration_restarts_when_a_path_is_repaired_after_it_is_over(ending: str) -> None:
    setup = team()
    over = histories(setup, led(setup, ShapePath(ending=ending, duration=1.0)), 80)[-1]
    assert over.motion.path_left == 0.0
    back, _ = apply_command(over, ReversePath(), setup)
    assert back.motion.path_left == 1.0
    assert histories(setup, back, 30)[-1].motion.path_status == PathStatus.FOLLOWING


def test_the_duration_of_a_path_does_not_run_while_the_team_is_paused() -> None:
    setup = team()
    state, _ = apply_command(histories(setup, led(setup, ShapePath(duration=1.0)), 20)[-1], Pause(), setup)
    left = state.motion.path_left
    state = histories(setup, state, 100)[-1]
    assert state.motion.path_left == left > 0.5
    state, _ = apply_command(state, Resume(), setup)
    assert histories(setup, state, 45)[-1].motion.path_status == PathStatus.FINISHED


def test_only_a_new_duration_restarts_the_time_of_a_path() -> None:
    setup = team()
    state = histories(setup, led(setup, ShapePath(duration=5.0)), 50)[-1]
    assert state.motion.path_left == pytest.approx(4.0)
    paced, _ = apply_command(state, ShapePath(pace=0.5), setup)
    assert paced.motion.path_left == state.motion.path_left
    renewed, _ = apply_command(state, ShapePath(duration=2.0), setup)
    assert renewed.motion.path_left == 2.0
    endless, _ = apply_command(state, ShapePath(duration=0.0), setup)
    assert endless.motion.path_left == math.inf
