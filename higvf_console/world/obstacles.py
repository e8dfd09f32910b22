"""The obstacles of a world, as people give them."""

from typing import NamedTuple

from higvf_console.core.arrays import Floats, floats


class Obstacles(NamedTuple):
    """What stands in the way.

    Attributes:
        circles: (P, 3) as in `state.World`.
        bars: (Q, 5) as in `state.World`, without the edges of polygons.
        polygons: closed chains (n, 2) [m] as in `world.polygons`: those of the file, then those of its masks.
    """

    circles: Floats
    bars: Floats
    polygons: tuple[Floats, ...]


NO_OBSTACLES = Obstacles(floats([], 0, 3), floats([], 0, 5), ())
