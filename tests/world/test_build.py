"""The compiled world follows from the layout alone, and a setup agrees with itself about its fires."""

from itertools import pairwise

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import OperatorCommand
from higvf_console.core.edits import AddEntity, ChangeEntity, DeleteEntity, MoveEntity
from higvf_console.core.viewport import Arena
from higvf_console.scenario.scenario import load_scenario, scenario_names
from higvf_console.world.build import build_world
from higvf_console.world.layout import Fire, Layout
from higvf_console.world.obstacles import Obstacles
from tests.world.editing.actions import assert_same, edited_run, give, refused

TRIANGLE = floats([[300.0, 300.0], [360.0, 300.0], [300.0, 360.0]])
LAYOUT = Layout(
    arena=Arena(-10.0, 0.0, 500.0, 400.0),
    formation=floats([[0.0, 0.0], [40.0, 0.0], [80.0, 0.0]]),
    obstacles=Obstacles(floats([[100.0, 100.0, 20.0]]), floats([[200.0, 200.0, 260.0, 200.0, 6.0]]), (TRIANGLE,)),
    fires=(Fire((400.0, 50.0), 20.0, 1.5, 2),),
    links=((0, 1), (1, 2)),
)


def test_the_edges_of_polygons_follow_the_bars() -> None:
    world = build_world(LAYOUT)
    assert world.bars[0].tolist() == [200.0, 200.0, 260.0, 200.0, 6.0]
    np.testing.assert_array_equal(world.bars[1:, :2], TRIANGLE)
    np.testing.assert_array_equal(world.bars[1:, 2:4], np.roll(TRIANGLE, -1, axis=0))
    assert not world.bars[1:, 4].any()


def test_walls_are_the_sides_of_the_arena_or_none() -> None:
    assert build_world(LAYOUT).walls.tolist() == [[1, 0, -10], [-1, 0, -500], [0, 1, 0], [0, -1, -400]]
    assert build_world(LAYOUT._replace(walls=False)).walls.shape == (0, 3)


def test_each_link_is_listed_at_both_of_its_robots() -> None:
    world = build_world(LAYOUT)
    rows = [world.link_to[first:last].tolist() for first, last in pairwise(world.link_start)]
    assert rows == [[1], [0, 2], [1]]
    assert len(build_world(LAYOUT._replace(links=None)).link_start) == 0
    assert len(build_world(LAYOUT._replace(links=())).link_start) == 4, "no links given is not the same as none"


def test_fires_keep_their_order() -> None:
    world = build_world(LAYOUT._replace(fires=(*LAYOUT.fires, Fire((1.0, 2.0), 3.0, 4.0, 1))))
    assert world.fire_position.tolist() == [[400.0, 50.0], [1.0, 2.0]]
    assert world.fire_growth.tolist() == [1.5, 4.0]
    assert world.fire_needs.tolist() == [2, 1]


@pytest.mark.parametrize("name", scenario_names())
def test_the_world_of_every_shipped_scenario_is_built_of_its_layout(name: str) -> None:
    setup = load_scenario(name).setup()
    assert_same(setup.world, build_world(setup.layout))
    assert setup.start.motion.fire_radius.tolist() == setup.layout.fire_radius.tolist()


@pytest.mark.parametrize("ticks", [0, 3])
@pytest.mark.parametrize(
    "command",
    [
        AddEntity("fire", floats([1000.0, 100.0])),
        MoveEntity("fire", 0, floats([1000.0, 100.0])),
        ChangeEntity("fire", 0, "radius", 25.0),
        ChangeEntity("fire", 0, "growth", 2.0),
        DeleteEntity("fire", 0),
    ],
)
def test_the_fires_of_a_layout_are_those_that_a_run_starts_with(command: OperatorCommand, ticks: int) -> None:
    run = edited_run("unicycles", ticks=ticks)
    assert not refused(give(run, command))
    assert run.setup.layout.fire_radius.tolist() == run.setup.start.motion.fire_radius.tolist()
    assert_same(run.setup.world, build_world(run.setup.layout))
