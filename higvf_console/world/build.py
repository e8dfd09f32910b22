"""The one way to make a `World`: compiled from a layout, its obstacles grouped."""

from collections.abc import Sequence

import numpy as np

from higvf_console.control.guidance.groups import group_obstacles
from higvf_console.control.guidance.obstacles import capsule_table
from higvf_console.control.parameters import controlled
from higvf_console.core.arrays import Floats, Ints, floats, ints
from higvf_console.core.state import World
from higvf_console.core.viewport import Arena
from higvf_console.world.layout import Layout, Links

_NO_LINKS = (ints([]), ints([]))


def build_world(layout: Layout, before: World | None = None) -> World:
    """The world that the kernels see.

    Args:
        layout: what it is made of.
        before: a world with the same obstacles and clearance, whose groups of obstacles are taken over.
    """
    obstacles, fires = layout.obstacles, layout.fires
    link_start, link_to = _NO_LINKS if layout.links is None else link_table(layout.links, len(layout.formation))
    if before is None:
        bars = np.concatenate([floats(obstacles.bars, -1, 5), edge_bars(obstacles.polygons)])
        capsules = capsule_table(obstacles.circles, bars)
        groups = group_obstacles(capsules, controlled(layout.params).safety.obstacle_clearance)
    else:
        capsules = before.capsules
        groups = before.boundary, before.boundary_start, before.hull, before.part, before.pocket
    boundary, boundary_start, hull, part, pocket = groups
    return World(
        capsules=capsules,
        circle_count=len(obstacles.circles),
        walls=_walls(layout.arena) if layout.walls else floats([], 0, 3),
        fire_position=layout.fire_position,
        fire_growth=floats([fire.growth for fire in fires], -1),
        fire_needs=ints([fire.needs for fire in fires], -1),
        formation=floats(layout.formation, -1, 2),
        link_start=link_start,
        link_to=link_to,
        boundary=boundary,
        boundary_start=boundary_start,
        hull=hull,
        part=part,
        pocket=pocket,
    )


def link_table(links: Links, robots: int) -> tuple[Ints, Ints]:
    """Links as the rows of neighbours that `state.World` holds: (link_start, link_to)."""
    both = sorted([*links, *((j, i) for i, j in links)])
    degree = np.bincount([i for i, _ in both], minlength=robots)
    return ints(np.concatenate([[0], np.cumsum(degree)])), ints([j for _, j in both], -1)


def edges(corners: Floats) -> Floats:
    """The edges of a closed polygon (n, 2) as bars (n, 5) without width [m]."""
    return np.concatenate([corners, np.roll(corners, -1, axis=0), np.zeros((len(corners), 1))], axis=1)


def edge_bars(polygons: Sequence[Floats]) -> Floats:
    """The edges (E, 5) of closed polygons, in order, as bars without width [m]."""
    return np.concatenate([np.zeros((0, 5)), *(edges(corners) for corners in polygons)])


def _walls(arena: Arena) -> Floats:
    """The four sides (4, 3) as walls."""
    return floats([(1, 0, arena.x_min), (-1, 0, -arena.x_max), (0, 1, arena.y_min), (0, -1, -arena.y_max)])
