"""What the operator chose in the browser, in one place: frozen, replaced as a whole, seen by all.

    panels, pointer, keys  --  named changes  ->  UiStore  ->  scene, panels, interaction, look ahead read `state`

viser's event loop and the view thread both write; a change is therefore a function of the state before it, made under
one lock. Nothing here reaches the team: that goes by commands alone.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

from higvf_console.analysis.preview import USUAL
from higvf_console.control.guidance.field import FieldKind
from higvf_console.core.arrays import Floats
from higvf_console.core.commands import StrokeEnd, StrokeUse
from higvf_console.core.events import Event
from higvf_console.core.path_terms import USUAL_TERMS, PathTerms, stroke_end
from higvf_console.core.state import Path, PathKind
from higvf_console.operator.path_commands import terms_of
from higvf_console.ui.interaction.grips import Drag
from higvf_console.ui.scene.background import Background
from higvf_console.ui.theme import USUAL_LOOK, Look
from higvf_console.world.editing.entities import EntityRef, exists, how_many
from higvf_console.world.layout import Layout
from higvf_console.world.masks import MaskPlace

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

MOST_LINKED = 30  # robots of a team whose links are shown unasked


@dataclass(frozen=True, eq=False)
class UiState:
    """What is chosen to be seen, drawn and edited.

    Attributes:
        field: vector field whose arrows are drawn; None = no arrows.
        trails: where the robots were.
        links: who talks with whom; a large team starts without them.
        boundaries: reactive and repulsive boundaries of obstacles.
        labels: numbers of the robots.
        names: of the obstacles.
        clearance: circles of half the robot clearance: two that touch are as close as they may be; round it, pale, as
            the filter enlarges it for unicycles and noise.
        heat: where the operator has looked.
        explained: the robot whose velocity is explained; None = the one that is steered.
        reasons: its velocity as a chain of arrows.
        sights: which fires it sees, and what hides the others.
        look: colours and size of text, on every page.
        camera: live picture of a camera that sees the arena, where there is one.
        background: overhead image on the ground.
        alarms: those that nobody has acknowledged, oldest first (`ui.alarms` has the rules).
        terms: on which the path is followed that the next stroke becomes.
        commit_at_once: a drawn path is followed when its stroke ends; else it waits.
        horizon: how far the preview looks ahead [s].
        drawn_for: what the stroke is for that is drawn now; PATH while none is.
        drawn_robot: index of the robot that its path is for; None = the one that is influenced.
        group: indices of the robots that the next path is for: the one of them that is nearest to its start.
        editing: whether the pointer edits the layout.
        selected: what is chosen for editing.
        among: how many of its kind there are then.
        drag: what the pointer holds.
    """

    field: FieldKind | None = None
    trails: bool = True
    links: bool = True
    boundaries: bool = True
    labels: bool = True
    names: bool = False
    clearance: bool = False
    heat: bool = False
    explained: int | None = None
    reasons: bool = False
    sights: bool = False
    look: Look = USUAL_LOOK
    camera: bool = True
    background: Background | None = None
    alarms: tuple[Event, ...] = ()
    terms: PathTerms = USUAL_TERMS
    commit_at_once: bool = True
    horizon: float = USUAL
    drawn_for: StrokeUse = StrokeUse.PATH
    drawn_robot: int | None = None
    group: frozenset[int] = frozenset()
    editing: bool = False
    selected: EntityRef | None = None
    among: int = 0
    drag: Drag | None = None


Change: TypeAlias = Callable[[UiState], UiState]
Listener: TypeAlias = Callable[[UiState, UiState], object]


class UiStore:
    """Holds the `UiState`; callable from any thread."""

    def __init__(self, state: UiState | None = None) -> None:
        """Starts with a state; None = as on a new console."""
        self._state = UiState() if state is None else state
        self._lock = threading.RLock()
        self._listeners: tuple[Listener, ...] = ()

    @property
    def state(self) -> UiState:
        """The state now; it never changes, so read it once for what belongs together."""
        return self._state

    def update(self, **changes: Any) -> UiState:
        """Replaces some attributes together; the state after it.

        Raises:
            TypeError: there is no attribute of that name.
        """
        return self.change(lambda state: replace(state, **changes))

    def change(self, change: Change) -> UiState:
        """Replaces the state by a function of it, of which no other change is lost; the state after it.

        The listeners are called before it returns, unless the function returns the same state.
        """
        with self._lock:
            before, self._state = self._state, change(self._state)
            now = self._state
            if now is not before:
                for listener in self._listeners:
                    listener(before, now)
            return now

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        """Calls `listener(before, now)` after every change, in their order, on the thread that made it.

        Args:
            listener: must return at once; it may change the state again.

        Returns:
            Ends the subscription; may be called twice.
        """
        with self._lock:
            self._listeners = (*self._listeners, listener)

        def end() -> None:
            with self._lock:
                self._listeners = tuple(other for other in self._listeners if other is not listener)

        return end


def robot_explained(state: UiState, snapshot: "Snapshot") -> int:
    """Index of the robot whose velocity is explained."""
    robots = len(snapshot.state.motion.position)
    chosen = state.explained
    return chosen if chosen is not None and chosen < robots else snapshot.state.intent.influenced


def show_next_field(state: UiState) -> UiState:
    """The arrows are those of the next vector field; after the last, none."""
    kinds = (None, *FieldKind)
    return replace(state, field=kinds[(kinds.index(state.field) + 1) % len(kinds)])


def end_of_stroke(state: UiState, use: StrokeUse = StrokeUse.PATH, robot: int | None = None) -> StrokeEnd:
    """The end of a stroke that is drawn now, for a robot (index from 0) or the one that is influenced."""
    waits = use in (StrokeUse.PATH, StrokeUse.REDRAW) and not state.commit_at_once
    return stroke_end(state.terms, use, robot, preview=waits)


def choose(place: EntityRef | None, layout: Layout) -> Change:
    """Something is chosen for editing, perhaps what is about to be the last of its kind; None = nothing."""
    among = 0 if place is None else max(how_many(place.kind, layout), place.row + 1)
    return lambda state: replace(state, selected=place, among=among)


def keep_choice(layout: Layout) -> Change:
    """The choice is dropped where entities of its kind have come or gone: its number may be another's now."""

    def change(state: UiState) -> UiState:
        place = state.selected
        stays = place is None or not exists(place, layout) or how_many(place.kind, layout) == state.among
        return state if stays else replace(state, selected=None)

    return change


def take_up_editing(editing: bool, *, adds: bool = False) -> Change:
    """The pointer begins or ends to edit, or adds things; what is chosen stays chosen as long as it is seen to be."""
    return lambda state: replace(state, editing=editing, selected=state.selected if editing or adds else None)


def toggle_in_group(robot: int) -> Change:
    """A robot (index from 0) joins the group, or leaves it."""
    return lambda state: replace(state, group=state.group ^ {robot})


def name_of_field(kind: FieldKind | None) -> str:
    """How people call a vector field."""
    return "off" if kind is None else kind.name.lower()


def move_drag(point: Floats) -> Change:
    """What the pointer holds, if anything, is now at a point (2,) [m]."""
    return lambda state: state if state.drag is None else replace(state, drag=state.drag._replace(now=point))


def explain_the_steered(state: UiState) -> UiState:
    """The robot that is steered is explained in the arena, or is not any more."""
    return replace(state, explained=None, reasons=not state.reasons)


def change_terms(**terms: Any) -> Change:
    """The next path is followed on other terms."""
    return lambda state: replace(state, terms=state.terms._replace(**terms))


def follow_path(path: Path) -> Change:
    """The terms of the path in hand are those of the next one too."""
    if path.kind == PathKind.NONE:
        return lambda state: state
    return lambda state: replace(state, terms=terms_of(path, state.terms.smoothing))


def begin_scenario(smoothing: float, robots: int) -> Change:
    """Another scenario is in force: what was chosen, and the picture on the ground, were of the last one.

    Args:
        smoothing: of the scenario's strokes [m].
        robots: in its team; the links of more than `MOST_LINKED` would cover the arena, and are most of the traffic.
    """
    return lambda state: replace(
        state,
        selected=None,
        background=None,
        links=robots <= MOST_LINKED,
        terms=state.terms._replace(smoothing=smoothing),
    )


def change_look(**changes: Any) -> Change:
    """Other colours, or another size of text."""
    return lambda state: replace(state, look=state.look._replace(**changes))


def move_background(place: MaskPlace) -> Change:
    """The picture on the ground, if there is one, lies elsewhere."""
    return lambda state: (
        state if state.background is None else replace(state, background=state.background._replace(place=place))
    )
