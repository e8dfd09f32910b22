"""What the operator looked at adds up, and a busy eye is told from a calm one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.arrays import floats
from higvf_interfaces.attention import ELSEWHERE, Looks, attention, looked_at, looks, transition_entropy, workload
from higvf_interfaces.fixations import classify


def at(*points: tuple[float, float], length: float = 0.3) -> Looks:
    start = np.arange(len(points)) * 0.35
    return Looks(floats(start), floats(start + length), floats(points, -1, 2))


FIRES = floats([[100, 100], [500, 100]])


def test_each_fixation_goes_to_the_target_that_it_is_on() -> None:
    points = floats([[110, 100], [480, 110], [300, 400]])
    assert looked_at(points, FIRES, floats([50, 50])).tolist() == [0, 1, ELSEWHERE]


def test_of_two_targets_the_one_whose_border_is_nearer_wins() -> None:
    assert looked_at(floats([[290, 100]]), FIRES, floats([200, 400])).tolist() == [1]


def test_moving_targets_are_where_they_were_during_the_fixation() -> None:
    robots = floats([[[0, 0], [900, 0]], [[900, 0], [0, 0]]])
    assert looked_at(floats([[0, 0], [0, 0]]), robots, floats([10, 10])).tolist() == [0, 1]


def test_shares_are_by_time_and_add_up_to_one() -> None:
    shares = attention(at((100, 100), (100, 100), (500, 100), (900, 900)), FIRES, floats([50, 50]))
    np.testing.assert_allclose(shares, [0.5, 0.25, 0.25])


def test_without_fixations_or_targets_nothing_is_looked_at() -> None:
    assert attention(at(), FIRES, floats([50, 50])).tolist() == [0, 0, 0]
    assert attention(at((1, 1)), floats([], 0, 2), floats([])).tolist() == [1.0]
    assert attention(at((1, 1)), floats([[np.nan, np.nan]]), floats([50])).tolist() == [0, 1]


def test_workload_counts_fixations_a_second_and_their_length() -> None:
    load = workload(at((0, 0), (1, 1), (2, 2), length=0.2), [0, 1, 0], duration=6.0)
    assert load.fixation_rate == pytest.approx(0.5)
    assert load.fixation_duration == pytest.approx(0.2)
    assert load.transition_entropy == 0.0


def test_a_fixed_round_has_no_entropy_and_chance_has_all_of_it() -> None:
    assert transition_entropy([0, 1, 2] * 50) == pytest.approx(0.0)
    chance = np.random.default_rng(1).integers(0, 4, 20_000)
    assert transition_entropy(chance) == pytest.approx(2.0, abs=0.01)
    assert np.isnan(transition_entropy([1, 2]))


@given(areas=st.lists(st.integers(-1, 5), min_size=3, max_size=60))
def test_entropy_lies_between_none_and_that_of_chance(areas: list[int]) -> None:
    assert -1e-12 <= transition_entropy(areas) <= np.log2(len(set(areas))) + 1e-9


def test_looks_are_the_fixations_of_classified_gaze() -> None:
    x = np.repeat([100.0, 600.0], 60)
    time = np.arange(120) / 120
    found = looks(classify(time, np.stack([x, x], axis=1), np.ones(120, dtype=np.bool_)))
    np.testing.assert_allclose(found.points, [[100, 100], [600, 600]], atol=1e-9)
    assert (found.end > found.start).all()
