"""The operator's hand: the desired path with its direction, the growing stroke, the cursor of gaze or pointer."""

import numpy as np

from higvf_console.control.guidance.paths import path_points
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import Path, PathKind, PointerState, SimState
from higvf_console.core.viewport import Arena
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.glyphs import Triangles, merged
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.theme import NOMINAL, mixed

_CORNERS = 320  # of a drawn path
_MOST_STROKE_POINTS = 400
_CHEVRON_SPACING = 60.0  # [px]
_CHEVRON = 13.0  # [px]
_CURSOR = 11.0  # radius [px]


class PathLayer:
    """The path is drawn when it changes, its travelled part greyed about five times a second."""

    def __init__(self, canvas: Canvas) -> None:
        """Starts without a path."""
        self._canvas, ink = canvas, canvas.palette
        self._ahead = canvas.lines(Layer.PATH, "/hand/ahead", ink.operator, NOMINAL.path)
        done = mixed(ink.operator, ink.floor, 0.72)
        self._done = canvas.lines(Layer.PATH, "/hand/done", done, NOMINAL.path)
        self._chevrons = canvas.mesh(Layer.CHEVRON, "/hand/chevrons", merged([]), ink.operator)
        self._stroke = canvas.lines(Layer.STROKE, "/hand/stroke", ink.stroke, 2.5)
        self._stroke_shown: Floats | None = None
        self._cursor = canvas.marks(Layer.CURSOR, "/hand/cursor", cursor_shape(canvas.px), count=1, colour=ink.gaze)
        pupil = shapes.filled(shapes.circle(0, 0, 5 * canvas.px))
        self._clutch = canvas.marks(Layer.CURSOR, "/hand/clutch", pupil, count=1, colour=ink.operator)
        self._path: Path | None = None
        self._outline = floats([], 0, 2)
        self._arc = floats([])
        self._travelled = -1.0

    def update(self, state: SimState) -> None:
        """Shows path, stroke and cursor of a snapshot."""
        path = state.intent.path
        if path is not self._path:
            self._path, self._travelled = path, -1.0
            self._arc, self._outline = path_outline(path, self._canvas.arena)
            px = self._canvas.px
            heads = shapes.chevrons(self._outline, _CHEVRON_SPACING * px, _CHEVRON * px, path.direction)
            self._chevrons.reshape(heads if len(self._outline) > 1 else merged([]))
        self._split(path, state.motion.path_parameter)
        self._draw_hand(state.pointer_state)

    def _split(self, path: Path, parameter: float) -> None:
        travelled = 0.0 if path.closed or path.kind == PathKind.LINE else parameter
        if abs(travelled - self._travelled) < 2 * self._canvas.px and self._travelled >= 0.0:
            return
        self._travelled = travelled
        if len(self._outline) < 2:
            self._ahead.draw(floats([], 0, 2, 2))
            self._done.draw(floats([], 0, 2, 2))
            return
        pieces = shapes.segments(self._outline)
        ahead = self._arc[1:] > travelled if path.direction > 0 else self._arc[:-1] < travelled
        if path.closed or path.kind == PathKind.LINE:
            ahead = np.ones(len(pieces), np.bool_)
        self._ahead.draw(pieces[ahead])
        self._done.draw(pieces[~ahead])

    def _draw_hand(self, pointer_state: PointerState) -> None:
        if pointer_state.stroke is not self._stroke_shown:
            self._stroke_shown = pointer_state.stroke
            self._stroke.draw(shapes.segments(thinned(pointer_state.stroke, _MOST_STROKE_POINTS)))
        seen = bool(np.isfinite(pointer_state.cursor).all())
        self._cursor.show(seen)
        self._clutch.show(seen and pointer_state.clutch)
        if seen:
            self._cursor.place(pointer_state.cursor[None, :])
            self._clutch.place(pointer_state.cursor[None, :])


def path_outline(path: Path, arena: Arena) -> tuple[Floats, Floats]:
    """Arc lengths (n,) and points (n, 2) [m] of a path as it is drawn; a line is cut at the arena's border."""
    if path.kind == PathKind.NONE:
        return floats([]), floats([], 0, 2)
    if path.kind == PathKind.LINE:
        return _line_inside(path, arena)
    arc = np.linspace(0.0, path.length, _CORNERS + 1)
    if path.closed:
        arc[-1] = 0.0
    points = path_points(path, arc)
    arc[-1] = path.length
    return arc, points


def _line_inside(path: Path, arena: Arena) -> tuple[Floats, Floats]:
    x, y, cos, sin = path.shape
    low, high = -np.inf, np.inf
    for start, slope, least, most in ((x, cos, arena.x_min, arena.x_max), (y, sin, arena.y_min, arena.y_max)):
        if abs(slope) > 1e-9:
            enter, leave = sorted([(least - start) / slope, (most - start) / slope])
            low, high = max(low, enter), min(high, leave)
        elif not least <= start <= most:
            high = -np.inf
    if low >= high:
        return floats([]), floats([], 0, 2)
    arc = np.linspace(low, high, 33)
    return arc, path_points(path, arc)


def thinned(points: Floats, most: int) -> Floats:
    """At most `most` of the points (n, 2), evenly chosen, both ends among them."""
    if len(points) <= most:
        return points
    return points[np.linspace(0, len(points) - 1, most).astype(np.int64)]


def cursor_shape(px: float) -> Triangles:
    """A thin ring with four ticks: where the operator looks."""
    ring = shapes.annulus((_CURSOR - 1.6) * px, _CURSOR * px)
    inner, outer, half = (_CURSOR - 4) * px, (_CURSOR + 4) * px, 0.8 * px
    ticks = [
        shapes.filled(shapes.rectangle(inner, -half, outer, half)),
        shapes.filled(shapes.rectangle(-outer, -half, -inner, half)),
        shapes.filled(shapes.rectangle(-half, inner, half, outer)),
        shapes.filled(shapes.rectangle(-half, -outer, half, -inner)),
    ]
    return merged([ring, *ticks])
