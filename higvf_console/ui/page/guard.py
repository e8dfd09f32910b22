"""Who may reach the console, and what a page may say to it.

viser itself serves everyone who can reach its port, lets a page of any site drive a console on localhost, and lets a
page set any attribute of a widget. So the server is started here, behind four checks:

    address   the socket is bound before viser starts: a busy port or an unassignable host is an error, not a surprise
    login     the link carries a token, which gives a role (`access`), a cookie and a key; without the cookie, every
              request is answered 401 (`door`)
    socket    a WebSocket is opened for our own page only, with its key, and for so many pages at once (`door`)
    filter    a message that no honest page sends is dropped and logged (`message_table`), as is what
              comes too fast; who goes on so is cut off (`message_filter`)

This module alone knows how viser starts its web server.
"""

import contextlib
import errno
import io
import secrets
import socket
import ssl
import threading
from collections.abc import Awaitable, Generator
from pathlib import Path
from typing import Any
from urllib.parse import urlencode, urlsplit
from weakref import WeakSet

import viser
import websockets.asyncio.server
from viser import _messages
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from higvf_console.core.errors import ConsoleError
from higvf_console.ui.page import page
from higvf_console.ui.page.access import Access, Role
from higvf_console.ui.page.buffers import use_safe_buffers
from higvf_console.ui.page.door import Door, Handler, RequestHandler, dress, own_origins
from higvf_console.ui.page.message_filter import FilterSettings, filtering, keep_settings
from higvf_console.ui.page.pace import Limits
from higvf_console.ui.page.refusals import socket_logger

VISER_VERSION = "1.1.1"
MAX_FRAME_BYTES = 2 * 1024 * 1024

PAGE_LIMITS = Limits()

_starting = threading.Lock()
_encrypted: "WeakSet[viser.ViserServer]" = WeakSet()


def new_token() -> str:
    """A fresh secret for `open_server`."""
    return secrets.token_urlsafe(18)


def login_url(server: viser.ViserServer, token: str) -> str:
    """The address to print; it logs a browser in."""
    host = server.get_host()
    shown = {"0.0.0.0": "localhost", "::": "localhost", "": "localhost"}.get(host, host)
    netloc = f"[{shown}]" if ":" in shown else shown
    scheme = "https" if server in _encrypted else "http"
    return f"{scheme}://{netloc}:{server.get_port()}/?{urlencode({'token': token})}"


def open_server(
    host: str,
    port: int,
    token: str | Access,
    label: str,
    *,
    max_clients: int = 16,
    origins: tuple[str, ...] = (),
    limits: Limits = PAGE_LIMITS,
    certificate: tuple[Path, Path] | None = None,
) -> viser.ViserServer:
    """Starts viser behind the guard.

    Args:
        host: address to bind, e.g. "127.0.0.1".
        port: TCP port; 0 takes a free one, which `get_port()` returns.
        token: secret that `login_url` carries, of a login that may do everything; or the tokens of several roles.
        label: title of the control panel.
        max_clients: pages that may be open at once.
        origins: further origins that may open the console, e.g. "https://lab.example" of a reverse proxy.
        limits: to what one page sends.
        certificate: files of a certificate and its key, for TLS; None = none.

    Raises:
        ConsoleError: another version of viser, an address that is busy, unknown or not of this machine, no token, an
            origin or a certificate that cannot be used.
    """
    if viser.__version__ != VISER_VERSION:
        raise ConsoleError(
            f"viser {viser.__version__} is installed, but the console uses private parts of viser {VISER_VERSION}; "
            f"run: pip install viser=={VISER_VERSION}"
        )
    use_safe_buffers()
    access = Access({Role.EXPERIMENTER: token}) if isinstance(token, str) else token
    tls = None if certificate is None else _tls(*certificate)
    for origin in origins:
        _check_origin(origin)
    listener = _bind(host, port)
    bound_port: int = listener.getsockname()[1]
    settings = FilterSettings(limits=limits, access=access)
    door = Door(
        port=bound_port,
        access=access,
        max_clients=max_clients,
        origins=own_origins(host, bound_port) | set(origins),
        any_host=host in ("", "0.0.0.0", "::"),
        secure=tls is not None,
        refusals=settings.refusals,
    )
    try:
        # viser decodes the messages of our scripts, which must be known by now.
        assert page.PageMessage.__name__ in {kind.__name__ for kind in _messages.Message.get_subclasses()}
        with _guarded(listener, door, settings, tls):
            server = viser.ViserServer(host=host, port=bound_port, label=label, verbose=False)
    except BaseException:
        listener.close()
        raise
    keep_settings(server, settings)
    if tls is not None:
        _encrypted.add(server)
    return server


def _tls(certificate: Path, key: Path) -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    try:
        context.load_cert_chain(certificate, key)
    except (OSError, ssl.SSLError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ConsoleError(f"--certfile {certificate} with --keyfile {key}: cannot be used ({reason})") from error
    return context


def _check_origin(origin: str) -> None:
    parts = urlsplit(origin)
    if parts.scheme not in ("http", "https") or not parts.netloc or f"{parts.scheme}://{parts.netloc}" != origin:
        raise ConsoleError(f"--origin {origin}: expected scheme and host, e.g. https://lab.example")


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
            return f"host {host} is not an address of this machine: choose another with --host, e.g. --host 127.0.0.1"
        case errno.EACCES:
            return f"port {port} needs more rights than this user has: choose one above 1023 with --port"
        case _:
            return f"cannot serve at {host}:{port} ({error}): choose another address with --host and --port"


@contextlib.contextmanager
def _guarded(
    listener: socket.socket, door: Door, settings: FilterSettings, tls: ssl.SSLContext | None
) -> Generator[None]:
    """While viser starts, its web server is started on our socket and behind our door."""
    original = websockets.asyncio.server.serve

    def serve(handler: Handler, _host: str, _port: int, **options: Any) -> Any:
        static: RequestHandler = options["process_request"]

        def answer(connection: ServerConnection, request: Request) -> Response | None:
            return door.answer(connection, request, static)

        def dressed(_connection: ServerConnection, _request: Request, response: Response) -> Response:
            return dress(response)

        def admit(connection: ServerConnection) -> Awaitable[None]:
            return door.admit(connection, handler)

        options |= {"process_request": answer, "max_size": MAX_FRAME_BYTES, "create_connection": filtering(settings)}
        options |= {"logger": socket_logger(settings.refusals), "ssl": tls, "server_header": None}
        options["process_response"] = dressed
        return original(admit, sock=listener, **options)

    # viser prints an address of its own, which lacks the token.
    with _starting, contextlib.redirect_stdout(io.StringIO()):
        websockets.asyncio.server.serve = serve
        try:
            yield
        finally:
            websockets.asyncio.server.serve = original
