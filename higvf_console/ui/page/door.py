"""Who may reach the console: by the printed link, from our own page, and so many pages at once."""

import hashlib
import hmac
import logging
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from http import HTTPStatus
from typing import TypeAlias
from urllib.parse import parse_qsl, urlencode, urlsplit

from websockets import Headers
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from higvf_console.ui.page.document import with_early_script

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

Handler: TypeAlias = Callable[[ServerConnection], Awaitable[None]]
RequestHandler: TypeAlias = Callable[[ServerConnection, Request], Response | None]


def own_origins(host: str, port: int) -> set[str]:
    """The origins of a page that this console itself serves."""
    names = {"localhost", "127.0.0.1", "[::1]", f"[{host}]" if ":" in host else host}
    return {f"{scheme}://{name}:{port}" for scheme in ("http", "https") for name in names}


@dataclass
class Door:
    """Lets pages in: login, origin, number."""

    port: int
    token: str
    max_clients: int
    origins: set[str]
    any_host: bool
    pages: int = 0

    def __post_init__(self) -> None:
        """Derives what the cookie is called and holds."""
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
        if response is None:
            return None
        response.headers.update(SECURITY_HEADERS)
        return with_early_script(response)

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
