"""Who may reach the console: by the link, under its own names, from its own page, and so many pages at once.

every request   the host that it names is ours (else another name could be pointed at this machine)
the link        its token gives a login: a cookie, and a key that the login page leaves in the browser's own store
other requests  the cookie; with "seat" in it, whether a socket would find one
a socket        the cookie, the key, our own origin, and a free seat
"""

import ipaddress
import socket
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from http import HTTPStatus
from time import monotonic
from typing import TypeAlias
from urllib.parse import parse_qsl, urlencode, urlsplit

from websockets import Headers
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from higvf_console.ui.page.access import Access, Login, Role, same
from higvf_console.ui.page.document import (
    NO_LOGIN,
    OTHER_NAME,
    TOO_MANY_TRIES,
    WRONG_TOKEN,
    welcome_page,
    with_early_scripts,
)
from higvf_console.ui.page.message_filter import FilteredConnection
from higvf_console.ui.page.pace import Bucket
from higvf_console.ui.page.refusals import Refusals

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

TRIES_AT_ONCE = 10  # wrong tokens of one address
TRIES_PER_S = 0.5
MOST_ADDRESSES = 1024  # whose tries are counted
_HTML = "text/html; charset=utf-8"

Handler: TypeAlias = Callable[[ServerConnection], Awaitable[None]]
RequestHandler: TypeAlias = Callable[[ServerConnection, Request], Response | None]


def own_origins(host: str, port: int) -> set[str]:
    """The origins of a page that this console itself serves."""
    names = {"localhost", "127.0.0.1", "[::1]", f"[{host}]" if ":" in host else host}
    return {f"{scheme}://{name}:{port}" for scheme in ("http", "https") for name in names}


@dataclass
class Door:
    """Lets pages in.

    Attributes:
        port: of the console.
        access: tokens and logins.
        max_clients: pages that may be open at once.
        origins: from which a page may open a socket.
        any_host: whether the console is served under every address of this machine.
        secure: whether it is served by TLS.
        refusals: told who was refused.
        pages: that are open.
    """

    port: int
    access: Access
    max_clients: int
    origins: set[str]
    any_host: bool
    secure: bool
    refusals: Refusals
    pages: int = 0
    _tries: dict[str, Bucket] = field(default_factory=dict[str, Bucket])

    def __post_init__(self) -> None:
        """Derives what the cookie and the console are called."""
        # Cookies ignore ports: a shared name would let a second console log the first one out.
        self.cookie = f"higvf_{self.port}"
        self.hosts = {urlsplit(origin).netloc for origin in self.origins}

    def answer(self, connection: ServerConnection, request: Request, static: RequestHandler) -> Response | None:
        """The response to a request; None lets a WebSocket through."""
        try:
            return self._answer(connection, request, static)
        except Exception as error:
            self.refusals.tell("failed request", _address(connection), "a request failed", failure=error)
            return respond(HTTPStatus.INTERNAL_SERVER_ERROR, "the console could not answer this\n", "text/plain")

    def _answer(self, connection: ServerConnection, request: Request, static: RequestHandler) -> Response | None:
        host = request.headers.get("Host", "")
        if not self._names_us(host):
            self.refusals.tell("host", _address(connection), f"host {host!r} is not this console; --origin adds names")
            return respond(HTTPStatus.MISDIRECTED_REQUEST, OTHER_NAME, _HTML)
        self.access.refresh()
        query = dict(parse_qsl(urlsplit(request.path).query))
        if token := query.pop("token", ""):
            return self._log_in(connection, request, token, query)
        login = self.access.login(self._cookie_of(request))
        if login is None or "login" in query:
            return respond(HTTPStatus.UNAUTHORIZED, NO_LOGIN, _HTML)
        if request.headers.get("Upgrade", "").lower() == "websocket":
            return self._refuse_page(connection, request, login, query.get("key", ""))
        if "seat" in query:
            text = self._no_seat(login)
            return respond(HTTPStatus.SERVICE_UNAVAILABLE if text else HTTPStatus.OK, text or "", "text/plain")
        response = static(connection, request)
        return response if response is None else with_early_scripts(response)

    async def admit(self, connection: ServerConnection, handler: Handler) -> None:
        """Serves one page, and counts it while it is open."""
        login = connection.login if isinstance(connection, FilteredConnection) else None
        self.pages += 1
        if login is not None:
            login.pages.add(connection)  # pyright: ignore[reportArgumentType]
        try:
            await handler(connection)
        finally:
            self.pages -= 1
            if login is not None:
                login.pages.discard(connection)  # pyright: ignore[reportArgumentType]

    def _names_us(self, host: str) -> bool:
        """Whether a request was sent to one of our names: not to one that somebody has pointed at this machine."""
        if host in self.hosts:
            return True
        name = urlsplit(f"//{host}").hostname or ""
        return self.any_host and (name in (socket.gethostname(), socket.getfqdn()) or _is_address(name))

    def _log_in(self, connection: ServerConnection, request: Request, token: str, query: dict[str, str]) -> Response:
        address = _address(connection)
        if address not in self._tries and len(self._tries) >= MOST_ADDRESSES:
            del self._tries[next(iter(self._tries))]
        tries = self._tries.setdefault(address, Bucket(TRIES_PER_S, TRIES_AT_ONCE))
        now = monotonic()
        if not tries.holds(1, now):
            self.refusals.tell("login", address, "too many wrong tokens")
            return respond(HTTPStatus.TOO_MANY_REQUESTS, TOO_MANY_TRIES, _HTML)
        login = self.access.log_in(token, self.access.login(self._cookie_of(request)))
        if login is None:
            tries.take(1, now)
            self.refusals.tell("login", address, "a wrong token")
            return respond(HTTPStatus.UNAUTHORIZED, WRONG_TOKEN, _HTML)
        # A page that goes on from here is one of our own site, to which a browser sends a strict cookie. Relative, so
        # that it also holds behind a proxy that serves the console under a path.
        further = f"./?{urlencode(query)}" if query else "./"
        response = respond(HTTPStatus.OK, welcome_page(login.key, further), _HTML)
        secure = "; Secure" if self.secure else ""
        response.headers["Set-Cookie"] = f"{self.cookie}={login.cookie}; HttpOnly; SameSite=Strict; Path=/{secure}"
        return response

    def _cookie_of(self, request: Request) -> str:
        pairs = (part.strip().partition("=") for line in request.headers.get_all("Cookie") for part in line.split(";"))
        return next((value for name, _, value in pairs if name == self.cookie), "")

    def _refuse_page(self, connection: ServerConnection, request: Request, login: Login, key: str) -> Response | None:
        origin, host = request.headers.get("Origin", ""), request.headers.get("Host", "")
        own = origin in self.origins or (self.any_host and origin in (f"http://{host}", f"https://{host}"))
        if not own:
            self.refusals.tell("origin", _address(connection), f"a page of origin {origin!r}; --origin adds one")
            return respond(HTTPStatus.FORBIDDEN, f"origin {origin[:80]!r} may not open this console\n", "text/plain")
        if not same(key, login.key):
            self.refusals.tell("key", _address(connection), "a socket without the key of its page")
            return respond(HTTPStatus.UNAUTHORIZED, "open this console by its link\n", "text/plain")
        if (text := self._no_seat(login)) is not None:
            self.refusals.tell("seats", _address(connection), text)
            return respond(HTTPStatus.SERVICE_UNAVAILABLE, text, "text/plain")
        if isinstance(connection, FilteredConnection):
            connection.login = login
        return None

    def _no_seat(self, login: Login) -> str | None:
        """Why a login may not open one more page; None where it may."""
        most = max(1, self.max_clients // 2)
        kept = self.max_clients // 4  # for logins that have no page yet, and may steer
        if self.pages >= self.max_clients:
            return f"This console has {self.max_clients} seats, all taken: close a page of it."
        few = self.pages >= self.max_clients - kept
        if len(login.pages) >= most or (few and login.pages):
            return "This login has as many pages as it may have; the other seats are kept for others: close a page."
        if few and not login.role.may(Role.OPERATOR):
            return "As many observers are here as may be; the other seats are kept for those who steer."
        return None


def dress(response: Response) -> Response:
    """Gives any answer our headers."""
    for name, value in SECURITY_HEADERS.items():
        if name in response.headers:
            del response.headers[name]
        response.headers[name] = value
    return response


def respond(status: HTTPStatus, body: str, content_type: str) -> Response:
    """An answer of our own."""
    payload = body.encode()
    headers = {"Content-Type": content_type, "Content-Length": str(len(payload))}
    return Response(status.value, status.phrase, Headers({**headers, **SECURITY_HEADERS}), payload)


def _address(connection: ServerConnection) -> str:
    address = connection.remote_address
    return str(address[0]) if isinstance(address, tuple) and address else "an unknown address"  # pyright: ignore[reportUnknownArgumentType]


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
