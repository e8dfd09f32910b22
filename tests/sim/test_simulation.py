"""The pure step: the same bytes alone, rolled, and in another process; pause, stop; the circle cases of the paper."""

import hashlib
import subprocess
import sys

import numpy as np
import pytest

from higvf_console.control.guidance.field import FieldKind, field_at
from higvf_console.control.guidance.paths import circle_path
from higvf_console.control.safety.coupled_filter import CoupledFilter
from higvf_console.core.state import NOBODY, PathStatus, SimState
from higvf_console.operator.path_commands import follow
from higvf_console.operator.reducer import apply_command
from higvf_console.scenario.scenario import load_scenario
from higvf_console.sim.simulation import advance, advance_coupled, roll
from higvf_console.world.setup import Setup, with_params
from tests.teams import stroke, team

FIRES = ((600.0, 350.0, 30.0), (900.0, 500.0, 20.0))


def firefighting() -> Setup:
    return load_scenario("firefighting").setup(0)


def digest(state: SimState) -> str:
    parts = [state.motion.position, state.motion.velocity, state.motion.intention, state.motion.fire_radius]
    return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()


def ran(setup: Setup, ticks: int, state: SimState | None = None) -> SimState:
    state = setup.start if state is None else state
    for _ in range(ticks):
        state, _ = advance(state, setup.world, setup.params)
    return state


def test_a_roll_gives_the_states_of_repeated_advances_bit_for_bit() -> None:
    setup = firefighting()
    rolled, history = roll(setup.start, setup.world, setup.params, 900)
    state = setup.start
    for k in range(900):
        state, trace = advance(state, setup.world, setup.params)
        assert history.position[k].tobytes() == state.motion.position.tobytes()
        assert history.clearance[k] == trace.clearance.min()
    for one, other in zip(rolled.motion, state.motion, strict=True):
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()


def test_another_process_computes_the_same_bytes() -> None:
    program = (
        "from tests.sim.test_simulation import digest, firefighting\n"
        "from higvf_console.sim.simulation import roll\n"
        "s = firefighting(); print(digest(roll(s.start, s.world, s.params, 900)[0]))"
    )
    there = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    setup = firefighting()
    assert there.stdout.strip() == digest(roll(setup.start, setup.world, setup.params, 900)[0])


def test_a_step_changes_nothing_of_the_state_that_it_was_given() -> None:
    setup = firefighting()
    state = ran(setup, 100)
    before = [np.array(part) for part in state.motion]
    advance(state, setup.world, setup.params)
    for one, other in zip(before, state.motion, strict=True):
        assert (one == np.asarray(other)).all()


def test_paused_robots_hold_and_the_world_goes_on() -> None:
    setup = team(fires=FIRES)
    state = ran(setup, 50)
    state = state._replace(intent=state.intent._replace(paused=True))
    later = ran(setup, 50, state)
    assert (later.motion.position == state.motion.position).all()
    assert (later.motion.intention == state.motion.intention).all()
    assert later.motion.fire_radius == pytest.approx(state.motion.fire_radius + 1.0)


def test_a_paused_robot_yields_to_a_fire_that_grows_towards_it() -> None:
    setup = team(robots=[(100.0, 100.0)], fires=[(150.0, 100.0, 30.0)], needs=2)
    state = setup.start._replace(intent=setup.start.intent._replace(paused=True))
    nearest = 1e9
    for _ in range(1500):
        state, trace = advance(state, setup.world, setup.params)
        nearest = min(nearest, trace.clearance.min())
    assert state.motion.position[0, 0] < 100.0
    assert nearest >= 0.0


def test_a_stopped_team_does_not_move_at_all_not_even_from_a_fire_that_reaches_it() -> None:
    setup = team(robots=[(100.0, 100.0)], fires=[(150.0, 100.0, 30.0)], needs=2)
    state = setup.start._replace(intent=setup.start.intent._replace(stopped=True))
    nearest = 1e9
    for _ in range(1000):
        state, trace = advance(state, setup.world, setup.params)
        nearest = min(nearest, trace.clearance.min())
    assert (state.motion.position == setup.start.motion.position).all()
    assert not state.motion.velocity.any()
    assert nearest < 0.0


def test_an_idle_team_has_no_intention() -> None:
    setup = team()
    state = ran(setup, 20)
    assert not state.motion.intention.any()
    assert (state.motion.target == NOBODY).all()


def test_robots_set_out_after_the_start_delay() -> None:
    base = team(fires=FIRES)
    setup = with_params(base, base.params._replace(fires=base.params.fires._replace(start_delay=1.0)))
    waiting = ran(setup, 50)
    assert (waiting.motion.position == setup.start.motion.position).all()
    assert ran(setup, 60, waiting).motion.position[0, 0] > setup.start.motion.position[0, 0]


def test_the_influenced_robot_follows_a_stroke_and_then_the_team_is_released() -> None:
    setup = team()
    state = setup.start
    for command in stroke([(120, 350), (300, 350), (420, 450), (520, 600)], robot=0):
        state, _ = apply_command(state, command, setup)
    for _ in range(2000):
        state, _ = advance(state, setup.world, setup.params)
        if state.motion.path_status != PathStatus.FOLLOWING:
            break
    assert state.motion.path_status == PathStatus.FINISHED
    assert np.hypot(*(state.motion.position[0] - (520, 600))) <= setup.params.path.end_radius
    resting = ran(setup, 300, state)
    assert np.hypot(*resting.motion.velocity.T).max() < 1.0


def test_a_path_is_not_finished_before_its_end_even_within_the_end_radius() -> None:
    setup = team(robots=[(470.0, 350.0)])
    state = setup.start
    for command in stroke([(100, 350), (300, 350), (500, 350)], robot=0):
        state, _ = apply_command(state, command, setup)
    state = state._replace(motion=state.motion._replace(path_parameter=370.0))
    assert ran(setup, 5, state).motion.path_status == PathStatus.FOLLOWING
    assert ran(setup, 200, state).motion.path_status == PathStatus.FINISHED


def test_a_path_whose_end_cannot_be_reached_is_given_up_and_flagged() -> None:
    setup = team(circles=[(500.0, 350.0, 90.0)])
    state = setup.start
    for command in stroke([(120, 350), (300, 350), (500, 350)], robot=0):
        state, _ = apply_command(state, command, setup)
    for _ in range(3000):
        state, trace = advance(state, setup.world, setup.params)
        assert trace.clearance.min() >= 0.0
        if state.motion.path_status == PathStatus.BLOCKED:
            return
    pytest.fail("the path was never given up")


@pytest.mark.parametrize(
    "name", ["circle-inside", "circle-outside", "circle-inside-corrected", "circle-outside-corrected"]
)
def test_after_one_lap_the_influenced_robot_is_within_one_percent_of_the_circle(name: str) -> None:
    setup = load_scenario(name).setup(0)
    centre = setup.start.intent.path.shape[:2]
    _, history = roll(setup.start, setup.world, setup.params, 6000)
    offset = history.position[:, setup.start.intent.influenced] - centre
    angle = np.unwrap(np.arctan2(offset[:, 1], offset[:, 0]))
    after = np.abs(angle - angle[0]) > 2.0 * np.pi
    error = np.abs(np.hypot(*offset[after].T) - 250.0) / 250.0
    assert after.sum() > 1500
    assert error.mean() < 0.01
    assert error.max() < 0.03


def test_obstacles_on_the_circle_are_passed_lap_after_lap() -> None:
    setup = load_scenario("circle-obstacles").setup(0)
    _, history = roll(setup.start, setup.world, setup.params, 6000)
    robot, centre = setup.start.intent.influenced, setup.start.intent.path.shape[:2]
    offset = history.position[:, robot] - centre
    angle = np.unwrap(np.arctan2(offset[:, 1], offset[:, 0]))
    assert angle[-1] - angle[0] > 2.0 * (2.0 * np.pi)
    second = np.hypot(*(history.position[50:, robot] - history.position[:-50, robot]).T)  # way in one second [m]
    assert second.min() > 5.0
    assert history.clearance.min() >= 0.0


def test_the_centralised_filter_keeps_clearance_and_the_order_of_fires() -> None:
    setup = firefighting()
    safety = CoupledFilter()
    state, out = setup.start, []
    for _ in range(5000):
        was = state.motion.fire_burning
        state, trace = advance_coupled(state, setup.world, setup.params, safety)
        out += list(np.flatnonzero(was & ~state.motion.fire_burning))
        assert trace.clearance.min() >= 0.0
        if not state.motion.fire_burning.any():
            break
    assert out == [0, 1, 2, 3, 4]


def test_the_drawn_field_is_zero_without_a_path_and_the_path_field_with_one() -> None:
    setup = team()
    points = np.array([[300.0, 350.0], [10.0, 10.0]])
    assert not field_at(FieldKind.PATH, points, setup.start, setup.world, setup.params).any()
    state = follow(setup.start, circle_path(300, 350, 100))
    field = field_at(FieldKind.PATH, points, state, setup.world, setup.params)
    assert np.hypot(*field.T) == pytest.approx([60.0, 60.0])


def test_the_blended_field_where_the_influenced_robot_stands_is_what_it_settles_to() -> None:
    setup = team()
    state = ran(setup, 400, follow(setup.start, circle_path(300, 350, 200)))
    state, trace = advance(state, setup.world, setup.params)
    here = state.motion.position[:1]
    field = field_at(FieldKind.BLENDED, np.ascontiguousarray(here), state, setup.world, setup.params)
    assert field[0] == pytest.approx(trace.blended[0], abs=3.0)
