"""The conditions under which the method keeps its promises."""

import numpy as np
import pytest

from higvf_console.core.arrays import Ints, ints
from higvf_console.sim.certificates import DENSE, Worst, certificates, connectivity, laplacian
from higvf_console.sim.simulation import advance
from tests.teams import team


def chain_of(robots: int) -> Ints:
    """Links of robots in a row."""
    return np.stack([np.arange(robots - 1), np.arange(1, robots)], axis=1)


@pytest.mark.parametrize("robots", [DENSE, DENSE + 1, 3 * DENSE])
def test_lambda_2_of_a_row_of_robots_is_the_known_one(robots: int) -> None:
    assert connectivity(chain_of(robots), robots) == pytest.approx(2.0 - 2.0 * np.cos(np.pi / robots), rel=1e-6)


def test_lambda_2_of_a_large_team_agrees_with_the_dense_eigenvalues() -> None:
    at = np.random.default_rng(1).uniform(0.0, 1000.0, (150, 2))
    near = np.hypot(*(at[:, None] - at[None]).transpose(2, 0, 1)) < 200.0
    links = ints(np.argwhere(np.triu(near, 1)))
    assert connectivity(links, 150) == pytest.approx(np.linalg.eigvalsh(laplacian(links, 150))[1], rel=1e-6)


@pytest.mark.parametrize("robots", [10, 3 * DENSE])
def test_lambda_2_is_zero_for_a_team_in_two_parts(robots: int) -> None:
    links = chain_of(robots)
    assert connectivity(np.delete(links, 4, axis=0), robots) == pytest.approx(0.0, abs=1e-9)


def test_every_certificate_says_in_one_sentence_what_its_failing_would_mean() -> None:
    setup = team(fires=[(500.0, 250.0, 20.0)])
    state, trace = advance(setup.start, setup.world, setup.params)
    found = certificates(setup.world, setup.params, setup.start, state, trace, Worst())
    assert len({item.meaning for item in found}) == len(found) == 5
    assert all(item.meaning.startswith("If it fails, ") and item.meaning.count(".") == 1 for item in found)
