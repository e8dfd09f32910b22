"""The operator's hand: what a page's pointer, tools and keys do becomes commands, on viser's event loop."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    AskReset,
    ClearPath,
    Confirm,
    Discard,
    EmergencyStop,
    Freeze,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    Redo,
    ResetEmergencyStop,
    Resume,
    ReversePath,
    Step,
    StrokeBegin,
    StrokeCancel,
    StrokePoints,
    StrokeUse,
    Undo,
)
from higvf_console.core.edits import AddEntity, DeleteEntity
from higvf_console.core.state import Motion, PathKind
from higvf_console.core.viewport import Viewport
from higvf_console.operator.path_commands import in_hand
from higvf_console.operator.reducer import waiting
from higvf_console.ui.interaction import pointer
from higvf_console.ui.interaction.grips import Drag, gripped, result_of, robot_near
from higvf_console.ui.interaction.tools import ADDS, USES, Tool
from higvf_console.ui.page.roles import Roles
from higvf_console.ui.panels.steer import SteerPanel
from higvf_console.ui.panels.view import next_field
from higvf_console.ui.scene.scene import View
from higvf_console.world.editing.entities import EntityRef, centres, entity_at, exists, how_many
from higvf_console.world.layout import Layout

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session

PICK_RADIUS_PX = 26.0  # a click this close to a robot picks it, at one device pixel a CSS pixel
GRIP_RADIUS_PX = 10.0  # likewise for what is edited, from its edge


class ArenaInteraction:
    """Turns what a page's pointer and keys do into commands; called on viser's event loop."""

    def __init__(
        self, session: "Session", view: View, steer: SteerPanel, roles: Roles, show_tool: Callable[[Tool, int], None]
    ) -> None:
        """Starts with nobody drawing.

        Args:
            session: whose snapshots are looked at.
            view: where a choice and a drag are shown.
            steer: how a stroke becomes a path.
            roles: takes the commands of the page that steers.
            show_tool: tells a page which tool it has now.
        """
        self._session, self._view, self._steer, self._roles = session, view, steer, roles
        self._show_tool = show_tool
        self._pointer_state: int | None = None
        self._drag_tool, self._use = Tool.PATH, StrokeUse.PATH  # with which that began
        self._tools: dict[int, Tool] = {}
        self._viewports: dict[int, Viewport] = {}

    def tool(self, client_id: int, tool: Tool) -> None:
        """A page takes up a tool; what it has begun to draw or to drag goes on with the one before."""
        self._tools[client_id] = tool
        self._edits(tool)
        self._show_tool(tool, client_id)

    def _edits(self, tool: Tool) -> None:
        """What is chosen for editing stays chosen as long as it is seen to be."""
        self._view.editing = tool is Tool.EDIT
        if tool is not Tool.EDIT:
            self._view.selected = None

    @property
    def use(self) -> StrokeUse:
        """What the stroke is for that is drawn now."""
        return StrokeUse.PATH if self._pointer_state is None else self._use

    def stroke(self, client_id: int, phase: pointer.Phase, points: Floats) -> None:
        """A stroke begins, grows and ends; one of a page that has lost control since is not taken up again."""
        if phase == "start":
            tool = self._tools.get(client_id, Tool.PATH)
            self._pointer_state, self._drag_tool, self._use = client_id, tool, self._use_of(tool)
        elif client_id != self._pointer_state:
            return
        tool = self._drag_tool
        if tool in USES:
            self._draw(phase, points)
        elif tool in ADDS:
            if phase == "end":
                self._add(client_id, tool, points[-1])
        else:
            self._drag(client_id, tool, phase, points)
        if phase in ("cancel", "end"):
            self._pointer_state = None

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
            self._push(self._steer.stroke_end(self._use))

    def _drag(self, client_id: int, tool: Tool, phase: pointer.Phase, points: Floats) -> None:
        """Something is held; where it would go is shown, and is done when the hand lets go."""
        drag = self._view.drag
        if phase == "start" and len(points):
            self._view.drag = self._held(client_id, tool, points[0])
            drag = self._view.drag
        if drag is not None and len(points):
            self._view.drag = drag = drag._replace(now=points[-1])
        if phase == "end" and drag is not None:
            reach, waits = self._reach(client_id, PICK_RADIUS_PX), not self._view.commit_at_once
            for command in result_of(drag, *self._run_state(), reach=reach, waits=waits):
                self._push(command)
        if phase in ("cancel", "end"):
            self._view.drag = None

    def _held(self, client_id: int, tool: Tool, point: Floats) -> Drag | None:
        layout, motion = self._run_state()
        reach = self._reach(client_id, GRIP_RADIUS_PX)
        if tool is Tool.MOVE_POINT:
            return Drag(point, point, moves_path=True)
        if tool is Tool.LINK:
            robot = robot_near(centres(layout, motion), point, self._reach(client_id, PICK_RADIUS_PX))
            return None if robot is None else Drag(point, point, link=robot)
        px = self._reach(client_id, 1.0)
        drag = gripped(point, self._view.selected, layout, motion, reach, px)
        if drag is not None:
            self._view.choose(drag.place, layout)
        return drag

    def click(self, client_id: int, point: Floats) -> None:
        """A short press at a ground point (2,) [m], with the tool in hand."""
        tool = self._tools.get(client_id, Tool.PATH)
        if tool in ADDS:
            self._add(client_id, tool, point)
        elif tool is Tool.EDIT:
            layout, motion = self._run_state()
            self._view.choose(entity_at(point, layout, motion, self._reach(client_id, GRIP_RADIUS_PX)), layout)
        else:
            self._pick(client_id, point)

    def _add(self, client_id: int, tool: Tool, point: Floats) -> None:
        """Adds a thing, and chooses it where it will be the last of its kind."""
        layout, _ = self._run_state()
        self._push(AddEntity(ADDS[tool], floats(point)))
        self.tool(client_id, Tool.EDIT)
        self._view.choose(EntityRef(ADDS[tool], how_many(ADDS[tool], layout)), layout)

    def _pick(self, client_id: int, point: Floats) -> None:
        """Picks a robot; a second click shows or hides why it moves."""
        robot = robot_near(centres(*self._run_state()), point, self._reach(client_id, PICK_RADIUS_PX))
        if robot is None:
            return
        if robot == self._session.snapshot.state.intent.influenced:
            self._view.explained, self._view.reasons = None, not self._view.reasons
        self._push(Pick(robot))

    def viewport(self, client_id: int, viewport: Viewport) -> None:
        """How a page lies over the ground; gaze is mapped through that of the page that steers."""
        self._viewports[client_id] = viewport
        if self._roles.steers(client_id):
            self._session.viewport = viewport

    def hand_over(self, client_id: int | None) -> None:
        """Another page steers from now on, or none: a stroke that is being drawn goes with the hand that drew it."""
        if self._pointer_state is not None:
            self._push(StrokeCancel())
            self._pointer_state, self._view.drag = None, None
        self._edits(Tool.PATH if client_id is None else self._tools.get(client_id, Tool.PATH))
        self._view.selected = None
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
        snapshot = self._session.snapshot
        commands: dict[str, OperatorCommand] = {
            "ask_reset": AskReset(),
            "reset_stop": ResetEmergencyStop(),
            "pause": Resume() if snapshot.state.intent.paused else Pause(),
            "confirm": Confirm(),
            "discard": Discard(),
            "clear_path": ClearPath(),
            "reverse_path": ReversePath(),
            "clear_priority": Prioritise(),
            "freeze": Freeze(not snapshot.frozen),
            "step": Step(),
            "undo": Undo(),
            "redo": Redo(),
        }
        if name == "field_arrows":
            self._view.field = next_field(self._view.field)
        elif name == "delete":
            self._delete()
        elif name in commands:
            self._push(commands[name])
            if name == "discard" and not waiting(snapshot.state.pointer_state, snapshot.time):
                self._put_away(client_id)
        elif name.startswith("tool_"):
            self.tool(client_id, Tool(name.removeprefix("tool_")))
        elif name.startswith("pick_"):
            robot = int(name.removeprefix("pick_")) - 1
            if 0 <= robot < len(snapshot.state.motion.position):
                self._push(Pick(robot))

    def _put_away(self, client_id: int) -> None:
        """Lets go of what is chosen for editing; where nothing is, of the tool."""
        if self._view.selected is not None:
            self._view.selected = None
        else:
            self.tool(client_id, Tool.PATH)

    def _delete(self) -> None:
        place, (layout, _) = self._view.selected, self._run_state()
        if place is not None and exists(place, layout):
            self._view.choose(None, layout)
            self._push(DeleteEntity(place.kind, place.row))

    def _run_state(self) -> tuple[Layout, Motion]:
        snapshot = self._session.snapshot
        return snapshot.setup.layout, snapshot.state.motion

    def _reach(self, client_id: int, pixels: float) -> float:
        viewport = self._viewports.get(client_id)
        return pixels * viewport.metres_per_px if viewport else math.inf

    def _push(self, command: OperatorCommand) -> None:
        self._roles.push(command)
