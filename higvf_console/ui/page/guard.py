"""Who may reach the console, and what a page may say to it.

viser itself serves everyone who can reach its port, lets a page of any site drive a console on localhost, and lets a
page set any attribute of a widget. So the server is started here, behind four checks:

    address   the socket is bound before viser starts: a busy port or an unassignable host is an error, not a surprise
    login     the printed link carries a token and leaves a cookie; without one, every request is answered 401
    origin    a WebSocket is opened for our own page only, and for so many pages at once
    filter    a message that no honest page sends is dropped and logged; the operator's connection stays open

This module alone knows how viser starts its web server.
"""

import contextlib
import errno
import hashlib
import hmac
import io
import logging
import secrets
import socket
import threading
from collections.abc import Awaitable, Callable, Generator
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any
from urllib.parse import parse_qsl, urlencode, urlsplit

import viser
import websockets.asyncio.server
from viser import _messages
from websockets import Headers
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from higvf_console.core.errors import ConsoleError
from higvf_console.ui.page.page import PageMessage

VISER_VERSION = "1.1.1"
MAX_FRAME_BYTES = 2 * 1024 * 1024
MAX_REFUSALS_LOGGED = 10  # of one page, so that a hostile one cannot fill the disk

# What an honest page sends. File uploads and the public share tunnel are not part of the console.
ALLOWED_MESSAGES = frozenset(
    {
        PageMessage,
        _messages.CommandTriggerMessage,
        _messages.GetRenderResponseMessage,
        _messages.GuiButtonHoldMessage,
        _messages.GuiFormDirtyMessage,
        _messages.GuiFormSubmitMessage,
        _messages.GuiUpdateMessage,
        _messages.LocalStorageGetItemResponseMessage,
        _messages.SceneNodeClickMessage,
        _messages.SceneNodeDragMessage,
        _messages.ScenePointerMessage,
        _messages.TransformControlsDragEndMessage,
        _messages.TransformControlsDragStartMessage,
        _messages.TransformControlsUpdateMessage,
        _messages.ViewerCameraMessage,
    }
)

SECURITY_HEADERS = {
    # viser's page needs inline scripts, its decoder and workers; nothing in it may come from, or go to, another site.
    "Content-Security-Policy": (
        "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; frame-ancestors 'self'; form-action 'self'"
    ),
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "SAMEORIGIN",
}

LOGIN_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Console: login needed</title>
<style>body{background:#14171c;color:#d7dce3;font:17px/1.6 system-ui,sans-serif;max-width:34em;margin:18vh auto;
padding:0 1.5em}h1{font-size:1.3em;color:#fff}
code{background:#242a33;border-radius:4px;padding:.1em .4em;white-space:nowrap}</style>
<h1>This console opens by its link</h1>
<p>Whoever started the console was shown a link that ends in <code>?token=&hellip;</code>: please open that link in this
browser. It stays logged in until the browser is closed.</p>
<p>If the console was started again since then, it has printed a new link.</p></html>"""

_log = logging.getLogger(__name__)
_starting = threading.Lock()

Handler = Callable[[ServerConnection], Awaitable[None]]
RequestHandler = Callable[[ServerConnection, Request], Response | None]


def new_token() -> str:
    """A fresh secret for `open_server`."""
    return secrets.token_urlsafe(18)


def login_url(server: viser.ViserServer, token: str) -> str:
    """The address to print; it logs a browser in."""
    host = server.get_host()
    shown = {"0.0.0.0": "localhost", "::": "localhost", "": "localhost"}.get(host, host)
    netloc = f"[{shown}]" if ":" in shown else shown
    return f"http://{netloc}:{server.get_port()}/?{urlencode({'token': token})}"


def open_server(
    host: str, port: int, token: str, label: str, *, max_clients: int = 16, origins: tuple[str, ...] = ()
) -> viser.ViserServer:
    """Starts viser behind the guard.

    Args:
        host: address to bind, e.g. "127.0.0.1".
        port: TCP port; 0 takes a free one, which `get_port()` tells.
        token: secret that `login_url` carries.
        label: title of the control panel.
        max_clients: pages that may be open at once.
        origins: further origins that may open the console, e.g. "https://lab.example" of a reverse proxy.

    Raises:
        ConsoleError: another version of viser, an address that is busy, unknown or not of this machine, no token.
    """
    if viser.__version__ != VISER_VERSION:
        raise ConsoleError(
            f"viser {viser.__version__} is installed, but the console uses private parts of viser {VISER_VERSION}; "
            f"run: pip install viser=={VISER_VERSION}"
        )
    if not token:
        raise ConsoleError("token: '' would let anyone in; give a secret, e.g. from `guard.new_token()`")
    listener = _bind(host, port)
    bound_port: int = listener.getsockname()[1]
    door = _Door(
        port=bound_port,
        token=token,
        max_clients=max_clients,
        origins=_own_origins(host, bound_port) | set(origins),
        any_host=host in ("", "0.0.0.0", "::"),
    )
    try:
        with _guarded(listener, door):
            return viser.ViserServer(host=host, port=bound_port, label=label, verbose=False)
    except BaseException:
        listener.close()
        raise


def _bind(host: str, port: int) -> socket.socket:
    """A listening socket; viser would hang on a host that cannot be assigned, and take the next port on a busy one."""
    if not 0 <= port <= 65535:
        raise ConsoleError(f"port {port} does not exist: choose one from 1 to 65535 with --port, or auto")
    try:
        found = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        family, kind, protocol, _, address = min(found, key=lambda entry: entry[0] != socket.AF_INET)
        listener = socket.socket(family, kind, protocol)
    except (OSError, UnicodeError) as error:
        raise ConsoleError(f"host {host!r} is not known ({error}): choose another with --host") from error
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(100)
    except OSError as error:
        listener.close()
        raise ConsoleError(_cannot_bind(host, port, error)) from error
    return listener


def _cannot_bind(host: str, port: int, error: OSError) -> str:
    match error.errno:
        case errno.EADDRINUSE:
            return (
                f"port {port} on {host} is busy, perhaps with another console: "
                "choose another with --port, or let --port auto take a free one"
            )
        case errno.EADDRNOTAVAIL:
            return f"host {host} is no address of this machine: choose another with --host, e.g. --host 127.0.0.1"
        case errno.EACCES:
            return f"port {port} needs more rights than this user has: choose one above 1023 with --port"
        case _:
            return f"cannot serve at {host}:{port} ({error}): choose another address with --host and --port"


def _own_origins(host: str, port: int) -> set[str]:
    """The origins of a page that this console itself serves."""
    names = {"localhost", "127.0.0.1", "[::1]", f"[{host}]" if ":" in host else host}
    return {f"{scheme}://{name}:{port}" for scheme in ("http", "https") for name in names}


@dataclass
class _Door:
    """Lets pages in: login, origin, number."""

    port: int
    token: str
    max_clients: int
    origins: set[str]
    any_host: bool
    pages: int = 0

    def __post_init__(self) -> None:
        # A token may hold characters that a cookie may not.
        self.secret = hashlib.sha256(self.token.encode()).hexdigest()
        # Cookies ignore ports: a shared name would let a second console log the first one out.
        self.cookie = f"higvf_{self.port}"

    def answer(self, connection: ServerConnection, request: Request, static: RequestHandler) -> Response | None:
        """The response to a request; None lets a WebSocket through."""
        query = dict(parse_qsl(urlsplit(request.path).query))
        if _same(query.pop("token", ""), self.token):
            return self._log_in(query)
        if not _same(self._cookie_of(request), self.secret):
            return _respond(HTTPStatus.UNAUTHORIZED, LOGIN_PAGE, "text/html; charset=utf-8")
        if request.headers.get("Upgrade", "").lower() == "websocket":
            return self._refuse_page(request)
        response = static(connection, request)
        if response is not None:
            response.headers.update(SECURITY_HEADERS)
        return response

    async def admit(self, connection: ServerConnection, handler: Handler) -> None:
        """Serves one page, and counts it while it is open."""
        self.pages += 1
        try:
            await handler(connection)
        finally:
            self.pages -= 1

    def _log_in(self, query: dict[str, str]) -> Response:
        # Relative, so that it also holds behind a proxy that serves the console under a path.
        response = _respond(HTTPStatus.FOUND, "", "text/plain")
        response.headers["Location"] = f"./?{urlencode(query)}" if query else "./"
        response.headers["Set-Cookie"] = f"{self.cookie}={self.secret}; HttpOnly; SameSite=Lax; Path=/"
        return response

    def _cookie_of(self, request: Request) -> str:
        pairs = (part.strip().partition("=") for line in request.headers.get_all("Cookie") for part in line.split(";"))
        return next((value for name, _, value in pairs if name == self.cookie), "")

    def _refuse_page(self, request: Request) -> Response | None:
        origin, host = request.headers.get("Origin", ""), request.headers.get("Host", "")
        own = origin in self.origins or (self.any_host and origin in (f"http://{host}", f"https://{host}"))
        if not own:
            _log.warning("refused a page of origin %r; this console's own: %s", origin, ", ".join(sorted(self.origins)))
            return _respond(HTTPStatus.FORBIDDEN, f"origin {origin!r} may not open this console\n", "text/plain")
        if self.pages >= self.max_clients:
            text = f"{self.max_clients} pages of this console are open already: close one\n"
            return _respond(HTTPStatus.SERVICE_UNAVAILABLE, text, "text/plain")
        return None


def _same(given: str, expected: str) -> bool:
    return hmac.compare_digest(given.encode(errors="replace"), expected.encode())


def _respond(status: HTTPStatus, body: str, content_type: str) -> Response:
    payload = body.encode()
    headers = {"Content-Type": content_type, "Content-Length": str(len(payload))}
    return Response(status.value, status.phrase, Headers({**headers, **SECURITY_HEADERS}), payload)


class _FilteredConnection(ServerConnection):
    """A WebSocket that passes on only what an honest page sends."""

    refused = 0

    async def recv(self, decode: bool | None = None) -> str | bytes:  # pyright: ignore[reportIncompatibleMethodOverride]
        while True:
            frame = await super().recv(decode)
            reason = refusal(frame)
            if reason is None:
                return frame
            self.refused += 1
            if self.refused <= MAX_REFUSALS_LOGGED:
                _log.warning("dropped a message of the page at %s: %s", self.remote_address, reason)


@contextlib.contextmanager
def _guarded(listener: socket.socket, door: _Door) -> Generator[None]:
    """While viser starts, its web server is started on our socket and behind our door."""
    original = websockets.asyncio.server.serve

    def serve(handler: Handler, _host: str, _port: int, **options: Any) -> Any:
        static: RequestHandler = options["process_request"]

        def answer(connection: ServerConnection, request: Request) -> Response | None:
            return door.answer(connection, request, static)

        def admit(connection: ServerConnection) -> Awaitable[None]:
            return door.admit(connection, handler)

        options |= {"process_request": answer, "max_size": MAX_FRAME_BYTES, "create_connection": _FilteredConnection}
        return original(admit, sock=listener, **options)

    # viser prints an address of its own, which lacks the token.
    with _starting, contextlib.redirect_stdout(io.StringIO()):
        websockets.asyncio.server.serve = serve
        try:
            yield
        finally:
            websockets.asyncio.server.serve = original


def refusal(frame: bytes | str) -> str | None:
    """Why a page may not send this frame; None when it may."""
    if isinstance(frame, str):
        return "a text frame"
    try:
        message = _messages.Message.deserialize(frame)
    except Exception as error:  # viser's decoder raises whatever the content makes it raise
        return f"not a message of viser {VISER_VERSION} ({type(error).__name__}: {error})"
    if type(message) not in ALLOWED_MESSAGES:
        return f"{type(message).__name__} is for the server to send"
    if isinstance(message, _messages.GuiUpdateMessage) and list(message.updates) != ["value"]:
        return f"a widget's {str(message.updates)[:80]} are for the server to set; a page may set 'value'"
    return None
