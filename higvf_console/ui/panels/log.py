"""What happened, in a list, and a button that acknowledges the alarms among it."""

from typing import TYPE_CHECKING

import viser

from higvf_console.core.events import Event, Severity
from higvf_console.ui.alarms import acknowledge_alarms
from higvf_console.ui.page import page
from higvf_console.ui.theme import hex_rgb
from higvf_console.ui.ui_state import UiStore
from higvf_console.ui.widgets.callbacks import reaction
from higvf_console.ui.widgets.event_list import alarms_text, log_html
from higvf_console.ui.widgets.html import block, severity_colour

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

_NOTHING = block('<span class="dim">Nothing has happened yet.</span>')


class LogPanel:
    """The last events, newest first; alarms that stand are marked, and can be acknowledged here or on the strip."""

    def __init__(self, server: viser.ViserServer, ui: UiStore) -> None:
        """Starts empty."""
        self._ui = ui
        self._button = server.gui.add_button(
            "Acknowledge", icon=viser.Icon.CHECK, visible=False, hint="Mark the alarms as read"
        )
        self._button.on_click(reaction(lambda _: ui.change(acknowledge_alarms())))
        self._html = server.gui.add_html(_NOTHING)
        self._newest: Event | None = None
        self._shown: tuple[Event, ...] = ()
        page.listen(server, "read", self._read)

    def _read(self, _client_id: int, body: page.Body) -> None:
        """A page has put an alarm away: it is acknowledged."""
        self._ui.change(acknowledge_alarms(body["text"]))

    def update(self, snapshot: "Snapshot") -> None:
        """Lists the events again when there are new ones, or other alarms stand."""
        newest, alarms = snapshot.events[-1] if snapshot.events else None, self._ui.state.alarms
        if newest is self._newest and alarms == self._shown:
            return
        self._newest, self._shown = newest, alarms
        self._html.content = log_html(snapshot.events, alarms) if snapshot.events else _NOTHING
        self._button.visible = bool(alarms)
        self._button.color = hex_rgb(severity_colour(Severity.ALARM, self._ui.state.look.palette))
        self._button.label = f"Acknowledge {alarms_text(len(alarms))}"
