"""The tools: what a drag or a click in the arena means. A strip above the arena shows them; each page has its own."""

from collections.abc import Callable
from enum import StrEnum
from typing import NamedTuple

import viser

from higvf_console.core.arguments import one_of
from higvf_console.core.commands import StrokeUse
from higvf_console.core.edits import EntityKind
from higvf_console.ui.page import page
from higvf_console.ui.page.notice import telling


class Tool(StrEnum):
    """What the pointer is for."""

    PATH = "path"
    REDRAW = "redraw"
    MOVE_POINT = "move_point"
    PRIORITY = "priority"
    EDIT = "edit"
    OUTLINE = "outline"
    LINK = "link"
    ROBOT = "robot"
    FIRE = "fire"
    CIRCLE = "circle"
    BAR = "bar"


class Look(NamedTuple):
    """How a tool is offered.

    Attributes:
        group: tools of one group stand together.
        key: what is printed on its key.
        title: what it does, in few words.
        text: how to use it.
        icon: SVG in a box of 24 by 24, drawn with strokes.
        inks: whether a drag leaves a line on the page while it lasts.
    """

    group: str
    key: str
    title: str
    text: str
    icon: str
    inks: bool = True


_PLUS = '<path d="M18 2.5v6m-3-3h6"/>'
_ADDED = "Click where to put it"
TOOLS: dict[Tool, Look] = {
    Tool.PATH: Look(
        "steer", "T", "Draw a path", "Drag in the arena: the influenced robot follows it",
        '<path d="M3 18C7 4 13 20 20 6"/><path d="M15.5 6.5 20 6l.6 4.4"/>',
    ),
    Tool.REDRAW: Look(
        "steer", "G", "Redraw a part of the path", "Drag from the path back to it, or away from it for another end",
        '<path d="M3 17c2-5 4-6 6-5"/><path d="M15 12c2 1 4 0 6-5"/>'
        '<path d="M9 12c1-6 5-6 6 0" stroke-dasharray="2.4 2.4"/>',
    ),
    Tool.MOVE_POINT: Look(
        "steer", "B", "Move a point of the path", "Drag any point of it to another place",
        '<path d="M3 19C6 7 18 7 21 19"/><circle cx="12" cy="10" r="2.6" fill="currentColor"/>'
        '<path d="M12 6V2m-2 2 2-2 2 2"/>',
        inks=False,
    ),
    Tool.PRIORITY: Look(
        "steer", "N", "Give fires priority", "Draw round them: the influenced robot values them more",
        '<circle cx="12" cy="12" r="9" stroke-dasharray="3 3"/>'
        '<path d="M12 7.5c3 3 3.6 4.4 3.6 5.9a3.6 3.6 0 0 1-7.2 0c0-1.5 2.6-2.4 3.6-5.9z"/>',
    ),
    Tool.EDIT: Look(
        "edit", "M", "Move and edit", "Click to select, drag to move; the square resizes, the disc turns",
        '<path d="M5 3l14 8-6 1.6L10 19z"/>', inks=False,
    ),
    Tool.OUTLINE: Look(
        "edit", "O", "Draw an obstacle", "Drag round its outline, freehand",
        '<path d="M5 8l6-4 8 4-1 8-8 4-6-5z"/><path d="M8 12l8-4M7 16l10-5" stroke-width="1.2"/>',
    ),
    Tool.LINK: Look(
        "edit", "L", "Link or unlink two robots", "Drag from one to the other",
        '<circle cx="5.5" cy="17" r="2.8"/><circle cx="18.5" cy="7" r="2.8"/><path d="M8 15 16 9"/>', inks=False,
    ),
    Tool.ROBOT: Look(
        "add", "I", "Add a robot", _ADDED, f'<path d="M3 9l14 5.5-14 5.5 3-5.5z"/>{_PLUS}', inks=False,
    ),
    Tool.FIRE: Look(
        "add", "J", "Add a fire", _ADDED,
        f'<path d="M10 7c4 3.6 5 5.6 5 8a5 5 0 0 1-10 0c0-2.4 3.6-3.6 5-8z"/>{_PLUS}', inks=False,
    ),
    Tool.CIRCLE: Look(
        "add", "K", "Add a round obstacle", _ADDED, f'<circle cx="10" cy="14" r="6.5"/>{_PLUS}', inks=False,
    ),
    Tool.BAR: Look(
        "add", "U", "Add a bar", _ADDED, f'<rect x="3" y="13" width="17" height="5" rx="2.5"/>{_PLUS}', inks=False,
    ),
}  # fmt: skip

USES = {
    Tool.PATH: StrokeUse.PATH,
    Tool.REDRAW: StrokeUse.REDRAW,
    Tool.PRIORITY: StrokeUse.PRIORITY,
    Tool.OUTLINE: StrokeUse.OBSTACLE,
}
ADDS = {
    Tool.ROBOT: EntityKind.ROBOT,
    Tool.FIRE: EntityKind.FIRE,
    Tool.CIRCLE: EntityKind.CIRCLE,
    Tool.BAR: EntityKind.BAR,
}


def install(
    server: viser.ViserServer, on_tool: Callable[[int, Tool], None], on_key: Callable[[int, str], None]
) -> None:
    """Gives every page the strip.

    Args:
        server: whose pages get it.
        on_tool: called as `on_tool(client_id, tool)` on viser's event loop: it must return at once.
        on_key: called with "undo" or "redo", likewise.
    """

    def choose(client_id: int, body: page.Body) -> None:
        name = body["name"]
        if name in ("undo", "redo"):
            on_key(client_id, name)
            return
        on_tool(client_id, Tool(one_of("tool", name, tuple(Tool))))

    page.listen(server, "tool", telling(server, choose))
    tools = [{"name": tool.value, **look._asdict()} for tool, look in TOOLS.items()]
    page.install(server, "tools", {"tools": tools})


def show(server: viser.ViserServer, tool: Tool, client_id: int) -> None:
    """Tells a page which tool it has now."""
    page.call(server, "tools", "show", tool.value, client_id)


def show_history(server: viser.ViserServer, undo: str, redo: str) -> None:
    """Tells every page what would be undone and done again; empty = nothing."""
    page.call(server, "tools", "history", {"undo": undo, "redo": redo})
