"""The documents that a page loads: what a visitor is told, the key that the link leaves, and viser's own document.

Scripts of ours run ahead of viser's: `browser_js/socket.js` hands in the key, `browser_js/early.js` sets the layout.
"""

import gzip
import json
from functools import cache
from importlib.resources import files

from websockets.http11 import Response

_TOLD = """<!doctype html><html lang="en"><meta charset="utf-8">
<meta name="viewport" content="width=device-width"><title>Console: {title}</title>
<style>body{{background:#14171c;color:#d7dce3;font:17px/1.6 system-ui,sans-serif;max-width:34em;margin:18vh auto;
padding:0 1.5em}}h1{{font-size:1.3em;color:#fff}}
code{{background:#242a33;border-radius:4px;padding:.1em .4em;white-space:nowrap}}</style>
<h1>{title}</h1>{text}</html>"""
_LINK = """<p>Whoever started the console was shown a link that ends in <code>?token=&hellip;</code>: please open that
link in this browser. It stays logged in until the browser is closed.</p>
<p>If the console was started again since then, it has printed a new link.</p>"""

NO_LOGIN = _TOLD.format(title="This console opens by its link", text=_LINK)
WRONG_TOKEN = _TOLD.format(title="The token of this link is not valid, or not any more", text=_LINK)
TOO_MANY_TRIES = _TOLD.format(
    title="Too many wrong tokens came from this address",
    text="<p>Please wait some seconds, then open the link again. Pages that are open are not concerned.</p>",
)
OTHER_NAME = _TOLD.format(
    title="This console is not served under this name",
    text="<p>Open it by the link that it printed when it was started. To serve it under a further name, start it with "
    "<code>--origin https://NAME</code>.</p>",
)

# The cookie is sent to every server of this host; what a page stores, no other server gets.
_STORE = "'higvf key ' + location.pathname.replace(/[^/]*$/, '')"
_WELCOME = f"""<!doctype html><html lang="en"><meta charset="utf-8"><title>Console</title>
<script>localStorage.setItem({_STORE}, %s); location.replace(%s);</script></html>"""
_HEAD = b"<head>"


def welcome_page(key: str, further: str) -> str:
    """The page that follows the link: it keeps the key of its login, and goes on to the address `further`."""
    return _WELCOME % tuple(json.dumps(text).replace("<", "\\u003c") for text in (key, further))


def with_early_scripts(response: Response) -> Response:
    """The response with our early scripts at the top of its head; one that is no HTML document is left as it is.

    Args:
        response: of viser's web server, as it is or compressed by gzip.
    """
    if "text/html" not in response.headers.get("Content-Type", ""):
        return response
    response.body = _scripted(bytes(response.body), response.headers.get("Content-Encoding") == "gzip")
    del response.headers["Content-Length"]
    response.headers["Content-Length"] = str(len(response.body))
    return response


@cache
def _scripted(body: bytes, zipped: bool) -> bytes:
    document = gzip.decompress(body) if zipped else body
    scripts = f"<script>({_source('socket')})({_STORE});</script><script>{_source('early')}</script>"
    document = document.replace(_HEAD, _HEAD + scripts.encode(), 1)
    return gzip.compress(document, mtime=0) if zipped else document


def _source(name: str) -> str:
    return (files("higvf_console.ui.page") / "browser_js" / f"{name}.js").read_text(encoding="utf-8").strip()
