"""One page steers, the others watch: what each page may do, who asks for control, and how it is handed over.

A page that watches sees everything and may zoom, pan, change tabs and press STOP. Whatever else it sends is dropped at
`page.gate`, the widget that it touched shows the true value again, and a strip in the page says who steers. Each page
reports once a second who it is; the console's channel lives on what the page in control reports, so that the session's
watch ends the human intention when that page is lost.
"""

import threading
from collections.abc import Callable
from dataclasses import replace

import viser

from higvf_console.core.awake import AwakeClock
from higvf_console.core.commands import Command, HandOver, InjectFault, LoadScenario, OperatorCommand
from higvf_console.core.edits import Edit
from higvf_console.core.interface import PointerSink
from higvf_console.ui.page import control_lease, page
from higvf_console.ui.page.access import Role
from higvf_console.ui.page.control_lease import Control, Outcome
from higvf_console.ui.page.message_filter import settings_of
from higvf_console.ui.page.notice import tell

FREE_TOPICS = frozenset({"alive", "control", "hello", "landscape", "viewport"})  # of what every page may send
EXPERIMENTER_TOPICS = frozenset({"file"})
EXPERIMENTER_ACTS = frozenset({"dismiss", "load", "own_file", "restore"})  # of the topic "card"
NEEDS_EXPERIMENTER = (Edit, InjectFault, LoadScenario)  # commands; all others are an operator's


class Roles:
    """Who has control, and a `PointerSink` that puts the name of that page on each command.

    Attributes:
        timeout: silence after which a page is lost [s].
    """

    def __init__(self, server: viser.ViserServer, sink: PointerSink, timeout: float) -> None:
        """Starts with no page.

        Args:
            server: whose pages are meant.
            sink: takes the commands.
            timeout: silence after which a page is lost [s].
        """
        self._server, self._sink, self.timeout = server, sink, timeout
        self._lock, self._clock = threading.RLock(), AwakeClock()
        self._control = Control()
        self._identities: dict[int, str] = {}  # of the pages that are connected, by client
        self._shown: dict[int, page.Body] = {}
        self._steering: int | None = None
        self._free: set[str] = set()
        self._on_change: Callable[[int | None], None] = lambda _: None

    def install(self, on_change: Callable[[int | None], None]) -> None:
        """Tells every page its role and keeps those that watch from acting.

        Args:
            on_change: called with the client that steers from now on, None when there is none; must return at once.
        """
        self._on_change = on_change
        page.listen(self._server, "hello", self._hello)
        page.listen(self._server, "control", self._click)
        page.on_leave(self._server, self._leave)
        page.gate(self._server, self._may, tell)
        page.install(self._server, "roles", {})

    def allow(self, uuid: str) -> None:
        """Lets every page use a widget or palette command, a command at any pace: what stops the team."""
        self._free.add(uuid)
        settings_of(self._server).stops.add(uuid)

    def steers(self, client_id: int) -> bool:
        """Whether a page has control."""
        return self._identities.get(client_id, "-") == self._control.holder and self._role(client_id).may(Role.OPERATOR)

    def push(self, command: OperatorCommand) -> None:
        """A command of the page that steers; callable from any thread."""
        client = self._steering
        if client is not None and isinstance(command, NEEDS_EXPERIMENTER) and not self._has(client, Role.EXPERIMENTER):
            return
        self._push(command, self._control.name(self._control.holder))

    def push_of(self, client_id: int, command: OperatorCommand) -> None:
        """A command of a page that may be one that watches; callable from any thread."""
        self._push(command, self._control.name(self._identities.get(client_id, "")))

    def heartbeat(self) -> None:
        """The page that steers is there; callable from any thread."""
        self._sink.heartbeat()

    def update(self) -> None:
        """Forgets pages that have fallen silent, and tells those that send too much.

        To be called a few times a second, from any thread.
        """
        with self._lock:
            self._follow(control_lease.forgotten(self._control, self._clock.now(), self.timeout))
        for client_id, count in page.dropped(self._server).items():
            page.call(self._server, "roles", "slowed", count, client_id)
        if (access := settings_of(self._server).access) is not None:
            access.refresh()

    def _push(self, command: OperatorCommand, name: str) -> None:
        self._sink.push(replace(command, operator=name or Command.operator))

    def _may(self, client_id: int, topic: str, body: page.Body) -> bool:
        if topic in FREE_TOPICS or (topic == "key" and body["name"] == "stop"):
            return True
        if topic == page.WIDGET and body.get("uuid") in self._free:
            return True
        if self.steers(client_id):
            edits = topic in EXPERIMENTER_TOPICS or (topic == "card" and body["act"] in EXPERIMENTER_ACTS)
            return not edits or self._has(client_id, Role.EXPERIMENTER)
        # Putting a notification away, or ending a stroke that was refused, is no try at steering.
        if topic != "read" and (topic != "stroke" or body["phase"] != "cancel"):
            page.call(self._server, "roles", "refused", None, client_id)
        return False

    def _role(self, client_id: int) -> Role:
        return page.role_of(self._server, client_id)

    def _has(self, client_id: int, role: Role) -> bool:
        """Whether a page's login has a role; the page is told where it has not."""
        if self._role(client_id).may(role):
            return True
        page.call(self._server, "roles", "lacks", [role, self._role(client_id)], client_id)
        return False

    def _hello(self, client_id: int, body: page.Body) -> None:
        identity = body["identity"]
        with self._lock:
            if self._identities.get(client_id, identity) != identity:
                raise ValueError("a page keeps its identity")
            may_steer = self._role(client_id).may(Role.OPERATOR)
            outcome = control_lease.heartbeat(self._control, identity, self._clock.now(), may_steer=may_steer)
            # The newest connection speaks for a page; an older one is cut off already, or of a copy of the page.
            for other in [other for other, known in self._identities.items() if known == identity]:
                if other != client_id:
                    self._forget(other)
                    page.call(self._server, "roles", "renew", None, other)
            self._identities[client_id] = identity
            self._follow(outcome)
            if self.steers(client_id):
                self.heartbeat()

    def _click(self, client_id: int, body: page.Body) -> None:
        act, name = body["act"], body["page"]
        if not self._has(client_id, Role.OPERATOR):
            return
        with self._lock:
            control, identity = self._control, self._identities.get(client_id, "")
            match act:
                case "ask":
                    self._follow(control_lease.asked(control, identity))
                case "take":
                    self._follow(control_lease.taken(control, identity))
                case "release":
                    self._follow(control_lease.released(control, identity))
                case _:
                    self._follow(control_lease.answered(control, identity, name, granted=act == "grant"))

    def _leave(self, client_id: int) -> None:
        with self._lock:
            self._forget(client_id)
            self._follow((self._control, None))

    def _forget(self, client_id: int) -> None:
        self._identities.pop(client_id, None)
        self._shown.pop(client_id, None)

    def _follow(self, outcome: Outcome) -> None:
        self._control, change = outcome
        connected = {identity: client_id for client_id, identity in self._identities.items()}
        now_steering = connected.get(self._control.holder)
        if now_steering != self._steering:
            self._steering = now_steering
            self._on_change(now_steering)
        if change is not None:
            self._sink.push(HandOver(change.page, change.how, operator=change.by))
        for client_id, identity in self._identities.items():
            view = role_of(self._control, identity) | {"role": self._role(client_id)}
            if self._shown.get(client_id) != view:
                self._shown[client_id] = view
                page.call(self._server, "roles", "show", view, client_id)


def role_of(control: Control, identity: str) -> page.Body:
    """What a page is sent: its name, who steers, who waits, and how many others there are."""
    return {
        "you": control.name(identity),
        "steers": identity == control.holder,
        "holder": control.name(control.holder),
        "asked": identity in control.waiting,
        "waiting": [control.name(waiting) for waiting in control.waiting],
        "others": len(control.pages) - (control.page(identity) is not None),
    }
