"""The document that a page loads has our early scripts ahead of everything, however it is sent."""

import gzip

import pytest
from websockets import Headers
from websockets.http11 import Response

from higvf_console.ui.page.document import with_early_scripts

DOCUMENT = b"<!doctype html><html><head><meta charset='utf-8'><script>viser()</script></head></html>"


def response(body: bytes, kind: str, coding: str) -> Response:
    headers = Headers({"Content-Type": kind, "Content-Length": str(len(body)), "Content-Encoding": coding})
    return Response(200, "OK", headers, body)


@pytest.mark.parametrize("coding", ["identity", "gzip"])
def test_the_early_scripts_come_first(coding: str) -> None:
    body = gzip.compress(DOCUMENT) if coding == "gzip" else DOCUMENT
    answer = with_early_scripts(response(body, "text/html", coding))
    assert answer.headers.get_all("Content-Length") == [str(len(bytes(answer.body)))]
    text = gzip.decompress(bytes(answer.body)) if coding == "gzip" else bytes(answer.body)
    assert text.index(b"matchMedia") < text.index(b"viser()")
    assert text.index(b"higvf key") < text.index(b"viser()")


def test_what_is_no_document_is_left_alone() -> None:
    body = b"<head> in a picture"
    assert bytes(with_early_scripts(response(body, "image/png", "identity")).body) == body
