"""Where the robots of a real team were measured last, and where those that stand may be: what the guard keeps clear."""

from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.sim.guard import Guard
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.theme import NOMINAL, mixed
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from higvf_console.team.state import TeamState

_FAINT = 0.4  # share of the floor in the colour of a measured pose


class MeasuredLayer:
    """A pale ring at each measured pose, under the mark where its robot is now; discs of robots that stand."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Starts with nothing measured."""
        ink, px = canvas.palette, canvas.px
        robots = len(setup.start.motion.position)
        self._hidden = np.full((robots, 2), 1e3 * (setup.arena.x_max - setup.arena.x_min))  # out of sight
        outer = max(setup.params.scale.body_radius, 0.6 * NOMINAL.robot * px)
        ring = shapes.annulus(outer - 1.5 * px, outer, 32)
        pale = mixed(ink.robot, ink.floor, _FAINT)
        self._rings = canvas.marks(Layer.GHOST, "/team/measured", ring, count=robots, colour=pale)
        self._rings.show(False)
        self._discs = canvas.lines(Layer.GHOST, "/team/standing", ink.trouble, 1.5)

    def update(self, team: "TeamState | None", guard: Guard) -> None:
        """Shows a team as it was last heard of; nothing where all robots are integrated."""
        self._rings.show(team is not None)
        if team is None:
            return
        self._rings.place(np.where(team.track.seen[:, None], team.track.position, self._hidden))
        self._discs.draw(disc_outlines(guard.discs))


def disc_outlines(discs: Floats) -> Floats:
    """Segments (s, 2, 2) round the places (K, 5) where robots that stand may be."""
    outlines = [shapes.segments(shapes.circle(x, y, radius, 40)) for x, y, _, _, radius in discs.tolist()]
    return np.concatenate(outlines) if outlines else floats([], 0, 2, 2)
