"""The one way to make a `World`: parts, fires, links and shape in, groups of obstacles found."""

from collections.abc import Sequence

import numpy as np

from higvf_console.control.guidance.groups import group_obstacles
from higvf_console.control.guidance.obstacles import capsule_table
from higvf_console.core.arrays import Floats, Ints, floats, ints
from higvf_console.core.state import World

NO_LINKS = (ints([]), ints([]))


def make_world(
    circles: Floats, bars: Floats, walls: Floats, fire_position: Floats, fire_growth: Floats, fire_needs: Ints,
    formation: Floats, clearance: float, links: tuple[Ints, Ints] = NO_LINKS, polygons: Sequence[Floats] = (),
) -> World:  # fmt: skip
    """A world whose obstacles are grouped for robots that keep `clearance` (R_o) from them.

    Args:
        circles: (P, 3) x, y, radius [m].
        bars: (Q, 5) ax, ay, bx, by, half width [m].
        walls: (W, 3) unit inward normal and offset [m].
        fire_position: (M, 2) [m].
        fire_growth: (M,) [m/s].
        fire_needs: (M,) robots.
        formation: (N, 2) shape [m].
        clearance: R_o [m].
        links: rows of neighbours, see `World`; none = the communication range decides.
        polygons: corners (n, 2) of irregular obstacles [m]; their edges follow the bars.
    """
    capsules = capsule_table(circles, np.concatenate([floats(bars, -1, 5), edge_bars(polygons)]))
    groups = group_obstacles(capsules, clearance)
    return World(
        capsules=capsules,
        circle_count=len(floats(circles, -1, 3)),
        walls=floats(walls, -1, 3),
        fire_position=floats(fire_position, -1, 2),
        fire_growth=floats(fire_growth, -1),
        fire_needs=ints(fire_needs, -1),
        formation=floats(formation, -1, 2),
        link_start=links[0],
        link_to=links[1],
        boundary=groups.boundary,
        boundary_start=groups.boundary_start,
        hull=groups.hull,
        part=groups.part,
        pocket=groups.pocket,
    )


def edges(corners: Floats) -> Floats:
    """The edges of a closed polygon (n, 2) as bars (n, 5) without width [m]."""
    return np.concatenate([corners, np.roll(corners, -1, axis=0), np.zeros((len(corners), 1))], axis=1)


def edge_bars(polygons: Sequence[Floats]) -> Floats:
    """The edges (E, 5) of closed polygons, in order, as bars without width [m]."""
    return np.concatenate([np.zeros((0, 5)), *(edges(corners) for corners in polygons)])
