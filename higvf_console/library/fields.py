"""The vector fields of the controller on points of one's own, to draw or to study them."""

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.guidance.field import FieldKind, field_at
from higvf_console.core.arguments import one_of
from higvf_console.core.arrays import FARTHEST, Floats, given_floats
from higvf_console.core.errors import ArgumentError
from higvf_console.core.state import SimState
from higvf_console.library.records import given_state
from higvf_console.library.stepping import given_setup
from higvf_console.runtime.compiling import announce
from higvf_console.world.setup import Setup

_KINDS = {kind.name.lower(): kind for kind in FieldKind}


def vector_field(points: ArrayLike, setup: Setup, state: SimState | None = None, kind: str = "composite") -> Floats:
    """Velocities that the method wants at points of the ground.

    Args:
        points: (G, 2) where [m].
        setup: world and parameters, with at least one robot.
        state: path, robots and fires as they are; None = those of the start.
        kind: "path", the guiding vector field of the path in force at cruise speed, [2]; "composite", the same round
            the obstacles, [8]; "blended", what the influenced robot would want there, [18].

    Returns:
        (G, 2) [m/s]; zero for the first two kinds where no path is in force.

    Raises:
        ArgumentError: an argument has another shape or type, or is out of range.
    """
    place = given_setup(setup)
    now = place.start if state is None else given_state(state, place.world)
    which = _KINDS[one_of("kind", kind, tuple(_KINDS))]
    where = given_floats("points", points, ("G", 2), most=FARTHEST)
    if not len(now.motion.position):
        raise ArgumentError("setup has no robots; expected at least one, whose field this is")
    announce()
    return field_at(which, where, now, place.world, place.params) if len(where) else np.zeros((0, 2))
