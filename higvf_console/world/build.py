"""The one way to make a `World`: compiled from a layout, its obstacles grouped."""

from collections.abc import Sequence

import numpy as np

from higvf_console.control.guidance.groups import Groups, group_obstacles
from higvf_console.control.guidance.obstacles import capsule_table
from higvf_console.control.parameters import controlled
from higvf_console.core.arrays import Floats, Ints, floats, ints
from higvf_console.core.state import MOVER_PART, World
from higvf_console.core.viewport import Arena
from higvf_console.world.layout import Layout, Links
from higvf_console.world.obstacles import Obstacles

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
        mover, course, course_start = _courses(obstacles, capsules)
        still = np.setdiff1d(np.arange(len(capsules)), mover[:, MOVER_PART].astype(np.int64))
        clearance, scale = controlled(layout.params).safety.obstacle_clearance, layout.params.scale.length
        groups = group_obstacles(floats(capsules[still]), clearance, scale)
        groups = groups._replace(part=ints(still[groups.part], -1))
    else:
        capsules, mover, course, course_start = before.capsules, before.mover, before.course, before.course_start
        groups = Groups(before.boundary, before.boundary_start, before.hull, before.part, before.pocket)
    return World(
        capsules=capsules,
        circle_count=len(obstacles.circles),
        capsule_velocity=np.zeros((len(capsules), 2)),
        mover=mover,
        course=course,
        course_start=course_start,
        walls=_walls(layout.arena) if layout.walls else floats([], 0, 3),
        fire_position=layout.fire_position,
        fire_growth=floats([fire.growth for fire in fires], -1),
        fire_needs=ints([fire.needs for fire in fires], -1),
        formation=floats(layout.formation, -1, 2),
        link_start=link_start,
        link_to=link_to,
        boundary=groups.boundary,
        boundary_start=groups.boundary_start,
        hull=groups.hull,
        part=groups.part,
        pocket=groups.pocket,
    )


def _courses(obstacles: Obstacles, capsules: Floats) -> tuple[Floats, Floats, Ints]:
    """`mover`, `course` and `course_start` as `state.World` holds them."""
    movers = obstacles.movers()
    mover = [[row, *capsules[row, :4], course.speed, course.start, course.ending] for row, course in movers]
    points = [np.zeros((0, 3)), *(course.points for _, course in movers)]
    return floats(mover, -1, 8), floats(np.concatenate(points)), ints(np.cumsum([len(piece) for piece in points]))


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
