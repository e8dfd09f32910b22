"""Robots that cannot meet their halves: neighbours yield, those in nobody's way do not, and conflicts share equally."""

import numpy as np
import pytest

from higvf_console.control.safety.barriers.surroundings import survey
from higvf_console.control.safety.hazards import hazards_of
from higvf_console.control.safety.rescue import Outcome, rescue
from higvf_console.core.arrays import Floats, bools, floats
from tests.control.safety.barrier_reference import SAFETY

R_R, R_O, LIMIT = SAFETY.robot_clearance, SAFETY.obstacle_clearance, SAFETY.speed_limit
FIRE = [(0.0, 0.0, 20.0, 1.0)]  # its edge comes 1 m/s nearer
TOUCHING = 20.0 + R_O
PUSHED = 1.0003125  # [m/s] at which a robot must retreat from it
OTHERS = 7.5  # what the outcome held before

pytestmark = pytest.mark.usefixtures("plain_kernels")


def rescued(
    position: list[tuple[float, float]], nominal: Floats | None = None, walls: Floats | None = None,
    usable: list[bool] | None = None,
) -> Outcome:  # fmt: skip
    """What becomes of a team whose first robot is stuck beside a growing fire."""
    count = len(position)
    around = survey(floats(position), hazards_of([], [], walls if walls is not None else [], FIRE), SAFETY)
    outcome = Outcome(np.full((count, 2), OTHERS), np.zeros(count, np.int64), np.zeros(count, np.bool_))
    stuck = bools([True] + [False] * (count - 1))
    wish = np.zeros((count, 2)) if nominal is None else nominal
    rescue(stuck, bools([True] * count if usable is None else usable), wish, around, outcome)
    return outcome


def test_the_neighbour_of_a_stuck_robot_yields_so_that_nothing_is_violated() -> None:
    outcome = rescued([(TOUCHING, 0.0), (TOUCHING + R_R, 0.0)])
    assert outcome.velocity[:, 0] == pytest.approx([PUSHED, PUSHED])
    assert outcome.velocity[:, 1] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert outcome.active_constraints.tolist() == [2, 1]
    assert not outcome.infeasible.any()


def test_a_neighbour_yields_only_as_much_as_the_whole_of_their_constraint_asks_for() -> None:
    distance = 1.05 * R_R
    outcome = rescued([(TOUCHING, 0.0), (TOUCHING + distance, 0.0)])
    h = (distance / R_R) ** 2 - 1.0
    whole = 0.5 * SAFETY.pair_gain * R_R**2 * h**3 / distance  # [22], not split into halves
    assert outcome.velocity[:, 0] == pytest.approx([PUSHED, PUSHED - whole])
    assert 0.0 < whole < PUSHED


def test_a_cluster_grows_along_a_chain_and_leaves_out_who_is_in_nobody_s_way() -> None:
    chain = [(TOUCHING + R_R * k, 0.0) for k in range(4)]
    outcome = rescued([*chain, (TOUCHING, 60.0)])
    assert outcome.velocity[:4, 0] == pytest.approx([PUSHED] * 4)
    assert outcome.velocity[4].tolist() == [OTHERS, OTHERS]


def test_the_members_get_the_velocities_nearest_to_their_wishes() -> None:
    wish = floats([(0.0, 3.0), (5.0, -2.0)])
    outcome = rescued([(TOUCHING, 0.0), (TOUCHING + R_R, 0.0)], wish)
    assert outcome.velocity == pytest.approx(floats([(PUSHED, 3.0), (5.0, -2.0)]), abs=1e-6)


def test_a_robot_whose_data_are_no_numbers_joins_no_cluster_and_its_half_gives_way() -> None:
    outcome = rescued([(TOUCHING, 0.0), (TOUCHING + R_R, 0.0)], usable=[True, False])
    assert outcome.velocity[1].tolist() == [OTHERS, OTHERS]
    assert outcome.infeasible.tolist() == [True, False]
    assert outcome.velocity[0, 0] == pytest.approx(PUSHED / 2, rel=1e-3), "fire and neighbour are violated alike"


def test_between_a_fire_and_a_wall_the_violation_is_shared_equally_and_flagged() -> None:
    wall = floats([(-1.0, 0.0, -(TOUCHING + R_O))])
    outcome = rescued([(TOUCHING, 0.0)], floats([(0.0, 4.0)]), wall)
    assert outcome.velocity[0] == pytest.approx([PUSHED / 2, 4.0], abs=1e-5)
    assert outcome.infeasible.tolist() == [True]


def test_a_chain_against_a_wall_violates_no_constraint_more_than_it_must() -> None:
    wall = floats([(-1.0, 0.0, -(TOUCHING + R_R + R_O))])
    outcome = rescued([(TOUCHING, 0.0), (TOUCHING + R_R, 0.0)], walls=wall)
    first, second = outcome.velocity[:, 0]
    missed = PUSHED - first, first - second, second  # of the fire's, the pair's and the wall's constraint
    assert missed == pytest.approx([PUSHED / 3] * 3, rel=1e-3)
    assert outcome.infeasible.all()
