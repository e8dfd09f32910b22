"""Fixation centroids give a smooth path between the first and the last centroid."""

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_interfaces.gaze.path import gaze_path


def test_a_circle_of_centroids_has_its_radius_and_length() -> None:
    angle = np.linspace(0, np.pi, 15)
    path = gaze_path(floats(np.stack([200 * np.cos(angle), 200 * np.sin(angle)], axis=1)), smoothing=1.0)
    assert path.length == pytest.approx(200 * np.pi, rel=0.02)
    assert path.smallest_radius == pytest.approx(200, rel=0.3)


def test_the_ends_are_pinned_however_smooth_the_path() -> None:
    rng = np.random.default_rng(2)
    points = floats(np.stack([np.linspace(0, 900, 12), rng.normal(0, 12, 12)], axis=1))
    path = gaze_path(points, smoothing=12.0)
    np.testing.assert_allclose(path.curve[[0, -1]], points[[0, -1]], atol=0.5)


def test_a_path_through_centroids_has_less_curvature_than_one_through_raw_samples() -> None:
    rng = np.random.default_rng(3)
    centres = np.stack([np.linspace(0, 900, 10), 100 * np.sin(np.linspace(0, 3, 10))], axis=1)
    raw = np.repeat(centres, 30, axis=0) + rng.normal(0, 5, (300, 2))
    smooth, rough = gaze_path(floats(centres), 12.0), gaze_path(floats(raw), 1.0)
    assert smooth.smallest_radius > 20 * rough.smallest_radius


def test_repeated_and_unknown_centroids_are_ignored() -> None:
    points = floats([[0, 0], [0, 0], [np.nan, 1], [100, 0], [200, 0], [200, 0], [300, 0]])
    assert len(gaze_path(points, 1.0).distinct) == 4


@pytest.mark.parametrize("count", [0, 1, 3])
def test_too_few_centroids_make_no_curve(count: int) -> None:
    path = gaze_path(floats([[100.0 * k, 0.0] for k in range(count)], -1, 2), 1.0)
    assert len(path.curve) == 0
    assert np.isnan(path.smallest_radius)
