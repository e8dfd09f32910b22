"""What a team that is not integrated here adds to the safety problem: robots that count as obstacles, and a budget."""

from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, Ints, floats, ints
from higvf_console.core.state import CAPSULE, World


class Guard(NamedTuple):
    """What the safety filter must know besides world and parameters.

    Attributes:
        budget: by how much all clearances grow [m], see `controlled`.
        standing: (K,) robots (index from 0) that stand while others drive.
        discs: (K, 5) where they may be, as capsules of the world [m].
    """

    budget: float = 0.0
    standing: Ints = ints([])
    discs: Floats = floats([], 0, CAPSULE)


NO_GUARD = Guard()


def guarded(world: World, guard: Guard) -> World:
    """The world in which robots that stand while others drive are obstacles, behind all others."""
    if not len(guard.standing):
        return world
    return world._replace(
        capsules=np.concatenate((world.capsules, guard.discs)),
        capsule_velocity=np.concatenate((world.capsule_velocity, np.zeros((len(guard.discs), 2)))),
    )
