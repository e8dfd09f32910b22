"""The shipped configuration of nginx: path, WebSocket, cookie and TLS, tried with the real nginx."""

import http.client
import os
import shutil
import socket
import ssl
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from higvf_console.ui.page import guard
from tests.browser import NO_NGINX, wait_until

TOKEN = "the-token-of-a-test"
CONFIGURATION = Path(__file__).parents[3] / "docs" / "how-to" / "nginx-console.conf"


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    opened = guard.open_server("127.0.0.1", 0, TOKEN, "Proxied", origins=("https://lab.example",))
    yield opened
    opened.stop()


@pytest.fixture(scope="module")
def port(server: viser.ViserServer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    """At which nginx serves the console."""
    nginx = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")
    if nginx is None or shutil.which("openssl") is None:
        (pytest.fail if os.environ.get("HIGVF_REQUIRE_NGINX") == "1" else pytest.skip)(NO_NGINX)
    folder = tmp_path_factory.mktemp("nginx")
    certificate, key = folder / "lab.pem", folder / "lab.key"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=lab.example",
         "-keyout", key, "-out", certificate], check=True, capture_output=True,
    )  # fmt: skip
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
    text = CONFIGURATION.read_text(encoding="utf-8")
    for shipped, tried in (
        ("listen 443 ssl", f"listen 127.0.0.1:{number} ssl"),
        ("/etc/ssl/certs/lab.example.pem", str(certificate)),
        ("/etc/ssl/private/lab.example.key", str(key)),
        ("127.0.0.1:8080", f"127.0.0.1:{server.get_port()}"),
    ):
        assert text.count(shipped) == 1
        text = text.replace(shipped, tried)
    whole = folder / "nginx.conf"
    temporary = "".join(
        f"{kind}_temp_path {folder / kind};" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    whole.write_text(
        f"daemon off; pid {folder / 'pid'}; error_log {folder / 'errors'}; events {{}} http {{ {temporary} {text} }}",
        encoding="utf-8",
    )
    process = subprocess.Popen([nginx, "-p", folder, "-c", whole, "-e", folder / "errors"])
    try:
        with socket.socket() as probe:
            wait_until(lambda: process.poll() is not None or probe.connect_ex(("127.0.0.1", number)) == 0)
        assert process.poll() is None, (folder / "errors").read_text(encoding="utf-8")
        yield number
    finally:
        process.terminate()
        process.wait()


def trusting() -> ssl.SSLContext:
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    return context


def get(port: int, path: str, cookie: str = "") -> http.client.HTTPResponse:
    connection = http.client.HTTPSConnection("127.0.0.1", port, timeout=30, context=trusting())
    connection.request("GET", path, headers={"Host": "lab.example"} | ({"Cookie": cookie} if cookie else {}))
    return connection.getresponse()


def test_the_link_page_and_socket_work_under_the_path_of_nginx(port: int) -> None:
    answer = get(port, f"/console/?token={TOKEN}")
    assert answer.status == 200
    cookie = answer.headers["Set-Cookie"]
    assert "Path=/console/" in cookie
    assert "secure" in cookie.lower()
    key = answer.read().decode().partition(', "')[2].partition('"')[0]
    pair = cookie.split(";")[0]
    document = get(port, "/console/", pair)
    assert document.status == 200
    assert document.headers["X-Frame-Options"] == "SAMEORIGIN"
    assert get(port, "/console/").status == 401
    assert get(port, "/console?a=b").headers["Location"].endswith("/console/?a=b")
    for given, opens in ((key, True), ("wrong", False)):
        try:
            page = connect(
                f"wss://lab.example:{port}/console/?key={given}",
                sock=socket.create_connection(("127.0.0.1", port)),
                ssl=trusting(),
                origin="https://lab.example",  # pyright: ignore[reportArgumentType]
                subprotocols=[f"viser-v{viser.__version__}"],  # pyright: ignore[reportArgumentType]
                additional_headers={"Cookie": pair},
                max_size=None,
            )
        except InvalidStatus as refused:
            assert not opens, refused
        else:
            assert opens
            assert page.recv(timeout=30)
            page.close()
