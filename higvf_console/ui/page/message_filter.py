"""The socket of a page: passes on what an honest page sends, at an honest pace; STOP passes at any pace.

All sockets share one event loop. So that no page holds up the STOP of another, what a page has sent is parsed piece by
piece, one in each turn of the loop, and meanwhile no more is read from it: TCP slows a flooder down.
"""

import asyncio
import logging
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from time import monotonic
from typing import Any
from weakref import WeakKeyDictionary

import viser
from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode, Frame, Opcode

from higvf_console.ui.page.access import Access, Login
from higvf_console.ui.page.message_table import CommandTriggerMessage, Key, checked
from higvf_console.ui.page.pace import Limits, Pace
from higvf_console.ui.page.refusals import Refusals, RefusedError

PIECE_READ = 2048  # bytes of one page that are parsed before the others have their turn
FRAMES_IN_A_ROW = 32  # that one page may have passed on before the others have their turn
LONGEST_STOP = 256  # bytes of a frame
CLOSING_S = 1.0  # [s] that a page that is cut off has to read why

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class FilterSettings:
    """What the sockets of a console share.

    Attributes:
        refusals: told what was refused.
        limits: to what a page sends.
        stops: uuids of the palette's commands that stop the team.
        access: tokens and logins; None = everybody may everything.
    """

    refusals: Refusals = field(default_factory=Refusals)
    limits: Limits = field(default_factory=Limits)
    stops: set[str] = field(default_factory=set[str])
    access: Access | None = None


class FilteredConnection(ServerConnection):
    """A WebSocket that passes on only what an honest page sends.

    Attributes:
        pace: how much the page has said.
        login: by which it was opened.
    """

    def __init__(self, settings: FilterSettings, *arguments: Any, **options: Any) -> None:
        """Opens it; `arguments` and `options` are those of `ServerConnection`."""
        super().__init__(*arguments, **options)
        self._settings = settings
        self._frames = 0
        self._unparsed, self._turn_due, self._deaf = bytearray(), False, False
        self._cutting: asyncio.Task[None] | None = None
        self.pace = Pace(settings.limits)
        self.login: Login | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Opens the socket; it reads by turns."""
        super().connection_made(transport)
        self.recv_messages.resume = self._ask_for_turn

    def data_received(self, data: bytes) -> None:
        """Parses the first piece of what came, and the others by turns."""
        self._unparsed += data
        if not self._turn_due:
            self._take_turn()

    def eof_received(self) -> None:
        """Parses first what is left."""
        self._parse(len(self._unparsed))
        super().eof_received()

    def connection_lost(self, exc: Exception | None) -> None:
        """Ends it."""
        self._unparsed.clear()
        super().connection_lost(exc)

    def process_event(self, event: Any) -> None:
        """Takes a frame in; counts those that `recv` never returns, pings and parts of messages."""
        super().process_event(event)
        whole = not isinstance(event, Frame) or (event.fin and event.opcode in (Opcode.TEXT, Opcode.BINARY))
        if not whole and self._cutting is None and not self.pace.bears_part(monotonic()):
            self._cutting = self.loop.create_task(self._cut())

    def _take_turn(self) -> None:
        self._turn_due = False
        self._parse(len(self._unparsed) if self._deaf else PIECE_READ)
        if self._unparsed:
            self.transport.pause_reading()
        if not self.recv_messages.paused:
            self._ask_for_turn()

    def _ask_for_turn(self) -> None:
        """Parses the next piece in the next turn of the loop; reads on where there is none."""
        if not self._unparsed:
            self.transport.resume_reading()
        elif not self._turn_due:
            self._turn_due = True
            self.loop.call_soon(self._take_turn)

    def _parse(self, size: int) -> None:
        piece = bytes(self._unparsed[:size])
        del self._unparsed[:size]
        if piece:
            super().data_received(piece)

    async def recv(self, decode: bool | None = None) -> str | bytes:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The next frame that may pass."""
        while True:
            frame = await super().recv(decode)
            self._frames += 1
            if self._frames % FRAMES_IN_A_ROW == 0:
                await asyncio.sleep(0)
            now = monotonic()
            in_pace = self.pace.allows(len(frame), now)
            if self._passes(frame, in_pace):
                return frame
            if not in_pace and not self.pace.bears(len(frame), now):
                await self._cut()

    def _passes(self, frame: str | bytes, in_pace: bool) -> bool:
        """Whether a frame may pass; one that came too fast is looked at only if it may hold a STOP."""
        if not in_pace and len(frame) > LONGEST_STOP:
            return False
        try:
            message, body = checked(frame)
        except RefusedError as refused:
            self._settings.refusals.tell(refused.kind, self.remote_address, str(refused))
            return False
        if isinstance(body, Key) and body.name == "stop":
            return True
        return in_pace or (isinstance(message, CommandTriggerMessage) and message.uuid in self._settings.stops)

    async def close(self, code: int = CloseCode.NORMAL_CLOSURE, reason: str = "") -> None:
        """Closes it, when its reader has ended, and lets go of all that leads back to it.

        A flooder's frames would stay, thousands of them in a cycle of references, until the garbage collector looks
        through them, which may be in a control period.
        """
        await super().close(code, reason)
        self.recv_messages.frames.queue.clear()
        self.recv_messages.pause = self.recv_messages.resume = _nothing
        self.protocol.logger = self.logger = _log
        self.recv_exc = self.keepalive_task = None

    def end(self, reason: str) -> None:
        """Ends the connection; callable from any thread."""
        asyncio.run_coroutine_threadsafe(self._close(reason), self.loop)

    async def _cut(self) -> None:
        reason = "this page sent far too much; reload it"
        self._settings.refusals.tell("pace", self.remote_address, f"the page was cut off: {reason}")
        await self._close(reason)

    async def _close(self, reason: str) -> None:
        """Tells why, and reads nothing more."""
        self.loop.call_later(CLOSING_S, self.transport.abort)
        self._deaf = True
        with suppress(ConnectionClosed):
            async with self.send_context():
                self.protocol.fail(CloseCode.POLICY_VIOLATION, reason)


def filtering(settings: FilterSettings) -> Callable[..., FilteredConnection]:
    """Makes sockets that share `settings`."""

    def connection(*arguments: Any, **options: Any) -> FilteredConnection:
        return FilteredConnection(settings, *arguments, **options)

    return connection


def _nothing() -> None:
    """What a socket that has ended does to go on."""


_settings: "WeakKeyDictionary[viser.ViserServer, FilterSettings]" = WeakKeyDictionary()


def settings_of(server: viser.ViserServer) -> FilterSettings:
    """What the sockets of a server share."""
    return _settings.setdefault(server, FilterSettings())


def keep_settings(server: viser.ViserServer, settings: FilterSettings) -> None:
    """Makes `settings` those of a server."""
    _settings[server] = settings
