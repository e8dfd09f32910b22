"""The arena as the operator sees it, from above: layers that a snapshot is poured into.

    floor, overhead image, grid -> heat of gaze -> field arrows -> boundaries -> links, trails -> fires -> obstacles ->
    ghosts -> sight lines, arrows of reasons -> robots -> path -> numbers of fires, names of obstacles, numbers of
    robots -> stroke, what is edited, cursor, dwell button

Everything changes by assignment to a few nodes; nothing here knows threads or commands.
"""

from typing import TYPE_CHECKING

import viser

from higvf_console.core.viewport import Arena
from higvf_console.ui.scene.background import BackgroundLayer
from higvf_console.ui.scene.edit import EditLayer
from higvf_console.ui.scene.field import FieldLayer
from higvf_console.ui.scene.fires import Fires
from higvf_console.ui.scene.gaze import DwellLayer, HeatLayer
from higvf_console.ui.scene.ghosts import Ghosts
from higvf_console.ui.scene.ground import Ground, with_margin
from higvf_console.ui.scene.group import GroupLayer
from higvf_console.ui.scene.labels import ObstacleLabels
from higvf_console.ui.scene.measured import MeasuredLayer
from higvf_console.ui.scene.movers import Movers
from higvf_console.ui.scene.parts import Canvas
from higvf_console.ui.scene.path import PathLayer
from higvf_console.ui.scene.reasons import ReasonLayer, SightLayer
from higvf_console.ui.scene.team import Team
from higvf_console.ui.theme import Look
from higvf_console.ui.ui_state import UiState, robot_explained
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from higvf_console.analysis.preview import Preview
    from higvf_console.runtime.snapshot import Snapshot


class Scene:
    """All layers.

    Attributes:
        setup: what is shown; an edited one needs a new scene.
        look: its colours and size of text; another one needs a new scene, too.
        camera_arena: what the camera must show.
    """

    def __init__(self, server: viser.ViserServer, setup: Setup, look: Look) -> None:
        """Draws what stands still."""
        self.setup, self.look = setup, look
        self._canvas = canvas = Canvas(server, setup.arena, self.look)
        self.camera_arena: Arena = with_margin(setup.arena, max(self.look.text, 1.0) * canvas.px)
        self._ground = Ground(canvas, setup)
        self._movers = Movers(canvas, setup)
        self._names = ObstacleLabels(canvas, setup)
        self._background = BackgroundLayer(canvas)
        self._fires = Fires(canvas, setup)
        self._team = Team(canvas, setup)
        self._path = PathLayer(canvas)
        self._ghosts = Ghosts(canvas, setup)
        self._measured = MeasuredLayer(canvas, setup)
        self._field = FieldLayer(canvas, setup)
        self._reasons = ReasonLayer(canvas, setup)
        self._sights = SightLayer(canvas, setup)
        self._edit = EditLayer(canvas, setup)
        self._group = GroupLayer(canvas, setup.layout)
        self._heat = HeatLayer(canvas)
        self._dwell = DwellLayer(canvas)

    def update(
        self, snapshot: "Snapshot", ui: UiState, preview: "Preview | None" = None, px: float | None = None
    ) -> None:
        """Shows a snapshot as the operator chose, and what is foreseen; call it inside `server.atomic()`.

        Args:
            snapshot: what is shown.
            ui: what is chosen.
            preview: what is foreseen.
            px: a pixel of the page that steers [m], at its zoom; None = as when the arena is fitted.
        """
        state, trace = snapshot.state, snapshot.trace
        self._background.update(ui.background)
        self._fires.update(state, trace, snapshot.loss_area)
        self._team.update(state, trace, snapshot.time)
        self._path.update(state)
        self._ghosts.update(state, preview)
        self._measured.update(snapshot.team, snapshot.last.guard)
        self._field.update(ui.field, state)
        robot = robot_explained(ui, snapshot)
        self._reasons.update(snapshot.last, robot if ui.reasons else None, px)
        self._sights.update(snapshot.last, robot if ui.sights else None)
        self._edit.update(state, ui.selected, ui.drag, handles=ui.editing)
        self._group.update(state, ui.group)
        self._heat.update(snapshot.inputs.attention, ui.heat)
        self._dwell.update(snapshot.inputs.dwell, state.pointer_state.cursor)
        self._ground.show_boundaries(ui.boundaries)
        self._movers.update(state, ui.boundaries)
        self._names.update(state, ui.names)
        self._team.show(links=ui.links, trails=ui.trails, labels=ui.labels, clearance=ui.clearance)

    def clear(self) -> None:
        """Removes everything."""
        self._canvas.clear()
