"""Formation, shared intention and blending: signs, fixed points, bounds, limits."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.control.forms import Forms
from higvf_console.control.intention.blending import blended_velocity, blending_weight
from higvf_console.control.intention.formation import formation_velocity
from higvf_console.control.intention.intention import shared_intention
from higvf_console.control.parameters import BlendingParameters, FormationParameters, IntentionParameters
from higvf_console.core.arrays import Floats, Ints, floats, ints

FORMATION, INTENTION, BLENDING = FormationParameters(), IntentionParameters(), BlendingParameters()
PAIR = ints([0, 1, 2]), ints([1, 0])


def complete(robots: int) -> tuple[Ints, Ints]:
    others = [[j for j in range(robots) if j != i] for i in range(robots)]
    return ints(np.arange(robots + 1) * (robots - 1)), ints(np.concatenate(others))


def pull(i: int, position: Floats, shape: Floats, links: tuple[Ints, Ints]) -> tuple[float, float]:
    x, y = position[i]
    return formation_velocity(i, x, y, position, shape, links[0], links[1], FORMATION, Forms())


@pytest.mark.parametrize(("distance", "sign"), [(30.0, -1.0), (90.0, 1.0)])
def test_robots_that_are_too_near_part_and_robots_that_are_too_far_close_in(distance: float, sign: float) -> None:
    position, shape = floats([(0, 0), (distance, 0)]), floats([(0, 0), (60, 0)])
    vx, vy = pull(0, position, shape, PAIR)
    assert (vx, vy) == (pytest.approx(sign * 30.0 * FORMATION.formation_rate), 0.0)


def test_a_formation_returns_to_its_shape() -> None:
    shape = floats([(0, 0), (60, 0), (30, 50)])
    position, links = floats([(0, 0), (20, 0), (80, 90)]), complete(3)
    for _ in range(2000):
        velocity = [pull(i, position, shape, links) for i in range(3)]
        position = floats(position + 0.02 * np.array(velocity))
    gaps = [math.dist(position[i], position[j]) - math.dist(shape[i], shape[j]) for i, j in ((0, 1), (0, 2), (1, 2))]
    assert gaps == pytest.approx([0.0, 0.0, 0.0], abs=0.05)


def test_robots_at_one_point_part() -> None:
    position, shape = np.zeros((2, 2)), floats([(0, 0), (60, 0)])
    one = pull(0, position, shape, PAIR)
    other = pull(1, position, shape, PAIR)
    assert one[0] == -other[0] != 0.0


def test_the_formation_velocity_is_capped() -> None:
    position, shape = floats([(0, 0), (3000, 4000)]), floats([(0, 0), (60, 0)])
    velocity = pull(0, position, shape, PAIR)
    assert velocity == pytest.approx((0.6 * FORMATION.formation_speed, 0.8 * FORMATION.formation_speed))


def step(state: Floats, robot: Floats, human: Floats, dt: float, params: IntentionParameters = INTENTION) -> Floats:
    start, to = complete(len(state))

    def after(i: int) -> tuple[float, float]:
        (vx, vy), (rx, ry), (hx, hy) = state[i], robot[i], human[i]
        psi = 1.0 if i == 0 else 0.0
        return shared_intention(i, vx, vy, rx, ry, hx, hy, psi, state, start, to, params, Forms(), dt)

    return floats([after(i) for i in range(len(state))])


@pytest.mark.parametrize("robots", [1, 3, 7, 30])
def test_the_shared_intention_converges_to_the_fixed_point_of_the_paper_at_any_degree(robots: int) -> None:
    rng = np.random.default_rng(robots)
    robot, human = rng.normal(size=(robots, 2)), np.zeros((robots, 2))
    human[0] = (0.6, -0.8)
    state = np.zeros((robots, 2))
    for _ in range(3000):
        state = step(state, robot, human, 0.02)
    psi = np.eye(robots)[0][:, None]
    laplacian = robots * np.eye(robots) - np.ones((robots, robots))
    system = np.diag((INTENTION.decay + INTENTION.robot_weight + INTENTION.human_weight * psi)[:, 0])
    system = system + INTENTION.neighbour_weight * laplacian
    fixed = np.linalg.solve(system, INTENTION.robot_weight * robot + INTENTION.human_weight * psi * human)
    assert state == pytest.approx(fixed, abs=1e-9)


@given(st.integers(2, 12), st.integers(0, 2**32 - 1))
def test_the_shared_intention_keeps_its_bound(robots: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot, human = rng.normal(size=(robots, 2)), np.zeros((robots, 2))
    human[0] = rng.normal(size=2)
    w0, w1, w3 = INTENTION.decay, INTENTION.robot_weight, INTENTION.human_weight
    most_robot, most_human = np.hypot(*robot.T).max(), np.hypot(*human.T).max()
    bound = max(w1 * most_robot / (w0 + w1), (w1 * most_robot + w3 * most_human) / (w0 + w1 + w3))
    state = np.zeros((robots, 2))
    for _ in range(60):
        state = step(state, robot, human, 0.1)
        assert np.hypot(*state.T).max() <= bound * (1.0 + 1e-12)


def test_neighbours_within_the_dead_zone_have_no_influence() -> None:
    params = INTENTION._replace(dead_zone=0.5)
    near = floats([(0.0, 0.0), (0.4, 0.0)])
    assert step(near, np.zeros((2, 2)), np.zeros((2, 2)), 0.02, params)[0].tolist() == [0.0, 0.0]
    far = floats([(0.0, 0.0), (0.6, 0.0)])
    assert step(far, np.zeros((2, 2)), np.zeros((2, 2)), 0.02, params)[0, 0] > 0.0


def test_an_endless_step_gives_the_fixed_point() -> None:
    state = floats([(0.2, 0.1)])
    for _ in range(3000):
        state = step(state, floats([(1.0, 0.0)]), floats([(0.0, 1.0)]), 0.02)
    assert step(state, floats([(1.0, 0.0)]), floats([(0.0, 1.0)]), math.inf) == pytest.approx(state, abs=1e-9)


def test_the_blending_weight_meets_its_conditions() -> None:
    a = np.linspace(0.0, 5.0, 101)
    assert blending_weight(0.0, 0.0, BLENDING, Forms()) == 0.0
    assert (np.diff([blending_weight(x, 10.0, BLENDING, Forms()) for x in a]) > 0.0).all()
    assert (np.diff([blending_weight(1.0, 20.0 * x, BLENDING, Forms()) for x in a]) < 0.0).all()
    assert blending_weight(1e9, 10.0, BLENDING, Forms()) == pytest.approx(1.0)
    assert blending_weight(1.0, 1e9, BLENDING, Forms()) == pytest.approx(0.0, abs=1e-6)


def test_a_clear_intention_is_driven_at_cruise_speed_and_a_faint_one_slower() -> None:
    vx, vy, weight = blended_velocity(3.0, 4.0, 0.0, 0.0, BLENDING, Forms())
    assert math.hypot(vx, vy) == pytest.approx(weight * BLENDING.cruise_speed)
    faint = blended_velocity(0.01, 0.0, 0.0, 0.0, BLENDING, Forms())
    assert faint[0] == pytest.approx(faint[2] * BLENDING.cruise_speed * 0.01 / BLENDING.intention_floor)


def test_without_intention_only_the_formation_moves_a_robot() -> None:
    assert blended_velocity(0.0, 0.0, 3.0, -2.0, BLENDING, Forms()) == (3.0, -2.0, 0.0)
