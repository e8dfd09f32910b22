"""What is not yet so: tracks and ends of the team as foreseen, the path that waits, the robot that is proposed."""

from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import NO_PATH, NOBODY, Path, SimState
from higvf_console.operator.reducer import proposal
from higvf_console.sim.unicycle import body_centres
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.scene.path import path_outline
from higvf_console.ui.theme import NOMINAL, mixed
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from higvf_console.analysis.preview import Preview

_FAINT = 0.5  # share of the floor in a ghost's colour
_TRACK = 1.5  # [px]
_WARNING = 7.0  # [px]; wider than the stroke, which lies over it
_DASH = 9.0  # [px]


class Ghosts:
    """Redrawn when the preview is another; a preview is made a few times a second."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Starts with nothing foreseen."""
        self._canvas, self._setup = canvas, setup
        ink, px, robots = canvas.palette, canvas.px, len(setup.start.motion.position)
        faint_team, faint_chosen = (mixed(colour, ink.floor, _FAINT) for colour in (ink.robot, ink.operator))
        self._team = canvas.lines(Layer.GHOST, "/ghost/team", faint_team, _TRACK)
        self._chosen = canvas.lines(Layer.GHOST, "/ghost/chosen", faint_chosen, _TRACK)
        end = shapes.annulus(4.5 * px, 6.0 * px, 24)
        self._ends = canvas.marks(Layer.GHOST, "/ghost/ends", end, count=robots, colour=ink.robot, opacity=0.7)
        self._warning = canvas.lines(Layer.GHOST, "/ghost/repulsive", mixed(ink.fire_zone, ink.floor, 0.25), _WARNING)
        self._path = canvas.lines(Layer.STROKE, "/ghost/path", ink.operator, NOMINAL.path)
        ring = shapes.annulus(1.15 * NOMINAL.robot * px, 1.15 * NOMINAL.robot * px + 2.2 * px)
        self._proposed = canvas.marks(Layer.HALO, "/ghost/proposed", ring, count=1, colour=ink.operator, opacity=0.55)
        self._proposed.show(False)
        self._shown: Preview | None = None
        self._pending: Path = NO_PATH
        self._show(None)

    def update(self, state: SimState, preview: "Preview | None") -> None:
        """Shows what waits in a state, and what is foreseen."""
        if preview is not self._shown:
            self._shown = preview
            self._show(preview)
        if state.pointer_state.pending is not self._pending:
            self._pending = state.pointer_state.pending
            self._path.draw(dashes(self._pending, self._canvas))
        self._propose(state)

    def _show(self, preview: "Preview | None") -> None:
        self._ends.show(preview is not None)
        if preview is None:
            for lines in (self._team, self._chosen, self._warning):
                lines.draw(floats([], 0, 2, 2))
            return
        ink = self._canvas.palette
        chosen = np.arange(len(preview.tracks)) == preview.start.intent.influenced
        self._team.draw(track_segments(preview.tracks[~chosen]))
        self._chosen.draw(track_segments(preview.tracks[chosen]))
        self._warning.draw(preview.repulsive)
        self._ends.highlight(ink.robot, chosen, ink.operator)
        self._ends.place(preview.tracks[:, -1])

    def _propose(self, state: SimState) -> None:
        params, motion = self._setup.params, state.motion
        robot = proposal(state.pointer_state, motion.tick * params.safety.control_period)
        self._proposed.show(robot != NOBODY)
        if robot != NOBODY:
            centres = body_centres(motion.position, motion.heading, params.robots.look_ahead)
            self._proposed.place(centres[robot : robot + 1])


def track_segments(tracks: Floats) -> Floats:
    """Segments (s, 2, 2) of tracks (n, K, 2)."""
    return np.stack([tracks[:, :-1], tracks[:, 1:]], axis=2).reshape(-1, 2, 2)


def dashes(path: Path, canvas: Canvas) -> Floats:
    """Segments (s, 2, 2) of a path that waits."""
    outline = path_outline(path, canvas.arena)[1]
    return shapes.dashed(outline, _DASH * canvas.px, _DASH * canvas.px) if len(outline) > 1 else floats([], 0, 2, 2)
