"""Fixations are assigned to targets, and the transition entropy separates ordered from random gaze."""

from collections.abc import Iterable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.core.arrays import floats
from higvf_interfaces.gaze.attention import ELSEWHERE, Transitions, fixated_targets

FIRES = floats([[100, 100], [500, 100]])


def test_each_fixation_is_assigned_to_the_target_under_it() -> None:
    points = floats([[110, 100], [480, 110], [300, 400]])
    assert fixated_targets(points, FIRES, floats([50, 50])).tolist() == [0, 1, ELSEWHERE]


def test_of_two_targets_the_one_with_the_nearer_border_is_chosen() -> None:
    assert fixated_targets(floats([[290, 100]]), FIRES, floats([200, 400])).tolist() == [1]


def test_moving_targets_use_their_positions_during_the_fixation() -> None:
    robots = floats([[[0, 0], [900, 0]], [[900, 0], [0, 0]]])
    assert fixated_targets(floats([[0, 0], [0, 0]]), robots, floats([10, 10])).tolist() == [0, 1]


def entropy(areas: Iterable[int]) -> float:
    transitions = Transitions()
    for area in areas:
        transitions.add(area)
    return transitions.entropy


def test_a_fixed_sequence_has_entropy_0_and_a_random_one_1() -> None:
    assert entropy([0, 1, 2] * 50) == pytest.approx(0.0)
    chance = np.random.default_rng(1).integers(0, 4, 20_000)
    assert entropy(chance.tolist()) == pytest.approx(1.0, abs=0.01)
    assert entropy([3, 3, 3, 3]) == 0.0
    assert np.isnan(entropy([1, 2]))


@given(areas=st.lists(st.integers(-1, 5), min_size=3, max_size=60))
def test_entropy_lies_between_0_and_1(areas: list[int]) -> None:
    assert -1e-12 <= entropy(areas) <= 1 + 1e-9
