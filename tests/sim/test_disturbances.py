"""Errors and losses are drawn as asked, alike for the same seed, and leave clearances and bounds as promised."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.control.intention.neighbours import within
from higvf_console.control.intention.packet_loss import MEASURING, chance, delivered
from higvf_console.control.parameters import (
    PackedParameters,
    Parameters,
    RobotParameters,
    SafetyParameters,
    controlled,
    packed,
)
from higvf_console.control.safety.hazards import hazards_of
from higvf_console.control.safety.safety_filter import filter_velocities
from higvf_console.core.arrays import Floats, floats
from higvf_console.operator.reducer import apply_command
from higvf_console.sim.disturbances import measured, noise_limit
from higvf_console.sim.simulation import advance
from tests.teams import stroke, team

NOTHING = np.zeros((0, 2))
MASK = 2**64 - 1


def disturbed(noise: float = 0.0, loss: float = 0.0, seed: float = 0.0) -> PackedParameters:
    return packed(Parameters(robots=RobotParameters(position_noise=noise, packet_loss=loss, seed=seed)))


def split_mix(state: int) -> int:
    """The generator's published form, on unbounded integers."""
    z = (state + 0x9E3779B97F4A7C15) & MASK
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return z ^ (z >> 31)


def test_the_generator_is_splitmix64() -> None:
    assert split_mix(1234567) == 6457827717110365317  # its authors' test value
    key = (12, 345, MEASURING, 6, 7)
    state = 0
    for word in key:
        state = split_mix(state ^ word)
    assert chance(*key) == (state >> 11) / 2.0**53


def test_draws_are_uniform_and_independent_of_their_neighbours() -> None:
    draws = np.array([[chance(3, tick, MEASURING, i, 0) for tick in range(400)] for i in range(20)])
    assert 0.0 <= draws.min() < 0.001
    assert 0.999 < draws.max() < 1.0
    assert np.histogram(draws, 8, (0.0, 1.0))[0] == pytest.approx(np.full(8, 1000), abs=120)
    assert np.abs(np.corrcoef(draws) - np.eye(20)).max() < 0.2
    assert abs(np.corrcoef(draws[:, :-1].ravel(), draws[:, 1:].ravel())[0, 1]) < 0.05


def test_errors_fill_the_disc_of_the_noise_and_never_leave_it() -> None:
    position = floats(np.random.default_rng(1).uniform(0, 1000, (500, 2)))
    robots = disturbed(noise=2.0)[0].robots
    error = np.concatenate([measured(position, tick, robots) - position for tick in range(20)])
    size = np.hypot(*error.T)
    assert size.max() <= 2.0 + 1e-9
    assert size.max() > 1.99
    assert error.mean(axis=0) == pytest.approx([0.0, 0.0], abs=0.05)
    assert np.mean(size < 1.0) == pytest.approx(0.25, abs=0.02)


def test_the_same_seed_draws_the_same_errors_and_another_seed_or_tick_others() -> None:
    position = np.zeros((5, 2))
    first, again = (measured(position, 9, disturbed(noise=1.0, seed=4.0)[0].robots) for _ in range(2))
    assert first.tobytes() == again.tobytes()
    assert not (first == measured(position, 9, disturbed(noise=1.0, seed=5.0)[0].robots)).any()
    assert not (first == measured(position, 10, disturbed(noise=1.0, seed=4.0)[0].robots)).any()


def test_links_are_lost_at_the_given_rate_in_both_directions_together() -> None:
    start, to = within(floats(np.random.default_rng(2).uniform(0, 100, (30, 2))), math.inf)
    kept = 0
    for tick in range(40):
        delivered_start, delivered_to = delivered(start, to, tick, disturbed(loss=0.3)[0].robots)
        rows = [set(delivered_to[delivered_start[i] : delivered_start[i + 1]].tolist()) for i in range(30)]
        assert all(i in rows[j] for i in range(30) for j in rows[i])
        kept += len(delivered_to)
    assert kept / (40 * len(to)) == pytest.approx(0.7, abs=0.015)


def test_without_loss_every_link_is_heard_and_with_certain_loss_none() -> None:
    start, to = within(np.zeros((4, 2)), math.inf)
    all_start, everyone = delivered(start, to, 3, disturbed()[0].robots)
    assert (all_start.tolist(), everyone.tolist()) == (start.tolist(), to.tolist())
    no_start, nobody = delivered(start, to, 3, disturbed(loss=1.0)[0].robots)
    assert (no_start.tolist(), nobody.tolist()) == ([0] * 5, [])


def test_a_team_that_hears_nothing_stays_one_component_but_its_robots_are_on_their_own() -> None:
    params = Parameters(robots=RobotParameters(packet_loss=1.0))
    setup = team(params=params)
    state = setup.start
    for command in stroke([(120, 350), (300, 350), (420, 450)], robot=0):
        state, _ = apply_command(state, command, setup)
    for _ in range(50):
        state, trace = advance(state, setup.world, params)
        assert trace.component.tolist() == [0, 0, 0]
        assert not trace.formation.any()
    assert np.hypot(*state.motion.intention[0]) > 0.5
    assert not state.motion.intention[1:].any()


def test_the_shared_intention_keeps_its_bound_whatever_is_lost() -> None:
    params = Parameters(robots=RobotParameters(packet_loss=0.5, position_noise=2.0, seed=8.0))
    setup = team(fires=[(600.0, 350.0, 30.0)], params=params)
    state = setup.start
    for command in stroke([(120, 350), (300, 350), (420, 450), (520, 600)], robot=0):
        state, _ = apply_command(state, command, setup)
    w0, w1, _, w3, _ = params.intention
    for _ in range(300):
        state, _ = advance(state, setup.world, params)
        robot, human = w1 * state.motion.robot_peak, w3 * state.motion.human_peak
        bound = max(robot / (w0 + w1), (robot + human) / (w0 + w1 + w3))
        assert np.hypot(*state.motion.intention.T).max() <= bound * (1.0 + 1e-12)


def test_a_robot_yields_where_it_measures_itself_not_where_it_is() -> None:
    params = Parameters(robots=RobotParameters(position_noise=1.0, seed=2.0))
    setup = team(robots=[(100.0, 100.0)], circles=[(100.0, 100.0 + 20.0 + 13.0, 20.0)], params=params)
    state = setup.start._replace(intent=setup.start.intent._replace(paused=True))
    assert float(packed(params)[0].safety.obstacle_clearance) == 13.0  # it stands where it would stay without errors
    moved = 0
    for _ in range(100):
        before = state.motion
        state, trace = advance(state, setup.world, params)
        step = params.safety.control_period * state.motion.velocity
        assert (state.motion.position == before.position + step).all()
        assert trace.clearance[0] >= 0.0
        moved += bool(state.motion.velocity.any())
    assert moved > 0
    assert state.motion.position[0, 1] < 100.0


def one_step(robots: Floats, errors: Floats, nominal: Floats, safety: SafetyParameters, **dangers: Floats) -> Floats:
    """True positions after one control period of robots that measure theirs with errors (all (N, 2))."""
    hazards = hazards_of(
        dangers.get("circles", np.zeros((0, 3))), dangers.get("bars", np.zeros((0, 5))),
        dangers.get("walls", np.zeros((0, 3))), dangers.get("fire", np.zeros((0, 4))),
    )  # fmt: skip
    velocity, _, infeasible = filter_velocities(floats(robots + errors), nominal, hazards, safety)
    assert not infeasible.any()
    return robots + safety.control_period * velocity


def polar(radius: float | Floats, angle: float | Floats) -> Floats:
    return floats(np.stack(np.broadcast_arrays(radius * np.cos(angle), radius * np.sin(angle)), axis=-1))


BODY = Parameters()
NOISE = 0.999 * noise_limit(BODY, 3.0)
POINT = controlled(BODY._replace(robots=RobotParameters(position_noise=NOISE))).safety


def circle_gap(rng: np.random.Generator, noise: float) -> float:
    at = polar(20.0 + 12.0 + rng.exponential(0.3), rng.uniform(-9, 9))
    after = one_step(at[None], worst(rng, noise, 1), worst(rng, 90.0, 1), POINT, circles=floats([[0.0, 0.0, 20.0]]))
    return math.hypot(*after[0]) - 20.0 - 12.0


def fire_gap(rng: np.random.Generator, noise: float) -> float:
    at = polar(20.0 + 12.0 + rng.exponential(0.3), rng.uniform(-9, 9))
    fire = floats([[0.0, 0.0, 20.0, 3.0]])
    after = one_step(at[None], worst(rng, noise, 1), worst(rng, 90.0, 1), POINT, fire=fire)
    return math.hypot(*after[0]) - 20.0 - 3.0 * POINT.control_period - 12.0


def point_gap(rng: np.random.Generator, noise: float) -> float:
    at = polar(12.0 + rng.exponential(0.3), rng.uniform(-9, 9))
    bar = floats([[-30.0, 0.0, 0.0, 0.0, 0.0]])
    x, y = at
    while math.hypot(x - min(max(x, -30.0), 0.0), y) < 12.0:
        x, y = at = polar(12.0 + rng.exponential(0.3), rng.uniform(-9, 9))
    ((x, y),) = one_step(at[None], worst(rng, noise, 1), worst(rng, 90.0, 1), POINT, bars=bar)
    return math.hypot(x - min(max(x, -30.0), 0.0), y) - 12.0


def wall_gap(rng: np.random.Generator, noise: float) -> float:
    at = floats([[12.0 + rng.exponential(0.3), 0.0]])
    after = one_step(at, worst(rng, noise, 1), worst(rng, 90.0, 1), POINT, walls=floats([[1.0, 0.0, 0.0]]))
    return float(after[0, 0]) - 12.0


def pair_gap(rng: np.random.Generator, noise: float) -> float:
    at = np.stack([np.zeros(2), polar(25.0 + rng.exponential(0.3), rng.uniform(-9, 9))])
    after = one_step(at, worst(rng, noise, 2), worst(rng, 90.0, 2), POINT)
    return math.dist(*after) - 25.0


def worst(rng: np.random.Generator, size: float, count: int) -> Floats:
    """Vectors (count, 2) up to `size`, every other at that size."""
    return polar(size * rng.choice([1.0, math.sqrt(rng.random())], count), rng.uniform(-9, 9, count))


@pytest.mark.parametrize("gap", [circle_gap, fire_gap, point_gap, wall_gap, pair_gap])
def test_a_true_clearance_outlasts_any_error_up_to_the_noise_and_larger_ones_break_it(
    gap: Callable[[np.random.Generator, float], float],
) -> None:
    rng = np.random.default_rng(5)
    assert min(gap(rng, NOISE) for _ in range(4000)) >= -1e-9
    assert min(gap(rng, 2.0 * NOISE) for _ in range(1000)) < 0.0
