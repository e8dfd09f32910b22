"""What happened, in a list, and which alarms wait to be read."""

import time as clock
from typing import TYPE_CHECKING

import viser

from higvf_console.core.events import Event, Severity
from higvf_console.ui.messages import cause_lasts, newer
from higvf_console.ui.page import page
from higvf_console.ui.theme import hex_rgb
from higvf_console.ui.ui_state import UiStore, acknowledge_alarms, add_alarms, withdraw_alarms
from higvf_console.ui.widgets.callbacks import reaction
from higvf_console.ui.widgets.event_list import alarms_text, log_html
from higvf_console.ui.widgets.html import block, severity_colour

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

ALARM_S = 5.0  # an alarm stands at least so long, however short its cause
_NOTHING = block('<span class="dim">Nothing has happened yet.</span>')


class LogPanel:
    """The last events, newest first, and a button that acknowledges the alarms among them.

    To acknowledge is a matter of the view: it says that somebody has read the alarm, and commands nothing. An alarm
    whose cause has ended is withdrawn, and stays in the list.
    """

    def __init__(self, server: viser.ViserServer, ui: UiStore) -> None:
        """Starts empty."""
        self._ui = ui
        self._button = server.gui.add_button(
            "Acknowledge", icon=viser.Icon.CHECK, visible=False, hint="Mark the alarms as read"
        )
        self._button.on_click(reaction(lambda _: self._ui.change(acknowledge_alarms())))
        self._html = server.gui.add_html(_NOTHING)
        self._newest: Event | None = None
        self._shown: tuple[Event, ...] = ()
        self._since: dict[int, float] = {}  # when an alarm was first seen [s], by its identity
        page.listen(server, "read", self._read)

    def _read(self, _client_id: int, body: page.Body) -> None:
        """A page has put an alarm away: it is acknowledged."""
        self._ui.change(acknowledge_alarms(body["text"]))

    def update(self, snapshot: "Snapshot") -> None:
        """Lists what is new, and withdraws the alarms whose cause has ended."""
        fresh = newer(snapshot.events, self._newest)
        if fresh:
            self._newest = fresh[-1]
            self._ui.change(add_alarms(fresh))
        self._withdraw(snapshot)
        unread = self._ui.state.alarms
        if fresh or unread != self._shown:
            self._shown = unread
            self._html.content = log_html(snapshot.events, unread)
            self._button.visible = bool(unread)
            self._button.color = hex_rgb(severity_colour(Severity.ALARM, self._ui.state.look.palette))
            self._button.label = f"Acknowledge {alarms_text(len(unread))}"

    def _withdraw(self, snapshot: "Snapshot") -> None:
        now, alarms = clock.monotonic(), self._ui.state.alarms
        self._since = {id(alarm): self._since.get(id(alarm), now) for alarm in alarms}
        ended = [
            alarm for alarm in alarms if now - self._since[id(alarm)] >= ALARM_S and not cause_lasts(alarm, snapshot)
        ]
        if ended:
            self._ui.change(withdraw_alarms(ended))
