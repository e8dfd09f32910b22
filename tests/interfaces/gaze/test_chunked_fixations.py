"""A recording classified in chunks has the same fixations as one classified whole."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from higvf_console.core.arrays import Floats, bools, floats
from higvf_console.core.viewport import Arena, fit
from higvf_interfaces.gaze.chunked_fixations import Pixels, classify_blocks
from higvf_interfaces.gaze.fixations import METHODS, Classified, classify
from higvf_interfaces.recordings.gaze import DrawnByEye, synthetic_gaze


def looked(seed: int, duration: float = 30.0) -> Pixels:
    """Gaze that scans, draws, scans, and is lost for three seconds."""
    stroke = DrawnByEye(8.0, 16.0, floats([[200, 200], [500, 400], [900, 350]]))
    samples = synthetic_gaze([stroke], duration, fit(Arena(0, 0, 1200, 700), 1920, 1080), seed=seed)
    valid = samples.valid & ~((samples.time > 20) & (samples.time < 23))
    rng = np.random.default_rng(seed)
    for start in rng.uniform(0, duration, 20):
        valid &= np.abs(samples.time - start) > rng.uniform(0.01, 0.1)
    return Pixels(samples.time, samples.points, bools(valid))


def cut(whole: Pixels, size: int) -> Iterator[Pixels]:
    for first in range(0, len(whole.time), size):
        part = slice(first, first + size)
        yield Pixels(whole.time[part], whole.points[part], whole.valid[part])


def spans(found: Classified) -> Floats:
    return floats(np.stack([found.time[found.first], found.time[found.last]], axis=1), -1, 2)


@settings(max_examples=25)
@given(seed=st.integers(0, 1000), size=st.integers(1, 900), method=st.sampled_from(METHODS))
def test_chunks_have_the_fixations_of_the_whole_recording(seed: int, size: int, method: str) -> None:
    whole = looked(seed, 12.0 if size < 50 else 30.0)
    chunks = list(classify_blocks(cut(whole, size), method=method))
    np.testing.assert_array_equal(np.concatenate([chunk.time for chunk in chunks]), whole.time)
    expected = spans(classify(*whole, method=method))
    np.testing.assert_allclose(np.concatenate([spans(chunk) for chunk in chunks]), expected, atol=1e-9)


def test_the_number_of_held_samples_stays_small() -> None:
    lengths = [len(chunk.time) for chunk in classify_blocks(cut(looked(1), 60))]
    assert max(lengths) < 600, "the longest chunk is the time without gaze"


def test_an_endless_fixation_is_split() -> None:
    time = floats(np.arange(5000) / 100)
    stare = Pixels(time, np.full((5000, 2), 300.0), np.ones(5000, dtype=np.bool_))
    chunks = list(classify_blocks(cut(stare, 100), longest=1000))
    assert sum(len(chunk.time) for chunk in chunks) == 5000
    assert max(len(chunk.time) for chunk in chunks) <= 1100
    assert all(len(chunk.first) == 1 for chunk in chunks)


def stare(seconds: float, rate: float = 120.0) -> Pixels:
    """Gaze that scans, fixates one point for `seconds`, and scans again."""
    scan = looked(2, 8.0)
    count = round(seconds * rate)
    rng = np.random.default_rng(3)
    time = [scan.time, 8 + np.arange(count) / rate, 8 + seconds + scan.time]
    points = [scan.points, 500 + rng.normal(0, 1, (count, 2)), scan.points]
    valid = [scan.valid, np.ones(count, dtype=np.bool_), scan.valid]
    return Pixels(floats(np.concatenate(time)), floats(np.concatenate(points)), bools(np.concatenate(valid)))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [5, 256])
def test_a_long_fixation_is_found_whole_at_linear_cost(monkeypatch: pytest.MonkeyPatch, method: str, size: int) -> None:
    counted: list[int] = []

    def counting(time: Floats, *arguments: Any, **options: Any) -> Classified:
        counted.append(len(time))
        return classify(time, *arguments, **options)

    monkeypatch.setattr("higvf_interfaces.gaze.chunked_fixations.classify", counting)
    costs: list[int] = []
    for seconds in (10.0, 20.0):
        counted.clear()
        whole = stare(seconds)
        chunks = list(classify_blocks(cut(whole, size), method=method))
        expected = spans(classify(*whole, method=method))
        assert max(end - start for start, end in expected.tolist()) == pytest.approx(seconds, abs=0.1)
        np.testing.assert_allclose(np.concatenate([spans(chunk) for chunk in chunks]), expected, atol=1e-9)
        costs.append(sum(counted))
    assert costs[1] < 2 * costs[0], "twice the stare costs less than twice as much, and not four times"


@pytest.mark.parametrize("count", [0, 1, 2])
def test_recordings_of_at_most_two_samples_are_classified(count: int) -> None:
    tiny = Pixels(floats(np.arange(count)), np.zeros((count, 2)), np.ones(count, dtype=np.bool_))
    assert sum(len(chunk.time) for chunk in classify_blocks([tiny])) == count
