"""History panel: undo, redo, and the list of actions, the latest first."""

from typing import TYPE_CHECKING

import viser

from higvf_console.core.commands import Redo, Undo
from higvf_console.core.interface import PointerSink
from higvf_console.runtime.history import Entry, History
from higvf_console.ui.widgets.callbacks import chosen, reaction
from higvf_console.ui.widgets.html import block, clock, text

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

SHOWN = 12  # actions
_UNDO, _REDO = "Undo", "Redo"


class HistoryPanel:
    """Two buttons and a list."""

    def __init__(self, gui: viser.GuiApi, sink: PointerSink) -> None:
        """Adds the list and its buttons, which push Undo and Redo to `sink`."""
        self._shown: History | None = None
        with gui.add_folder("History"):
            self._buttons = gui.add_button_group("History", (_UNDO, _REDO), hint="Ctrl+Z, Ctrl+Y")
            self._buttons.on_click(reaction(lambda value: sink.push(chosen(value, {_UNDO: Undo(), _REDO: Redo()}))))
            self._list = gui.add_html("")

    def update(self, snapshot: "Snapshot") -> None:
        """Shows the history when it has changed."""
        if snapshot.history is not self._shown:
            self._shown = snapshot.history
            self._list.content = block(history_html(snapshot.history.entries()))


def history_html(entries: tuple[Entry, ...]) -> str:
    """The actions, the latest first; undone ones are struck through."""
    if not entries:
        return '<span class="dim">No actions yet. Every edit and every action can be undone here.</span>'
    done = sum(not entry.undone for entry in entries)
    first = max(0, min(done - SHOWN // 2, len(entries) - SHOWN))
    lines = [
        f'<div class="{"undone" if entry.undone else "done"}"><span class="dim">{clock(entry.time)}</span>'
        f"<span>{text(entry.text)}</span></div>"
        for entry in entries[first : first + SHOWN]
    ]
    return f'<div class="actions">{"".join(reversed(lines))}</div>'
