"""The socket of a page: passes on what an honest page sends, at an honest pace; STOP passes at any pace."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic
from typing import Any
from weakref import WeakKeyDictionary

import viser
from websockets.asyncio.server import ServerConnection
from websockets.frames import CloseCode

from higvf_console.ui.page.access import Access, Login
from higvf_console.ui.page.message_table import CommandTriggerMessage, Key, checked
from higvf_console.ui.page.pace import Limits, Pace
from higvf_console.ui.page.refusals import Refusals, RefusedError

FRAMES_IN_A_ROW = 32  # that one page may have read before the others have their turn
LONGEST_STOP = 256  # bytes of a frame
CLOSING_S = 1.0  # [s] that a page that is cut off has to read why


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
        self.pace = Pace(settings.limits)
        self.login: Login | None = None

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
        """Closes it, when its reader has ended, and lets go of what was never read.

        A flooder's frames would stay, thousands of them in a cycle of references, until the garbage collector looks
        through them, which may be in a control period.
        """
        await super().close(code, reason)
        self.recv_messages.frames.queue.clear()

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
        async with self.send_context():
            self.protocol.fail(CloseCode.POLICY_VIOLATION, reason)


def filtering(settings: FilterSettings) -> Callable[..., FilteredConnection]:
    """Makes sockets that share `settings`."""

    def connection(*arguments: Any, **options: Any) -> FilteredConnection:
        return FilteredConnection(settings, *arguments, **options)

    return connection


_settings: "WeakKeyDictionary[viser.ViserServer, FilterSettings]" = WeakKeyDictionary()


def settings_of(server: viser.ViserServer) -> FilterSettings:
    """What the sockets of a server share."""
    return _settings.setdefault(server, FilterSettings())


def keep_settings(server: viser.ViserServer, settings: FilterSettings) -> None:
    """Makes `settings` those of a server."""
    _settings[server] = settings
