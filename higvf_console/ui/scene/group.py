"""The group that the next path is for: a dashed ring round each of its robots."""

from higvf_console.core.arrays import floats
from higvf_console.core.state import SimState
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.ground import joined
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.world.editing.entities import centres
from higvf_console.world.layout import Layout

_RADIUS, _DASH = 15.0, 5.0  # [px]
_NOBODY = floats([], 0, 2, 2)


class GroupLayer:
    """The rings."""

    def __init__(self, canvas: Canvas, layout: Layout) -> None:
        """Starts with nobody in the group."""
        self._layout, self._px = layout, canvas.px
        self._rings = canvas.lines(Layer.HALO, "/team/group", canvas.palette.operator, 2.0)

    def update(self, state: SimState, group: frozenset[int]) -> None:
        """Shows who is in the group (indices from 0)."""
        at, dash = centres(self._layout, state.motion), _DASH * self._px
        grouped = [robot for robot in sorted(group) if robot < len(at)]
        circles = [shapes.circle(x, y, _RADIUS * self._px) for x, y in at[grouped]]
        self._rings.draw(joined([shapes.dashed(circle, dash, dash) for circle in circles]) if circles else _NOBODY)
