"""The controller on positions from outside: the same method as a run, whatever comes in."""

import numpy as np
import pytest

import higvf_console as hc

TEAM = np.array([[100.0, 350.0], [60.0, 320.0], [60.0, 380.0]])
HAZARDS = hc.Hazards().circle((300, 340), 20).fire((600, 250), 20).inside((0, 0, 1200, 700))
STROKE = [[100, 350], [400, 300], [800, 350]]


def test_a_closed_loop_is_the_simulation_bit_for_bit() -> None:
    setup = hc.make_setup(TEAM, HAZARDS, path=hc.sketch_path(STROKE))
    controller, state, measured = hc.Controller(setup), setup.start, TEAM
    for _ in range(100):
        velocities = controller.step(measured, hc.sketch_path(STROKE))
        measured = measured + setup.params.safety.control_period * velocities
        state, _ = hc.advance(state, setup.world, setup.params)
        assert velocities.tobytes() == state.motion.velocity.tobytes()
        assert measured.tobytes() == state.motion.position.tobytes()


def test_a_state_replaces_what_is_remembered() -> None:
    setup = hc.make_setup(TEAM, HAZARDS, path=hc.sketch_path(STROKE))
    state, _ = hc.roll(setup.start, setup.world, setup.params, 50)
    after, _ = hc.advance(state, setup.world, setup.params)
    assert hc.Controller(setup).step(state).tobytes() == after.motion.velocity.tobytes()


def test_a_path_made_anew_goes_on_and_another_one_begins() -> None:
    controller = hc.Controller(hc.make_setup(TEAM))
    for _ in range(40):
        controller.step(controller.state.motion.position, hc.sketch_path(STROKE))
    come_to = controller.state.motion.path_parameter
    assert come_to > 10.0
    controller.step(controller.state.motion.position, hc.sketch_path(STROKE))
    assert controller.state.motion.path_parameter >= come_to
    controller.step(controller.state.motion.position, hc.sketch_path(STROKE[::-1]))
    assert controller.state.motion.path_parameter < come_to
    controller.step(controller.state.motion.position)
    assert controller.state.motion.path_status == 0


def test_a_paused_team_stands_and_a_reset_forgets() -> None:
    setup = hc.make_setup(TEAM, HAZARDS, path=hc.sketch_path(STROKE))
    controller = hc.Controller(setup)
    assert not controller.step(TEAM, hc.sketch_path(STROKE), paused=True).any()
    first = hc.Controller(setup).step(TEAM, hc.sketch_path(STROKE))
    controller.reset()
    assert controller.trace is None
    assert controller.step(TEAM, hc.sketch_path(STROKE)).tobytes() == first.tobytes()


@pytest.mark.parametrize("robots", [0, 1, 2])
def test_a_team_of_any_size_is_controlled(robots: int) -> None:
    controller = hc.Controller(hc.make_setup(TEAM[:robots], hc.Hazards().fire((600, 250), 20)))
    for _ in range(5):
        assert controller.step(TEAM[:robots]).shape == (robots, 2)


def test_a_team_without_robots_has_no_path() -> None:
    with pytest.raises(hc.ArgumentError, match="without robots"):
        hc.Controller(hc.make_setup([])).step([], hc.sketch_path(STROKE))
    with pytest.raises(hc.ArgumentError, match="without robots"):
        hc.make_setup([], path=hc.sketch_path(STROKE))


def test_the_influenced_robot_is_chosen_by_its_index() -> None:
    controller = hc.Controller(hc.make_setup(TEAM))
    controller.step(TEAM, hc.sketch_path(STROKE), influenced=2)
    assert controller.trace is not None
    assert np.abs(controller.trace.human_intention).any(axis=1).tolist() == [False, False, True]


def test_measured_fires_replace_those_of_the_model() -> None:
    controller = hc.Controller(hc.make_setup(TEAM, HAZARDS))
    controller.step(TEAM, fire_radius=[50.0], fire_burning=[True])
    assert controller.state.motion.fire_radius[0] == pytest.approx(50.02)
    controller.step(TEAM, fire_burning=[False])
    assert not controller.state.motion.fire_burning.any()


def test_an_error_of_measured_positions_enlarges_clearances_and_is_not_added_again() -> None:
    noisy = hc.make_parameters(robots={"position_noise": 0.5})
    first, second = (hc.Controller(hc.make_setup(TEAM, None, noisy)) for _ in range(2))
    assert first.step(TEAM, hc.sketch_path(STROKE)).tobytes() == second.step(TEAM, hc.sketch_path(STROKE)).tobytes()
    near = [[0.0, 0.0], [25.9, 0.0], [400.0, 0.0]]  # 0.1 m nearer than 25 m and twice the error
    pushed = hc.filter_velocities(near, np.zeros((3, 2)), None, noisy).velocity
    assert pushed[0, 0] < 0.0 < pushed[1, 0]
    assert not hc.filter_velocities(near, np.zeros((3, 2))).velocity.any()


def test_unicycles_need_headings_and_are_driven_within_their_limits() -> None:
    params = hc.make_parameters(robots={"look_ahead": 5.0, "turn_rate_limit": 4.0})
    setup = hc.make_setup(TEAM, None, params, headings=0.0)
    with pytest.raises(hc.ArgumentError, match="headings is None"):
        hc.Controller(setup).step(TEAM)
    with pytest.raises(hc.ArgumentError, match="headings is None"):
        hc.filter_velocities(TEAM, TEAM, None, params)
    velocities = hc.Controller(setup).step(TEAM, hc.sketch_path(STROKE), headings=[0.0, 1.0, 2.0])
    drives = hc.unicycle_commands(velocities, [0.0, 1.0, 2.0], params)
    assert (np.abs(drives[:, 1]) <= 4.0 + 1e-9).all()
    assert np.abs(drives).any()
