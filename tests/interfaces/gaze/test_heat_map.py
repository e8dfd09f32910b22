"""The heat map is opaque where gaze has been and transparent elsewhere."""

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.viewport import Arena
from higvf_interfaces.gaze.heat_map import counts, heat_map, paint

ARENA = Arena(-100.0, 0.0, 1100.0, 700.0)


def test_the_maximum_is_at_the_place_of_most_gaze() -> None:
    points = floats([[800, 600]] * 50 + [[100, 100]] * 10)
    picture = heat_map(points, ARENA, 600, sigma=25.0)
    assert picture.shape == (350, 600, 4)
    row, column = np.unravel_index(np.argmax(picture[:, :, 3]), picture.shape[:2])
    assert abs(column - 450) <= 4
    assert abs(row - 50) <= 4, "row 0 is the top"
    red, _, blue, _ = picture[row, column].tolist()
    assert red > 100 > blue, "turbo: hot is red"


def test_the_map_is_transparent_without_gaze() -> None:
    picture = heat_map(floats([[800, 600]]), ARENA, 600, sigma=25.0)
    assert picture[300, 50, 3] == 0
    assert not heat_map(floats([], 0, 2), ARENA, 600, sigma=25.0)[:, :, 3].any()


def test_unknown_gaze_and_gaze_off_the_arena_are_ignored() -> None:
    grid = counts(floats([[np.nan, 1], [-101, 5], [5, 701], [-100, 0], [1100, 700]]), ARENA, 600)
    assert grid.sum() == 2
    assert grid[-1, 0] == 1
    assert grid[0, -1] == 1


def test_counts_of_parts_sum_to_the_counts_of_the_whole() -> None:
    points = floats(np.random.default_rng(1).uniform([-100, 0], [1100, 700], (500, 2)))
    parts = counts(points[:200], ARENA, 600) + counts(points[200:], ARENA, 600)
    np.testing.assert_array_equal(paint(parts, ARENA, 600, 25.0), heat_map(points, ARENA, 600, 25.0))
