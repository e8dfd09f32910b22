"""What is being edited: outline and handles of the selected entity, and the ghost of what is dragged."""

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import PathError
from higvf_console.core.state import NOBODY, SimState
from higvf_console.operator.path_commands import in_hand
from higvf_console.operator.path_edits import bent
from higvf_console.ui.interaction.grips import Drag, handles_of, outlines, wished
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.ground import joined
from higvf_console.ui.scene.parts import Canvas, Layer, Lines, Marks
from higvf_console.ui.scene.path import path_outline
from higvf_console.world.editing.entities import EntityRef, centres, exists, numbers_of
from higvf_console.world.setup import Setup

_SQUARE, _DISC = 5.0, 6.0  # half a side, radius [px]
_DASH = 6.0  # [px]
_NOTHING = floats([], 0, 2, 2)


class EditLayer:
    """Dashed outline and handles of the selected entity; the ghost is drawn through."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Starts with nothing chosen."""
        self._canvas, self._layout, ink, px = canvas, setup.layout, canvas.palette, canvas.px
        self._chosen = canvas.lines(Layer.CURSOR, "/edit/chosen", ink.operator, 2.0)
        self._ghost = canvas.lines(Layer.CURSOR, "/edit/ghost", ink.stroke, 2.5)
        square = shapes.filled(shapes.rectangle(-_SQUARE * px, -_SQUARE * px, _SQUARE * px, _SQUARE * px))
        disc = shapes.filled(shapes.circle(0.0, 0.0, _DISC * px, 24))
        self._square = canvas.marks(Layer.CURSOR, "/edit/square", square, count=1, colour=ink.operator)
        self._disc = canvas.marks(Layer.CURSOR, "/edit/disc", disc, count=1, colour=ink.operator)
        self._placed: EntityRef | None = None  # the choice that is in place
        self._dragged = False  # whether the ghost is

    def update(self, state: SimState, selected: EntityRef | None, drag: Drag | None, *, handles: bool = True) -> None:
        """Shows the choice, its handles where they can be held, and what the hand would do.

        A page takes up place and visibility of a node one after the other: what has just been chosen or gripped is put
        in place hidden, and shown by the next update.
        """
        self._ghost.draw(_NOTHING if drag is None else self._ghost_of(drag, state))
        _show(self._ghost, self._dragged and drag is not None)
        self._dragged = drag is not None
        motion, layout, px = state.motion, self._layout, self._canvas.px
        if selected is None or not exists(selected, layout):
            selected = None
        placed, self._placed = selected is not None and selected == self._placed, selected
        points: dict[bool, list[Floats]] = {False: [], True: []}
        if selected is None:
            self._chosen.draw(_NOTHING)
        else:
            dash = _DASH * px
            now = outlines(selected, numbers_of(selected, layout, motion), layout, motion, px)
            self._chosen.draw(joined([shapes.dashed(outline, dash, dash) for outline in now]))
            for handle in handles_of(selected, layout, motion, px) if handles else []:
                points[handle.turns].append(handle.point)
        _show(self._chosen, placed)
        for marks, turns in ((self._square, False), (self._disc, True)):
            if points[turns]:
                marks.place(floats(points[turns], -1, 2)[:1])
            _show(marks, placed and bool(points[turns]))

    def _ghost_of(self, drag: Drag, state: SimState) -> Floats:
        motion, layout = state.motion, self._layout
        if drag.moves_path:
            return self._bent(drag, state)
        if drag.link != NOBODY and drag.link < len(motion.position):
            return floats([[centres(layout, motion)[drag.link], drag.now]])
        if drag.place is None or not exists(drag.place, layout):
            return _NOTHING
        found = outlines(drag.place, wished(drag, layout, motion), layout, motion, self._canvas.px)
        return joined([shapes.segments(outline) for outline in found])

    def _bent(self, drag: Drag, state: SimState) -> Floats:
        try:
            path = bent(in_hand(state), drag.start, drag.now, self._layout.params.scale)
        except PathError:
            return _NOTHING
        return shapes.segments(path_outline(path, self._canvas.arena)[1])


def _show(drawn: Lines | Marks, visible: bool) -> None:
    """Shows or hides something, whose place is sent in either case."""
    drawn.show(visible)
    drawn.send()
