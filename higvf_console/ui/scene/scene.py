"""The arena as the operator sees it, from above: layers that a snapshot is poured into.

    floor, overhead image, grid -> heat of gaze -> field arrows -> boundaries -> fires -> obstacles -> links, trails ->
    path -> ghosts -> sight lines, arrows of reasons -> robots -> stroke, what is edited, cursor, dwell button

Everything changes by assignment to a few nodes; nothing here knows threads or commands.
"""

from dataclasses import dataclass
from dataclasses import field as attribute
from typing import TYPE_CHECKING

import viser

from higvf_console.analysis.preview import USUAL
from higvf_console.control.guidance.field import FieldKind
from higvf_console.core.events import Event
from higvf_console.core.viewport import Arena
from higvf_console.ui.interaction.grips import Drag
from higvf_console.ui.scene.background import Background, BackgroundLayer
from higvf_console.ui.scene.edit import EditLayer
from higvf_console.ui.scene.field import FieldLayer
from higvf_console.ui.scene.fires import Fires
from higvf_console.ui.scene.gaze import DwellLayer, HeatLayer
from higvf_console.ui.scene.ghosts import Ghosts
from higvf_console.ui.scene.ground import Ground, with_margin
from higvf_console.ui.scene.parts import Canvas
from higvf_console.ui.scene.path import PathLayer
from higvf_console.ui.scene.reasons import ReasonLayer, SightLayer
from higvf_console.ui.scene.team import Team
from higvf_console.ui.theme import USUAL_LOOK, Look
from higvf_console.world.editing.entities import EntityRef, exists, how_many
from higvf_console.world.layout import Layout
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from higvf_console.analysis.preview import Preview
    from higvf_console.runtime.snapshot import Snapshot


@dataclass
class View:
    """What the operator chose to see; the panels write it, the view thread reads it.

    Attributes:
        field: vector field whose arrows are drawn; None = no arrows.
        trails: where the robots were.
        links: who talks with whom.
        boundaries: reactive and repulsive boundaries of obstacles.
        labels: numbers of the robots.
        clearance: circles of half the robot clearance: two that touch are as close as they may be; round it, pale, as
            the filter enlarges it for unicycles and noise.
        commit_at_once: a drawn path is followed when its stroke ends; else it waits.
        horizon: how far the preview looks ahead [s].
        explained: the robot whose velocity is explained; None = the one that is steered.
        reasons: its velocity as a chain of arrows.
        sights: which fires it sees, and what hides the others.
        editing: whether the hand edits things.
        selected: the thing that is chosen for editing.
        among: how many of its kind there are then.
        drag: what the hand holds.
        background: overhead image on the ground.
        look: colours and size of text, on every page.
        alarms: those that nobody has acknowledged, oldest first.
        heat: where the operator has looked.
    """

    field: FieldKind | None = None
    trails: bool = True
    links: bool = True
    boundaries: bool = True
    labels: bool = True
    clearance: bool = False
    commit_at_once: bool = True
    horizon: float = USUAL
    explained: int | None = None
    reasons: bool = False
    sights: bool = False
    editing: bool = False
    selected: EntityRef | None = None
    among: int = 0
    drag: Drag | None = None
    background: Background | None = None
    look: Look = USUAL_LOOK
    alarms: list[Event] = attribute(default_factory=list[Event])
    heat: bool = False

    def choose(self, place: EntityRef | None, layout: Layout) -> None:
        """Chooses a thing for editing, perhaps one that is about to be the last of its kind; None = nothing."""
        self.selected = place
        self.among = 0 if place is None else max(how_many(place.kind, layout), place.row + 1)

    def keep_choice(self, layout: Layout) -> None:
        """Lets go of what is chosen where things of its kind have come or gone: its number may be another's now."""
        place = self.selected
        if place is not None and exists(place, layout) and how_many(place.kind, layout) != self.among:
            self.selected = None

    def robot(self, snapshot: "Snapshot") -> int:
        """Index of the robot whose velocity is explained."""
        robots = len(snapshot.state.motion.position)
        return (
            self.explained
            if self.explained is not None and self.explained < robots
            else snapshot.state.intent.influenced
        )


class Scene:
    """All layers.

    Attributes:
        setup: what is shown; an edited one needs a new scene.
        look: its colours and size of text; another one needs a new scene, too.
        camera_arena: what the camera must show.
    """

    def __init__(self, server: viser.ViserServer, setup: Setup, view: View) -> None:
        """Draws what stands still."""
        self.setup, self.look = setup, view.look
        self._canvas = canvas = Canvas(server, setup.arena, self.look)
        self.camera_arena: Arena = with_margin(setup.arena, max(self.look.text, 1.0) * canvas.px)
        self._view = view
        self._ground = Ground(canvas, setup)
        self._background = BackgroundLayer(canvas)
        self._fires = Fires(canvas, setup)
        self._team = Team(canvas, setup)
        self._path = PathLayer(canvas)
        self._ghosts = Ghosts(canvas, setup)
        self._field = FieldLayer(canvas, setup)
        self._reasons = ReasonLayer(canvas, setup)
        self._sights = SightLayer(canvas, setup)
        self._edit = EditLayer(canvas, setup)
        self._heat = HeatLayer(canvas)
        self._dwell = DwellLayer(canvas)

    def update(self, snapshot: "Snapshot", preview: "Preview | None" = None) -> None:
        """Shows a snapshot, and what is foreseen; call it inside `server.atomic()`."""
        state, trace, view = snapshot.state, snapshot.trace, self._view
        self._background.update(view.background)
        self._fires.update(state, trace, snapshot.loss_area)
        self._team.update(state, trace, snapshot.time)
        self._path.update(state)
        self._ghosts.update(state, preview)
        self._field.update(view.field, state)
        robot = view.robot(snapshot)
        self._reasons.update(snapshot.last, robot if view.reasons else None)
        self._sights.update(snapshot.last, robot if view.sights else None)
        self._edit.update(state, view.selected if view.editing else None, view.drag)
        self._heat.update(snapshot.inputs.attention, view.heat)
        self._dwell.update(snapshot.inputs.dwell, state.pointer_state.cursor)
        self._ground.show_boundaries(view.boundaries)
        self._team.show(links=view.links, trails=view.trails, labels=view.labels, clearance=view.clearance)

    def clear(self) -> None:
        """Removes everything."""
        self._canvas.clear()
