"""What happened, twice: as a notification when it happens, and in a list that stays."""

import time as clock
from collections.abc import Sequence
from typing import TYPE_CHECKING

import viser

from higvf_console.sim.setup import Event, Severity
from higvf_console.ui.panels.html import SEVERITY_COLOUR, block, text
from higvf_console.ui.panels.html import clock as session_clock
from higvf_console.ui.theme import hex_rgb

if TYPE_CHECKING:
    from higvf_console.session.session import Snapshot

MOST_SHOWN = 30
MOST_AT_ONCE = 2  # notifications of one update
TITLES = {
    "extinguished": "Fire out",
    "target": "New target",
    "path": "Path",
    "infeasible": "No safe velocity",
    "deadlock": "Robot held",
    "refused": "Not possible",
    "clipped": "Stroke clipped",
    "stop": "STOP",
}
STAY_S = {Severity.INFO: 4.0, Severity.GOOD: 6.0, Severity.WARNING: 8.0, Severity.ALARM: 15.0}


class LogPanel:
    """The last events, newest first."""

    def __init__(self, server: viser.ViserServer) -> None:
        """Starts empty."""
        self._server = server
        self._html = server.gui.add_html(block('<span class="dim">Nothing has happened yet.</span>'))
        self._newest: Event | None = None
        self._notifications = Notifications()

    def update(self, snapshot: "Snapshot") -> None:
        """Lists and notifies what is new."""
        fresh = newer(snapshot.events, self._newest)
        if not fresh:
            return
        self._newest = fresh[-1]
        self._html.content = log_html(snapshot.events)
        for event in self._notifications.chosen(fresh, clock.monotonic()):
            for client in self._server.get_clients().values():
                client.add_notification(
                    TITLES.get(event.kind, event.kind.capitalize()),
                    event.text,
                    auto_close_seconds=STAY_S[event.severity],
                    color=hex_rgb(SEVERITY_COLOUR[event.severity]),
                )

    def cleanup(self) -> None:
        """Removes the list."""
        self._html.remove()


class Notifications:
    """Keeps the arena in sight: one of a kind at a time, but every fire that goes out and every loss of control.

    What the operator has just done is seen anyway and only logged.
    """

    def __init__(self) -> None:
        """Nothing has been notified."""
        self._shown_until: dict[str, float] = {}

    def chosen(self, fresh: Sequence[Event], now: float) -> list[Event]:
        """The events to be notified at `now` [s], of those that are new."""
        chosen: list[Event] = []
        for event in fresh:
            if event.severity == Severity.INFO and event.kind != "target":
                continue
            if event.kind in ("extinguished", "control") or now >= self._shown_until.get(event.kind, now):
                self._shown_until[event.kind] = now + STAY_S[event.severity]
                chosen.append(event)
        return chosen[-MOST_AT_ONCE:]


def newer(events: Sequence[Event], newest: Event | None) -> list[Event]:
    """The events after one that was seen, oldest first; all of them when it is no longer kept."""
    fresh: list[Event] = []
    for event in reversed(events):
        if event is newest:
            break
        fresh.append(event)
    return fresh[::-1]


def log_html(events: Sequence[Event]) -> str:
    """The last events, newest first."""
    lines = "".join(
        f'<div style="border-color:{SEVERITY_COLOUR[event.severity]}">'
        f'<span class="dim">{session_clock(event.time)}</span><span>{text(event.text)}</span></div>'
        for event in reversed(events[-MOST_SHOWN:])
    )
    return block(f'<div class="log">{lines}</div>')
