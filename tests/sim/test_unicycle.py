"""Unicycles drive what is commanded of their look-ahead points, within their limits, and their bodies stay clear."""

import math

import numpy as np
import pytest

from higvf_console.control.parameters import Parameters, RobotParameters, SafetyParameters, controlled
from higvf_console.control.safety.coupled_filter import CoupledFilter
from higvf_console.core.arrays import Floats
from higvf_console.scenario.scenario import load_scenario
from higvf_console.sim.simulation import advance, advance_coupled, roll
from higvf_console.sim.unicycle import body_centres, drive
from higvf_console.world.setup import Setup
from tests.teams import team

DT = Parameters().safety.control_period


def driven(centre: Floats, heading: float, speed: float, turn_rate: float) -> tuple[Floats, float]:
    """Where a unicycle is after a control period, by the textbook's arc."""
    after = heading + turn_rate * DT
    if abs(turn_rate) < 1e-6:
        return centre + speed * DT * np.array([math.cos(heading), math.sin(heading)]), after
    arc = np.array([math.sin(after) - math.sin(heading), math.cos(heading) - math.cos(after)])
    return centre + speed / turn_rate * arc, after


def ahead(centre: Floats, heading: float, look_ahead: float) -> Floats:
    return centre + look_ahead * np.array([math.cos(heading), math.sin(heading)])


def unicycles(seed: int = 0) -> Setup:
    return load_scenario("unicycles").setup(seed)


@pytest.mark.parametrize("turn_rate_limit", [0.5, 4.0, 40.0, math.inf])
def test_the_look_ahead_point_lands_where_it_was_sent_and_no_limit_is_exceeded(turn_rate_limit: float) -> None:
    rng = np.random.default_rng(1)
    for look_ahead in rng.uniform(0.1, 10.0, 300):
        params = Parameters(robots=RobotParameters(look_ahead=look_ahead, turn_rate_limit=turn_rate_limit))
        limit = controlled(params).safety.speed_limit
        heading, course = rng.uniform(-10.0, 10.0, 2)
        velocity = limit * math.sqrt(rng.random()) * np.array([math.cos(course), math.sin(course)])
        speed, turn_rate = drive(velocity[0], velocity[1], heading, look_ahead, DT)
        start = ahead(np.zeros(2), heading, look_ahead)
        end = ahead(*driven(np.zeros(2), heading, speed, turn_rate), look_ahead)
        assert end == pytest.approx(start + velocity * DT, abs=1e-12 if abs(turn_rate) > 1e-2 else 1e-9)
        assert abs(turn_rate) <= turn_rate_limit * (1.0 + 1e-12)
        assert abs(speed) <= params.safety.speed_limit * (1.0 + 1e-12)


def test_the_limits_are_reached_by_a_turn_on_the_spot_and_by_driving_straight() -> None:
    slow = controlled(Parameters(robots=RobotParameters(look_ahead=2.0, turn_rate_limit=3.0))).safety.speed_limit
    half_turn = 1.5 * DT
    sideways = slow * np.array([-math.sin(half_turn), math.cos(half_turn)])
    assert drive(sideways[0], sideways[1], 0.0, 2.0, DT) == pytest.approx((0.0, 3.0), abs=1e-12)
    assert drive(90.0, 0.0, 0.0, 2.0, DT) == (90.0, 0.0)
    assert drive(-30.0, 0.0, 0.0, 2.0, DT) == (-30.0, 0.0)


def test_a_unicycle_at_rest_keeps_its_heading_and_a_single_integrator_has_none() -> None:
    params = Parameters(robots=RobotParameters(look_ahead=5.0, turn_rate_limit=2.0))
    setup = team([(100.0, 100.0)], params=params)
    turned = setup.start._replace(motion=setup.start.motion._replace(heading=np.array([0.7])))
    assert advance(turned, setup.world, params)[0].motion.heading.tolist() == [0.7]
    plain = team(fires=[(600.0, 350.0, 30.0)])
    state, _ = roll(plain.start, plain.world, plain.params, 50)
    assert not state.motion.heading.any()
    assert (body_centres(state.motion.position, state.motion.heading, 0.0) == state.motion.position).all()


@pytest.mark.parametrize("seed", range(4))
def test_bodies_stay_clear_and_within_their_limits_until_all_fires_are_out(seed: int) -> None:
    setup = unicycles(seed)
    robots, safety = setup.params.robots, setup.params.safety
    state = setup.start
    body = body_centres(state.motion.position, state.motion.heading, robots.look_ahead)
    for _ in range(6000):
        heading = state.motion.heading
        state, trace = advance(state, setup.world, setup.params)
        was, body = body, body_centres(state.motion.position, state.motion.heading, robots.look_ahead)
        assert trace.clearance.min() >= 0.0
        assert trace.barrier.min() >= 0.0
        assert np.abs(state.motion.heading - heading).max() <= robots.turn_rate_limit * DT * (1.0 + 1e-9)
        assert np.hypot(*(body - was).T).max() <= safety.speed_limit * DT * (1.0 + 1e-9)
        middle = (heading + state.motion.heading) / 2.0  # the direction of an arc's chord
        across = np.cos(middle) * (body - was)[:, 1] - np.sin(middle) * (body - was)[:, 0]
        assert np.abs(across).max() < 1e-9
        if not state.motion.fire_burning.any():
            break
    assert not state.motion.fire_burning.any()


def test_the_judges_look_at_bodies_not_at_look_ahead_points() -> None:
    params = Parameters(
        robots=RobotParameters(look_ahead=5.0, turn_rate_limit=2.0), safety=SafetyParameters(obstacle_clearance=10.0)
    )
    setup = team([(100.0, 100.0)], circles=[(100.0, 135.0, 10.0)], params=params)
    facing = setup.start._replace(motion=setup.start.motion._replace(heading=np.array([math.pi / 2.0])))
    _, trace = advance(facing, setup.world, params)
    assert trace.clearance[0] == pytest.approx(25.0 + 5.0 - 10.0)


def test_a_roll_of_disturbed_unicycles_gives_the_states_of_repeated_advances_bit_for_bit() -> None:
    setup = unicycles(7)
    rolled, history = roll(setup.start, setup.world, setup.params, 400)
    state = setup.start
    for k in range(400):
        state, trace = advance(state, setup.world, setup.params)
        assert history.position[k].tobytes() == state.motion.position.tobytes()
        assert history.clearance[k] == trace.clearance.min()
    for one, other in zip(rolled.motion, state.motion, strict=True):
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()


def test_the_centralised_filter_keeps_bodies_clear_too() -> None:
    setup, safety = unicycles(2), CoupledFilter()
    state, nearest = setup.start, math.inf
    for _ in range(200):
        state, trace = advance_coupled(state, setup.world, setup.params, safety)
        nearest = min(nearest, trace.clearance.min())
    assert nearest >= 0.0
