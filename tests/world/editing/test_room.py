"""The distance from the nearest obstacle is that from the nearest of all of them, one by one."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.core.arrays import floats
from higvf_console.world.editing.room import obstacle_room
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.placement import obstacle_gaps
from tests.world.editing.actions import edited_run

OBSTACLES = edited_run().setup.layout.obstacles


@given(points=st.lists(st.tuples(st.floats(0.0, 1200.0), st.floats(0.0, 700.0)), min_size=1, max_size=20))
def test_the_room_at_a_point_is_the_least_gap_to_any_obstacle(points: list[tuple[float, float]]) -> None:
    gaps = [gap for _, gap in obstacle_gaps(floats(points), OBSTACLES)]
    np.testing.assert_allclose(obstacle_room(OBSTACLES)(floats(points)), np.min(gaps, axis=0), atol=1e-9)


def test_without_obstacles_there_is_room_without_end() -> None:
    none = Obstacles(np.zeros((0, 3)), np.zeros((0, 5)), ())
    assert obstacle_room(none)(floats([[1.0, 2.0], [3.0, 4.0]])).tolist() == [np.inf, np.inf]
