"""Keys of the console, and the red button that stops the team whatever has the focus.

Space is not a hotkey of viser's: those are dead while a field or a list has the focus, and a held key fires again and
again. `browser_js/keys.js` listens ahead of everything, sends STOP as a message of our own until this module has
acknowledged it, and says so when the server cannot be reached.
"""

import re
from collections.abc import Callable
from typing import NamedTuple

import viser

from higvf_console.ui.interaction.tools import TOOLS
from higvf_console.ui.page import page
from higvf_console.ui.page.notice import telling


class KeyBinding(NamedTuple):
    """One line of the key list.

    Attributes:
        key: what is printed on the key.
        name: what `on_key` is called with; for a number that was typed, `pick_1`, `pick_2` and so on.
        text: what the key does, for the operator.
        in_page: whether the page does it itself, without `on_key`.
    """

    key: str
    name: str
    text: str
    in_page: bool = False


KEYMAP: tuple[KeyBinding, ...] = (
    KeyBinding("Space", "stop", "STOP: every robot stands still. Reset it in two steps with the red button"),
    KeyBinding("P", "pause", "Pause or resume: robots hold and still give way, the world goes on"),
    KeyBinding("1 … 9", "pick", "Influence the robot of that number; above 9 type it: 17, then Enter or a pause"),
    KeyBinding("Enter", "confirm", "Commit what is pending: the drawn path or the proposed robot"),
    KeyBinding("Esc", "discard", "Cancel the stroke, discard what is pending, deselect, then put the tool away"),
    KeyBinding("C", "clear_path", "Clear the path"),
    KeyBinding("R", "reverse_path", "Reverse the path"),
    KeyBinding("Ctrl Z", "undo", "Undo what was done last"),
    KeyBinding("Ctrl Y", "redo", "Redo what was undone last"),
    KeyBinding("Del", "delete", "Delete what is chosen for editing"),
    *(KeyBinding(look.key, f"tool_{tool}", f"{look.title}. {look.text}") for tool, look in TOOLS.items()),
    KeyBinding("H", "clear_priority", "Clear the fire priority of the influenced robot"),
    KeyBinding("Z", "freeze", "Freeze or run the simulation clock"),
    KeyBinding("X", "step", "One step while the clock is frozen"),
    KeyBinding("V", "field_arrows", "Show the next vector field"),
    KeyBinding("F", "fit_view", "Fit the arena to the view", in_page=True),
    KeyBinding("?", "help", "Show or hide this list", in_page=True),
)
POINTER_HELP = (
    ("drag", "Draw the desired path"),
    ("click", "Influence a robot; again: why it moves"),
    ("Shift click", "Add a robot to the group that the next path is for, or remove it"),
    ("Shift drag", "Draw round that group"),
    ("wheel", "Zoom to the pointer"),
    ("right drag", "Move the view"),
)
NOTE = (
    "While you type into a text field, or into the search of the command palette (Ctrl+K), Space types a space: "
    "the red button stops the team there too."
)

_PICK = re.compile(r"pick_[1-9][0-9]{0,5}")  # the robot of that number
_LETTERS = {binding.key.lower(): binding.name for binding in KEYMAP if len(binding.key) == 1}
_WORDS = {"enter": "confirm", "escape": "discard", "delete": "delete"}  # by what the browser calls the key
# Everything that `on_key` may be called with, besides the numbers of robots.
NAMES = frozenset(
    {binding.name for binding in KEYMAP if not binding.in_page and binding.name != "pick"} | {"ask_reset", "reset_stop"}
)


def install(server: viser.ViserServer, on_key: Callable[[int, str], None]) -> None:
    """Gives every page the keys of `KEYMAP`, the STOP button and the key list.

    Args:
        server: whose pages get them.
        on_key: called as `on_key(client_id, name)`, name in `NAMES` or `pick_` and a number, on viser's event loop: it
            must return at once.
            STOP counts as acknowledged when it has returned, so it must not raise.
    """
    last_stop: dict[int, int] = {}

    def handle(client_id: int, body: page.Body) -> None:
        name, number = body["name"], body["number"]
        if not is_key(name):
            raise ValueError(f"no key {name!r}; keys: pick_1, {', '.join(sorted(NAMES))}")
        if name != "stop":
            on_key(client_id, name)
            return
        # The page repeats a STOP until it is acknowledged; only the first is passed on.
        if last_stop.get(client_id) != number:
            on_key(client_id, name)
            last_stop[client_id] = number
        page.call(server, "keys", "acknowledged", number, client_id)

    def answer(client_id: int, _body: page.Body) -> None:
        page.call(server, "keys", "alive", None, client_id)

    def forget(client_id: int) -> None:
        last_stop.pop(client_id, None)

    page.listen(server, "key", telling(server, handle))
    page.listen(server, "alive", answer)
    page.on_leave(server, forget)
    config = {
        "keys": [(binding.key, binding.text) for binding in KEYMAP],
        "names": _LETTERS | _WORDS,
        "pointer": POINTER_HELP,
        "note": NOTE,
    }
    page.install(server, "keys", config)
    show_stopped(server, False)


def is_key(name: str) -> bool:
    """Whether `on_key` may be called with this."""
    return name in NAMES or _PICK.fullmatch(name) is not None


def show_robots(server: viser.ViserServer, robots: int) -> None:
    """Tells every page how many robots there are, so that it knows when a number is complete."""
    page.call(server, "keys", "robots", robots)


def note(server: viser.ViserServer, text: str, client_id: int) -> None:
    """Shows a few words beside a page's STOP button for a moment."""
    page.call(server, "keys", "note", text, client_id)


def show_stopped(server: viser.ViserServer, stopped: bool) -> None:
    """Tells every page, and those that connect later, whether STOP is latched; callable from any thread."""
    page.call(server, "keys", "stopped", stopped)
