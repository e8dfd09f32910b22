"""The operator's hand: what a page's pointer, tools and keys do becomes commands, on viser's event loop."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    EmergencyStop,
    OperatorCommand,
    Pick,
    StrokeBegin,
    StrokeCancel,
    StrokePoints,
    StrokeUse,
)
from higvf_console.core.edits import AddEntity, DeleteEntity
from higvf_console.core.outline import enclosed
from higvf_console.core.state import Motion, PathKind
from higvf_console.core.viewport import Viewport
from higvf_console.operator.path_commands import in_hand
from higvf_console.operator.reducer import waiting
from higvf_console.ui.interaction import pointer
from higvf_console.ui.interaction.grips import Drag, gripped, nearest_of, result_of, robot_near
from higvf_console.ui.interaction.key_commands import command_of
from higvf_console.ui.interaction.tools import ADDS, USES, Tool
from higvf_console.ui.page.roles import Roles
from higvf_console.ui.ui_state import (
    UiStore,
    choose,
    end_of_stroke,
    explain_the_steered,
    move_drag,
    name_of_field,
    show_next_field,
    take_up_editing,
    toggle_in_group,
)
from higvf_console.world.editing.entities import EntityRef, centres, entity_at, exists, how_many
from higvf_console.world.layout import Layout

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session

PICK_RADIUS_PX = 26.0  # a click this close to a robot picks it, at one device pixel a CSS pixel
GRIP_RADIUS_PX = 10.0  # likewise for what is edited, from its edge


class PageActions(NamedTuple):
    """What is done in one page, given by its client; each must return at once.

    Attributes:
        show_tool: tells it which tool it has now.
        open_tab: opens a tab of the panel, by its name.
        note: shows a few words for a moment.
    """

    show_tool: Callable[[Tool, int], None]
    open_tab: Callable[[str, int], None]
    note: Callable[[str, int], None]


class ArenaInteraction:
    """Turns what a page's pointer and keys do into commands; called on viser's event loop."""

    def __init__(self, session: "Session", ui: UiStore, roles: Roles, actions: PageActions) -> None:
        """Starts with nobody drawing.

        Args:
            session: whose snapshots are looked at.
            ui: what is chosen; here what a page edits and drags is written.
            roles: takes the commands of the page that steers.
            actions: what is done in a page.
        """
        self._session, self._ui, self._roles, self._actions = session, ui, roles, actions
        self._drawing_client: int | None = None
        self._drag_tool = Tool.PATH  # with which that began
        self._last = floats([0.0, 0.0])  # point of a press that moves, with a tool that adds
        self._outline = floats([], 0, 2)  # of a group that is being drawn round
        self._tools: dict[int, Tool] = {}
        self._viewports: dict[int, Viewport] = {}

    def tool(self, client_id: int, tool: Tool) -> None:
        """A page takes up a tool; what it has begun to draw or to drag goes on with the one before."""
        self._tools[client_id] = tool
        self._ui.change(take_up_editing(tool is Tool.EDIT, adds=tool in ADDS))
        self._actions.show_tool(tool, client_id)

    def stroke(self, client_id: int, phase: pointer.Phase, points: Floats, *, group: bool = False) -> None:
        """A stroke begins, grows and ends; one of a page that has lost control since is not taken up again."""
        if phase == "start":
            tool = self._tools.get(client_id, Tool.PATH)
            self._drawing_client, self._drag_tool = client_id, tool
            use = self._use_of(tool)
            steered = use is StrokeUse.PATH and not group and len(points)
            robot = nearest_of(self._ui.state.group, centres(*self._run_state()), points[0]) if steered else None
            self._ui.update(drawn_for=use, drawn_robot=robot)
        elif client_id != self._drawing_client:
            return
        tool = self._drag_tool
        if group:
            self._lasso(phase, points)
        elif tool in USES:
            self._draw(phase, points)
        elif tool in ADDS:
            self._last = points[-1] if len(points) else self._last
            if phase == "end":
                self._add(tool, self._last)
        else:
            self._drag(client_id, tool, phase, points)
        if phase in ("cancel", "end"):
            self._drawing_client = None
            self._ui.update(drawn_for=StrokeUse.PATH, drawn_robot=None)

    def _lasso(self, phase: pointer.Phase, points: Floats) -> None:
        """A stroke round robots makes them the group."""
        self._outline = points if phase == "start" else np.concatenate([self._outline, points])
        if phase == "end":
            found = np.flatnonzero(enclosed(self._outline, centres(*self._run_state())))
            self._ui.update(group=frozenset(found.tolist()))

    def _use_of(self, tool: Tool) -> StrokeUse:
        """What a stroke of a tool is for; where there is no path to redraw a part of, it is a path."""
        use = USES.get(tool, StrokeUse.PATH)
        if use is StrokeUse.REDRAW and in_hand(self._session.snapshot.state).kind == PathKind.NONE:
            return StrokeUse.PATH
        return use

    def _draw(self, phase: pointer.Phase, points: Floats) -> None:
        if phase == "start":
            self._push(StrokeBegin())
        if phase == "cancel":
            self._push(StrokeCancel())
        elif len(points):
            self._push(StrokePoints(points=points))
        if phase == "end":
            state = self._ui.state
            self._push(end_of_stroke(state, state.drawn_for, state.drawn_robot))
            if state.drawn_for is StrokeUse.PATH:
                self._ui.update(group=frozenset())  # it was for this path

    def _drag(self, client_id: int, tool: Tool, phase: pointer.Phase, points: Floats) -> None:
        """Drags what is held: its ghost is shown, and the change is made on release."""
        if phase == "start" and len(points):
            self._ui.update(drag=self._held(client_id, tool, points[0]))
        state = self._ui.change(move_drag(points[-1])) if len(points) else self._ui.state
        drag = state.drag
        if phase == "end" and drag is not None:
            reach, waits = self._reach(client_id, PICK_RADIUS_PX), not state.commit_at_once
            for command in result_of(drag, *self._run_state(), reach=reach, waits=waits):
                self._push(command)
        if phase in ("cancel", "end"):
            self._ui.update(drag=None)

    def _held(self, client_id: int, tool: Tool, point: Floats) -> Drag | None:
        layout, motion = self._run_state()
        reach = self._reach(client_id, GRIP_RADIUS_PX)
        if tool is Tool.MOVE_POINT:
            return Drag(point, point, moves_path=True)
        if tool is Tool.LINK:
            robot = self._robot_at(client_id, point)
            return None if robot is None else Drag(point, point, link=robot)
        px = self._reach(client_id, 1.0)
        drag = gripped(point, self._ui.state.selected, layout, motion, reach, px)
        if drag is not None:
            self._ui.change(choose(drag.place, layout))
        return drag

    def click(self, client_id: int, point: Floats, *, group: bool = False) -> None:
        """A short press at a ground point (2,) [m], with the tool in hand."""
        tool = self._tools.get(client_id, Tool.PATH)
        if group:
            self._join(client_id, point)
        elif tool in ADDS:
            self._add(tool, point)
        elif tool is Tool.EDIT:
            layout, motion = self._run_state()
            place = entity_at(point, layout, motion, self._reach(client_id, GRIP_RADIUS_PX))
            self._ui.change(choose(place, layout))
        else:
            self._pick(client_id, point)

    def _add(self, tool: Tool, point: Floats) -> None:
        """Adds an entity, and selects it: it will be the last of its kind; the tool stays."""
        layout, _ = self._run_state()
        self._push(AddEntity(ADDS[tool], floats(np.round(point, layout.params.scale.decimals))))
        self._ui.change(choose(EntityRef(ADDS[tool], how_many(ADDS[tool], layout)), layout))

    def _robot_at(self, client_id: int, point: Floats) -> int | None:
        return robot_near(centres(*self._run_state()), point, self._reach(client_id, PICK_RADIUS_PX))

    def _join(self, client_id: int, point: Floats) -> None:
        """A robot joins the group that the next path is for, or leaves it."""
        robot = self._robot_at(client_id, point)
        if robot is not None:
            self._ui.change(toggle_in_group(robot))

    def _pick(self, client_id: int, point: Floats) -> None:
        """Picks a robot; a second click shows in arena and panel why it moves, a third hides the arrows."""
        robot = self._robot_at(client_id, point)
        if robot is None:
            return
        again = robot == self._session.snapshot.state.intent.influenced
        if again and self._ui.change(explain_the_steered).reasons:
            self._actions.open_tab("Why", client_id)
        self._ui.update(group=frozenset())
        self._push(Pick(robot))

    def viewport(self, client_id: int, viewport: Viewport) -> None:
        """How a page lies over the ground; gaze is mapped through that of the page that steers."""
        self._viewports[client_id] = viewport
        if self._roles.steers(client_id):
            self._session.viewport = viewport

    def hand_over(self, client_id: int | None) -> None:
        """Another page steers from now on, or none: a stroke that is being drawn goes with the hand that drew it."""
        if self._drawing_client is not None:
            self._push(StrokeCancel())
            self._drawing_client = None
            self._ui.update(drag=None, drawn_for=StrokeUse.PATH, drawn_robot=None)
        tool = Tool.PATH if client_id is None else self._tools.get(client_id, Tool.PATH)
        self._ui.update(editing=tool is Tool.EDIT, selected=None, group=frozenset())
        if client_id in self._viewports:
            self._session.viewport = self._viewports[client_id]

    def leave(self, client_id: int) -> None:
        """A page has gone."""
        self._viewports.pop(client_id, None)
        self._tools.pop(client_id, None)

    def key(self, client_id: int, name: str) -> None:
        """A key of `keys.KEYMAP`, or the same action out of the command palette."""
        if name == "stop":  # first, and on its own: nothing may come between
            self._roles.push_of(client_id, EmergencyStop())
            return
        if name == "field_arrows":
            field = self._ui.change(show_next_field).field
            self._actions.note(f"Field: {name_of_field(field)}", client_id)
        elif name == "delete":
            self._delete()
        elif name.startswith("tool_"):
            self.tool(client_id, Tool(name.removeprefix("tool_")))
        else:
            self._command(client_id, name)

    def _command(self, client_id: int, name: str) -> None:
        snapshot = self._session.snapshot
        command = command_of(name, snapshot)
        if command is not None:
            self._push(command)
        if name == "discard" and not waiting(snapshot.state.pointer_state, snapshot.time):
            self._put_away(client_id)

    def _put_away(self, client_id: int) -> None:
        """Lets go of the group, else of what is chosen for editing, else of the tool."""
        if self._ui.state.group:
            self._ui.update(group=frozenset())
        elif self._ui.state.selected is not None:
            self._ui.update(selected=None)
        else:
            self.tool(client_id, Tool.PATH)

    def _delete(self) -> None:
        place, (layout, _) = self._ui.state.selected, self._run_state()
        if place is not None and exists(place, layout):
            self._ui.change(choose(None, layout))
            self._push(DeleteEntity(place.kind, place.row))

    def _run_state(self) -> tuple[Layout, Motion]:
        snapshot = self._session.snapshot
        return snapshot.setup.layout, snapshot.state.motion

    def _reach(self, client_id: int, pixels: float) -> float:
        viewport = self._viewports.get(client_id)
        return pixels * viewport.metres_per_px if viewport else math.inf

    def _push(self, command: OperatorCommand) -> None:
        self._roles.push(command)
