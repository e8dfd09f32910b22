"""What a world is made of, as people edit it; `state.World` is what the kernels make of it."""

from typing import NamedTuple

import numpy as np

from higvf_console.control.parameters import Parameters, controlled
from higvf_console.core.arrays import Floats, Ints, floats, ints
from higvf_console.core.state import World
from higvf_console.core.viewport import Arena
from higvf_console.sim.setup import Setup
from higvf_console.world.build import NO_LINKS, make_world
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.placement import link_table

Links = tuple[tuple[int, int], ...]


class Layout(NamedTuple):
    """All that can be edited but for where robots are and how large fires have grown: N robots, M fires.

    Attributes:
        arena: what the operator sees.
        walls: whether its sides are barriers.
        obstacles: circles, bars and polygons.
        fire_position: (M, 2) [m].
        fire_growth: (M,) [m/s].
        fire_needs: (M,) robots that it takes to extinguish it.
        formation: (N, 2) shape [m].
        links: given links as index pairs i < j; None = the communication range decides.
        params: all tunables.
    """

    arena: Arena
    walls: bool
    obstacles: Obstacles
    fire_position: Floats
    fire_growth: Floats
    fire_needs: Ints
    formation: Floats
    links: Links | None
    params: Parameters


def layout_of(setup: Setup) -> Layout:
    """What a setup is made of."""
    world = setup.world
    edges = sum(len(chain) for chain in setup.polygons)
    obstacles = Obstacles(world.circles, world.bars[: len(world.bars) - edges], setup.polygons)
    links = None if len(world.link_start) == 0 else link_pairs(world)
    return Layout(
        arena=setup.arena,
        walls=len(world.walls) > 0,
        obstacles=obstacles,
        fire_position=world.fire_position,
        fire_growth=world.fire_growth,
        fire_needs=world.fire_needs,
        formation=world.formation,
        links=links,
        params=setup.params,
    )


def link_pairs(world: World) -> Links:
    """The given links of a world, as index pairs i < j."""
    first = np.repeat(np.arange(len(world.link_start) - 1), np.diff(world.link_start))
    return tuple((i, j) for i, j in zip(first.tolist(), world.link_to.tolist(), strict=True) if i < j)


def world_of(layout: Layout, before: World | None = None) -> World:
    """The world that the kernels see.

    Args:
        layout: what it is made of.
        before: a world with the same obstacles and clearance, whose groups of obstacles are taken over.
    """
    arena, obstacles = layout.arena, layout.obstacles
    sides = [(1, 0, arena.x_min), (-1, 0, -arena.x_max), (0, 1, arena.y_min), (0, -1, -arena.y_max)]
    walls = floats(sides if layout.walls else [], -1, 3)
    links = NO_LINKS if layout.links is None else link_table(layout.links, len(layout.formation))
    fires = floats(layout.fire_position, -1, 2), floats(layout.fire_growth, -1), ints(layout.fire_needs, -1)
    if before is not None:
        position, growth, needs = fires
        return before._replace(
            walls=walls, fire_position=position, fire_growth=growth, fire_needs=needs,
            formation=floats(layout.formation, -1, 2), link_start=links[0], link_to=links[1],
        )  # fmt: skip
    return make_world(
        obstacles.circles, obstacles.bars, walls, *fires, layout.formation,
        controlled(layout.params).safety.obstacle_clearance, links, obstacles.polygons,
    )  # fmt: skip
