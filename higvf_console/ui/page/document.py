"""The document that a page loads: viser's own, with a script of ours that must run ahead of it."""

import gzip
from functools import cache
from importlib.resources import files

from websockets.http11 import Response

_HEAD = b"<head>"


def with_early_script(response: Response) -> Response:
    """The response with `browser_js/early.js` at the top of its head; one that is no HTML document is left as it is.

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
    script = (files("higvf_console.ui.page") / "browser_js" / "early.js").read_bytes()
    document = document.replace(_HEAD, _HEAD + b"<script>" + script + b"</script>", 1)
    return gzip.compress(document, mtime=0) if zipped else document
