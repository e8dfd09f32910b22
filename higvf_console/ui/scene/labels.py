"""Names of the obstacles, as the tab Why and messages call them: "circle 3"."""

from higvf_console.core.arrays import Floats
from higvf_console.core.edits import EntityKind
from higvf_console.core.state import SimState
from higvf_console.ui.scene.glyphs import lettering, merged
from higvf_console.ui.scene.parts import Canvas, Layer
from higvf_console.ui.theme import cap_height
from higvf_console.world.editing.entities import EntityRef, name_of
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.polygons import obstacles_of
from higvf_console.world.setup import Setup


class ObstacleLabels:
    """One mesh; drawn anew as long as obstacles move, and only while it is shown."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Starts hidden."""
        self._layout = setup.layout
        self._moves = bool(setup.layout.obstacles.movers())
        self._size = cap_height(canvas.sizes.axis_text) * canvas.px
        self._text = canvas.mesh(Layer.OBSTACLE_TEXT, "/ground/names", merged([]), canvas.palette.text)
        self._tick: int | None = None  # of which the names are drawn

    def update(self, state: SimState, visible: bool) -> None:
        """Shows or hides the names."""
        tick = state.motion.tick if self._moves else 0
        if visible and tick != self._tick:
            self._tick = tick
            obstacles = self._layout.obstacles_at(tick)
            self._text.reshape(merged([lettering(name, x, y, self._size) for name, (x, y) in named(obstacles)]))
        self._text.show(visible)


def named(obstacles: Obstacles) -> list[tuple[str, Floats]]:
    """The name of every obstacle, and its middle (2,) [m]."""
    middles = {
        EntityKind.CIRCLE: list(obstacles.circles[:, :2]),
        EntityKind.BAR: list((obstacles.bars[:, :2] + obstacles.bars[:, 2:4]) / 2),
        EntityKind.POLYGON: [chains[0].mean(axis=0) for chains in obstacles_of(obstacles.polygons)],
    }
    return [
        (name_of(EntityRef(kind, row)), middle) for kind, found in middles.items() for row, middle in enumerate(found)
    ]
