"""What a run starts from: the layout, the world compiled of it, and the initial state."""

from typing import NamedTuple

from higvf_console.control.parameters import Parameters, controlled
from higvf_console.core.arrays import Floats
from higvf_console.core.state import SimState, World
from higvf_console.core.viewport import Arena
from higvf_console.sim.simulation import initial_state
from higvf_console.world.build import build_world
from higvf_console.world.layout import Layout


class Setup(NamedTuple):
    """A run before its first tick.

    Attributes:
        layout: what the world is made of; the source of truth.
        world: compiled of the layout by `world.build`.
        start: the state before the first tick; its fires have the radii of the layout.
    """

    layout: Layout
    world: World
    start: SimState

    @property
    def arena(self) -> Arena:
        """What the operator sees."""
        return self.layout.arena

    @property
    def params(self) -> Parameters:
        """All tunables."""
        return self.layout.params


def make_setup(layout: Layout, position: Floats) -> Setup:
    """The setup whose robots are at rest with their controlled points at `position` (N, 2) [m]."""
    world = build_world(layout)
    return Setup(layout, world, initial_state(position, layout.fire_radius, world))


def with_params(setup: Setup, params: Parameters) -> Setup:
    """The setup with other tunables, started from the same state."""
    layout = setup.layout._replace(params=params)
    return setup._replace(layout=layout, world=rebuilt(layout, setup))


def rebuilt(layout: Layout, before: Setup) -> World:
    """The world of a layout; groups of obstacles are taken over where obstacles and clearance are as before."""
    same = layout.obstacles is before.layout.obstacles and _clearance(layout) == _clearance(before.layout)
    return build_world(layout, before.world if same else None)


def _clearance(layout: Layout) -> float:
    return controlled(layout.params).safety.obstacle_clearance
