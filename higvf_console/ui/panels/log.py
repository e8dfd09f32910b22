"""What happened, twice: as a notification, which of an alarm stays until acknowledged, and in a list."""

import time as clock
from collections.abc import Sequence, Set
from typing import TYPE_CHECKING

import viser

from higvf_console.core.events import Event, Severity
from higvf_console.ui.page import page
from higvf_console.ui.panels.widgets.callbacks import reaction
from higvf_console.ui.panels.widgets.html import block, severity_colour, text
from higvf_console.ui.panels.widgets.html import clock as session_clock
from higvf_console.ui.theme import hex_rgb
from higvf_console.ui.ui_state import UiStore, acknowledge_alarms, add_alarms

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot

MOST_SHOWN = 30
MOST_AT_ONCE = 2  # notifications of one update, besides its alarms
REFUSED = "refused"
TITLES = {
    "extinguished": "Fire out",
    "target": "New target",
    "path": "Path",
    "infeasible": "No safe velocity",
    "clearance": "Too near",
    "deadlock": "Robot held",
    REFUSED: "Not possible",
    "clipped": "Stroke clipped",
    "stop": "STOP",
    "channel": "Input",
    "failure": "Engine failure",
}
STAY_S = {Severity.INFO: 4.0, Severity.GOOD: 6.0, Severity.WARNING: 8.0}  # an alarm stays until it is acknowledged
_NOTHING = block('<span class="dim">Nothing has happened yet.</span>')


class LogPanel:
    """The last events, newest first, and a button that acknowledges the alarms among them.

    To acknowledge is a matter of the view: it says that somebody has read the alarm, and commands nothing.
    """

    def __init__(self, server: viser.ViserServer, ui: UiStore) -> None:
        """Starts empty."""
        self._server, self._ui = server, ui
        self._button = server.gui.add_button(
            "Acknowledge", icon=viser.Icon.CHECK, visible=False, hint="Mark the alarms as read"
        )
        self._button.on_click(reaction(lambda _: self._ui.change(acknowledge_alarms())))
        self._html = server.gui.add_html(_NOTHING)
        self._newest: Event | None = None
        self._shown: tuple[Event, ...] = ()
        self._notifications = Notifications()
        self._standing: list[tuple[Event, viser.NotificationHandle]] = []
        self._refusal: list[viser.NotificationHandle] = []  # the latest, in each page
        page.listen(server, "read", self._read)
        page.install(server, "notes", {})

    def _read(self, _client_id: int, body: page.Body) -> None:
        """A page has closed a notification: its alarm is acknowledged."""
        self._ui.change(acknowledge_alarms(str(body.get("text"))))

    def update(self, snapshot: "Snapshot") -> None:
        """Lists and notifies what is new, and takes back what has been acknowledged."""
        fresh = newer(snapshot.events, self._newest)
        if fresh:
            self._newest = fresh[-1]
            self._ui.change(add_alarms(fresh))
        unread = self._ui.state.alarms
        self._take_back(unread)  # first: one that has just been acknowledged must not keep back the next of its kind
        for event in self._notifications.chosen(fresh, clock.monotonic(), self._told()):
            self._notify(event)
        if fresh or unread != self._shown:
            self._shown = unread
            self._html.content = log_html(snapshot.events, unread)
            self._button.visible = bool(unread)
            self._button.color = hex_rgb(severity_colour(Severity.ALARM, self._ui.state.look.palette))
            self._button.label = f"Acknowledge {alarms_text(len(unread))}"

    def _told(self) -> set[str]:
        return {event.kind for event, _ in self._standing}

    def _notify(self, event: Event) -> None:
        if event.kind == REFUSED:
            while self._refusal:
                self._refusal.pop().remove()
        for client in self._server.get_clients().values():
            notification = client.add_notification(
                TITLES.get(event.kind, event.kind.capitalize()),
                event.text,
                auto_close_seconds=STAY_S.get(event.severity),
                color=hex_rgb(severity_colour(event.severity, self._ui.state.look.palette)),
            )
            if event.severity == Severity.ALARM:
                self._standing.append((event, notification))
            elif event.kind == REFUSED:
                self._refusal.append(notification)

    def _take_back(self, unread: Sequence[Event]) -> None:
        for event, notification in self._standing:
            if not any(event is alarm for alarm in unread):
                notification.remove()
        self._standing = [shown for shown in self._standing if any(shown[0] is alarm for alarm in unread)]


class Notifications:
    """Keeps the arena in sight: one of a kind at a time, but every fire that goes out and every loss of control.

    A refusal for another reason than the one that is shown takes its place at once: the old one would mislead. What the
    operator has just done is seen anyway and only logged.
    """

    def __init__(self) -> None:
        """Nothing has been notified."""
        self._shown: dict[str, tuple[float, str]] = {}  # by kind: until when [s], and its text

    def chosen(self, fresh: Sequence[Event], now: float, standing: Set[str] = frozenset()) -> list[Event]:
        """The events to be notified at `now` [s], of those that are new.

        Args:
            fresh: what is new, oldest first.
            now: time [s].
            standing: kinds of the alarms that are notified and wait to be acknowledged.
        """
        chosen: list[Event] = []
        shown = set(standing)
        for event in fresh:
            if event.severity == Severity.INFO and event.kind != "target":
                continue
            if event.severity == Severity.ALARM:
                if event.kind not in shown:
                    shown.add(event.kind)
                    chosen.append(event)
            elif self._is_news(event, now):
                self._shown[event.kind] = now + STAY_S[event.severity], event.text
                if event.kind == REFUSED:
                    chosen = [other for other in chosen if other.kind != REFUSED]
                chosen.append(event)
        others = [event for event in chosen if event.severity != Severity.ALARM]
        left_out = {id(event) for event in others[:-MOST_AT_ONCE]}
        return [event for event in chosen if id(event) not in left_out]

    def _is_news(self, event: Event, now: float) -> bool:
        until, latest = self._shown.get(event.kind, (now, ""))
        other_reason = event.kind == REFUSED and event.text != latest
        return now >= until or other_reason or event.kind in ("extinguished", "control")


def newer(events: Sequence[Event], newest: Event | None) -> list[Event]:
    """The events after one that was seen, oldest first; all of them when it is no longer kept."""
    fresh: list[Event] = []
    for event in reversed(events):
        if event is newest:
            break
        fresh.append(event)
    return fresh[::-1]


def alarms_text(count: int) -> str:
    """So many alarms, in words."""
    return f"{count} alarm{'' if count == 1 else 's'}"


def log_html(events: Sequence[Event], unread: Sequence[Event] = ()) -> str:
    """The last events, newest first; alarms that nobody has acknowledged stand out."""
    waiting = {id(alarm) for alarm in unread}
    lines = "".join(
        f'<div style="border-color:{severity_colour(event.severity)}">'
        f'<span class="dim">{session_clock(event.time)}</span>'
        f"<span{' class=alarm' if id(event) in waiting else ''}>{text(event.text)}</span></div>"
        for event in reversed(events[-MOST_SHOWN:])
    )
    return block(f'<div class="log">{lines}</div>')
