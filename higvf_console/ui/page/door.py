"""Who may reach the console: by the link, under its own names, from its own page, and so many pages at once.

every request   the host that it names is ours (else another name could be pointed at this machine)
the link        its token gives a login: a cookie, and a key that the login page leaves in the browser's own store
other requests  the cookie
a socket        the cookie, the key, our own origin, and a free seat
"""

import gzip
import ipaddress
import json
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

from higvf_console.ui.page.access import Access, Login, same
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

LOGIN_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Console: login needed</title>
<style>body{background:#14171c;color:#d7dce3;font:17px/1.6 system-ui,sans-serif;max-width:34em;margin:18vh auto;
padding:0 1.5em}h1{font-size:1.3em;color:#fff}
code{background:#242a33;border-radius:4px;padding:.1em .4em;white-space:nowrap}</style>
<h1>This console opens by its link</h1>
<p>Whoever started the console was shown a link that ends in <code>?token=&hellip;</code>: please open that link in this
browser. It stays logged in until the browser is closed.</p>
<p>If the console was started again since then, it has printed a new link.</p></html>"""

# The cookie is sent to every server of this host; what a page stores, no other server gets.
_STORE = "'higvf key ' + location.pathname.replace(/[^/]*$/, '')"
_WELCOME = f"""<!doctype html><html lang="en"><meta charset="utf-8"><title>Console</title>
<script>localStorage.setItem({_STORE}, %s); location.replace(%s);</script></html>"""
# viser opens its socket in a worker, which it tells the address: the key is added there.
_HAND_IN_KEY = f"""<script>(() => {{
  const key = localStorage.getItem({_STORE});
  if (!key) location.replace("./?login=1");
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (message, ...rest) {{
    if (message?.type === "set_server") message = {{ ...message, server: `${{message.server}}/?key=${{key}}` }};
    return post.call(this, message, ...rest);
  }};
}})();</script>"""

TRIES_AT_ONCE = 10  # wrong tokens of one address
TRIES_PER_S = 0.5
MOST_ADDRESSES = 1024  # whose tries are counted

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
    _documents: dict[str, bytes] = field(default_factory=dict[str, bytes])

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
            return respond(HTTPStatus.MISDIRECTED_REQUEST, "this console has another name\n", "text/plain")
        self.access.refresh()
        query = dict(parse_qsl(urlsplit(request.path).query))
        if token := query.pop("token", ""):
            return self._log_in(connection, request, token, query)
        login = self.access.login(self._cookie_of(request))
        if login is None or "login" in query:
            return respond(HTTPStatus.UNAUTHORIZED, LOGIN_PAGE, "text/html; charset=utf-8")
        if request.headers.get("Upgrade", "").lower() == "websocket":
            return self._refuse_page(connection, request, login, query.get("key", ""))
        return self._document(static(connection, request), request)

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
            text = "too many wrong tokens from this address: wait some seconds\n"
            return respond(HTTPStatus.TOO_MANY_REQUESTS, text, "text/plain")
        login = self.access.log_in(token, self.access.login(self._cookie_of(request)))
        if login is None:
            tries.take(1, now)
            self.refusals.tell("login", address, "a wrong token")
            return respond(HTTPStatus.UNAUTHORIZED, LOGIN_PAGE, "text/html; charset=utf-8")
        # A page that goes on from here is one of our own site, to which a browser sends a strict cookie. Relative, so
        # that it also holds behind a proxy that serves the console under a path.
        further = json.dumps(f"./?{urlencode(query)}" if query else "./").replace("<", "\\u003c")
        response = respond(HTTPStatus.OK, _WELCOME % (json.dumps(login.key), further), "text/html; charset=utf-8")
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
            return respond(HTTPStatus.SERVICE_UNAVAILABLE, f"{text}: close one\n", "text/plain")
        if isinstance(connection, FilteredConnection):
            connection.login = login
        return None

    def _no_seat(self, login: Login) -> str | None:
        """Why a login may not open one more page; None where it may."""
        most = max(1, self.max_clients // 2)
        kept = self.max_clients // 4  # for logins that have no page yet
        if self.pages >= self.max_clients:
            return f"{self.pages} pages of this console are open already"
        if len(login.pages) >= most or (login.pages and self.pages >= self.max_clients - kept):
            return f"{len(login.pages)} pages of this browser are open already, and seats are kept for others"
        return None

    def _document(self, response: Response | None, request: Request) -> Response | None:
        """What viser serves, with our headers, and the key handed in by the page."""
        if response is None or response.status_code != HTTPStatus.OK:
            return response
        if urlsplit(request.path).path.rstrip("/") in ("", "/index.html"):
            encoding = response.headers.get("Content-Encoding", "identity")
            if encoding not in self._documents:
                packed = encoding == "gzip"
                text = gzip.decompress(response.body) if packed else response.body
                text = text.replace(b"<head>", b"<head>" + _HAND_IN_KEY.encode(), 1)
                self._documents[encoding] = gzip.compress(text) if packed else bytes(text)
            response.body = self._documents[encoding]
            del response.headers["Content-Length"]
            response.headers["Content-Length"] = str(len(response.body))
        return response


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
    return str(address[0]) if isinstance(address, tuple) and address else "an unknown address"


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
