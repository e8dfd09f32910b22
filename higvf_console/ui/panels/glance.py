"""Below what is needed to steer: fires and latest messages at a glance, where the page is high enough to show them."""

from typing import TYPE_CHECKING

import viser

from higvf_console.ui.ui_state import UiStore
from higvf_console.ui.widgets.event_list import log_html
from higvf_console.ui.widgets.fire_table import fire_table_html
from higvf_console.ui.widgets.html import block

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

MOST_MESSAGES = 6


class GlancePanel:
    """Two blocks of HTML, empty where there is nothing to tell."""

    def __init__(self, gui: viser.GuiApi, ui: UiStore) -> None:
        """Starts empty."""
        self._ui = ui
        self._fires, self._messages = gui.add_html(""), gui.add_html("")

    def update(self, snapshot: "Snapshot") -> None:
        """Shows a snapshot."""
        burns = len(snapshot.setup.world.fire_position) > 0
        self._fires.content = _titled("Fires", fire_table_html(snapshot)) if burns else ""
        messages = log_html(snapshot.events, self._ui.state.alarms, MOST_MESSAGES)
        self._messages.content = _titled("Latest messages", messages) if snapshot.events else ""


def _titled(title: str, content: str) -> str:
    return block(f'<div class="title">{title}</div>') + content
