"""How far points are from the nearest obstacle: the search for safe places asks it again and again."""

from collections.abc import Callable

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.outline import enclosed
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.polygons import edges, obstacles_of, signed_distance, spine_distance


def obstacle_room(obstacles: Obstacles) -> Callable[[Floats], Floats]:
    """Gives the distance (n,) of points (n, 2) from the nearest surface [m]: negative inside, inf without obstacles."""
    circles, bars = obstacles.circles, obstacles.bars
    spines = np.concatenate([bars[:, :4], edges(obstacles.polygons)])
    half_width = np.concatenate([bars[:, 4], np.zeros(len(spines) - len(bars))])
    shapes = obstacles_of(obstacles.polygons)

    def room(points: Floats) -> Floats:
        to_circles = np.hypot(points[:, :1] - circles[:, 0], points[:, 1:] - circles[:, 1]) - circles[:, 2]
        nearest = to_circles.min(axis=1, initial=np.inf)
        nearest = np.minimum(nearest, (spine_distance(points, spines) - half_width).min(axis=1, initial=np.inf))
        for chains in shapes:
            inside = np.logical_xor.reduce([enclosed(chain, points) for chain in chains])
            if inside.any():
                nearest[inside] = np.minimum(nearest[inside], signed_distance(chains, points[inside]))
        return floats(nearest)

    return room
