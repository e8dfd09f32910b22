"""What a world is made of, as people give and edit it; `world.build` compiles the `state.World` of it."""

from typing import NamedTuple, TypeAlias

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.viewport import Arena
from higvf_console.world.obstacles import NO_OBSTACLES, Obstacles

Links: TypeAlias = tuple[tuple[int, int], ...]  # index pairs i < j


class Fire(NamedTuple):
    """A fire at the start of a run.

    Attributes:
        position: centre [m].
        radius: [m].
        growth: growth of the radius [m/s].
        needs: robots that it takes to extinguish it.
    """

    position: tuple[float, float]
    radius: float
    growth: float
    needs: int


class Layout(NamedTuple):
    """The source of truth of a world: N robots, M fires.

    Where robots are and how large fires have grown since the start is state, not layout.

    Attributes:
        arena: what the operator sees.
        formation: (N, 2) shape to keep [m].
        walls: whether the arena's four sides are barriers.
        obstacles: circles, bars and polygons.
        fires: in the order of their numbers.
        links: given communication links; None = the communication range decides.
        params: all tunables.
    """

    arena: Arena
    formation: Floats
    walls: bool = True
    obstacles: Obstacles = NO_OBSTACLES
    fires: tuple[Fire, ...] = ()
    links: Links | None = None
    params: Parameters = Parameters()

    @property
    def fire_position(self) -> Floats:
        """(M, 2) [m]."""
        return floats([fire.position for fire in self.fires], -1, 2)

    @property
    def fire_radius(self) -> Floats:
        """(M,) at the start of a run [m]."""
        return floats([fire.radius for fire in self.fires], -1)


def with_radii(fires: tuple[Fire, ...], radius: Floats) -> tuple[Fire, ...]:
    """The fires with the radii (M,) [m] that they have at the start of a run."""
    return tuple(fire._replace(radius=size) for fire, size in zip(fires, radius.tolist(), strict=True))
