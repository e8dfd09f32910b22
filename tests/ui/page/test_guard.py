"""Only an operator with the printed link reaches the console, and only honest messages come through."""

import contextlib
import gzip
import http.client
import re
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import msgspec
import pytest
import viser
from playwright.sync_api import Browser, Page
from websockets.exceptions import ConnectionClosed, ConnectionClosedError, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from higvf_console.core.errors import ConsoleError
from higvf_console.core.limiter import Limiter
from higvf_console.ui.page import guard
from higvf_console.ui.page.access import Access, Role, access_by
from higvf_console.ui.page.door import SECURITY_HEADERS, TRIES_AT_ONCE
from higvf_console.ui.page.message_filter import settings_of
from tests.attacks.raw_page import Login, log_in
from tests.browser import SLOW_SCREEN, Stage, open_stage, screenshot, wait_until

TOKEN = "a token with; odd characters"


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    opened = guard.open_server("127.0.0.1", 0, TOKEN, "Guarded", max_clients=2)
    settings_of(opened).refusals._limiter = Limiter(every=0.0)  # pyright: ignore[reportPrivateUsage] (each test sees its own)
    yield opened
    opened.stop()


def get(
    server: viser.ViserServer, path: str, cookie: str = "", *, host: str = "", packed: bool = False
) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=10)
    headers = {"Cookie": cookie, "Host": host, "Accept-Encoding": "gzip" if packed else ""}
    connection.request("GET", path, headers={name: value for name, value in headers.items() if value})
    return connection.getresponse()


def logged_in(server: viser.ViserServer) -> Login:
    return log_in(guard.login_url(server, TOKEN))


def open_socket(
    server: viser.ViserServer, login: Login, origin: str | None = "own", host: str | None = None
) -> ClientConnection:
    port = server.get_port()
    return connect(
        f"ws://{host or '127.0.0.1'}:{port}/?key={login.key}",
        sock=socket.create_connection(("127.0.0.1", port)),
        origin=f"http://127.0.0.1:{port}" if origin == "own" else origin,  # pyright: ignore[reportArgumentType]
        subprotocols=["viser-v1.1.1"],  # pyright: ignore[reportArgumentType]
        additional_headers={"Cookie": login.cookie},
    )


def frame(**message: Any) -> bytes:
    return msgspec.msgpack.encode(message)


def uuid_of(widget: Any) -> str:
    return widget._impl.uuid


def test_without_the_link_every_request_is_answered_401_in_words(server: viser.ViserServer) -> None:
    for path in ("/", "/index.html", "/?token=wrong", "/?token=", "/nothing"):
        answer = get(server, path)
        assert answer.status == 401, path
        text = " ".join(answer.read().decode().split())
        assert "open that link in this browser" in text
        assert ("not valid" in text) is ("wrong" in path)


def test_the_link_logs_in_and_drops_the_token_from_the_address(server: viser.ViserServer) -> None:
    link = urlsplit(guard.login_url(server, TOKEN))
    answer = get(server, f"{link.path}?{link.query}")
    assert answer.status == 200
    text = answer.read().decode()
    assert 'location.replace("./")' in text
    assert TOKEN not in text
    cookie = answer.headers["Set-Cookie"]
    assert cookie.startswith(f"higvf_{server.get_port()}=")
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
    page = get(server, "/", cookie.split(";")[0])
    assert page.status == 200
    assert "<!doctype html>" in page.read().decode().lower()[:100]


def test_further_words_of_the_link_stay_in_the_address_and_run_no_script(server: viser.ViserServer) -> None:
    link = urlsplit(guard.login_url(server, TOKEN))
    text = get(server, f"{link.path}?{link.query}&a=%3C/script%3E&b=%22").read().decode()
    assert 'location.replace("./?a=%3C%2Fscript%3E&b=%22")' in text


def test_the_page_hands_in_a_key_that_only_the_link_gives(server: viser.ViserServer) -> None:
    login = logged_in(server)
    for path, packed in (("/", False), ("/index.html", False), ("/", True)):
        answer = get(server, path, login.cookie, packed=packed)
        body = answer.read()
        assert len(body) == int(answer.headers["Content-Length"])
        text = (gzip.decompress(body) if packed else body).decode()
        assert "set_server" in text.partition("</script>")[0]
        assert login.key not in text
    for key in ("", "wrong", logged_in(server).key):
        with pytest.raises(InvalidStatus, match="401"):
            open_socket(server, login._replace(key=key))


def test_a_page_without_its_key_is_sent_to_the_login_page(server: viser.ViserServer) -> None:
    assert get(server, "/?login=1", logged_in(server).cookie).status == 401


@pytest.mark.parametrize("path", ["/", "/nothing", "/../etc/passwd", "/?token=wrong"])
def test_every_answer_has_the_security_headers(server: viser.ViserServer, path: str) -> None:
    headers = get(server, path, logged_in(server).cookie).headers
    for name, value in SECURITY_HEADERS.items():
        assert headers.get_all(name) == [value], name


def test_an_error_of_our_own_has_them_too(server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("on purpose")

    monkeypatch.setattr(Access, "login", fail)
    answer = get(server, "/")
    assert answer.status == 500
    assert answer.headers["X-Frame-Options"] == SECURITY_HEADERS["X-Frame-Options"]
    assert "on purpose" not in answer.read().decode()


def test_a_name_that_was_pointed_at_this_machine_is_refused(server: viser.ViserServer) -> None:
    port = server.get_port()
    answer = get(server, "/", host=f"evil.example:{port}")
    assert answer.status == 421
    assert "--origin" in answer.read().decode()
    assert get(server, "/", host=f"localhost:{port}").status == 401
    assert get(server, "/", host="127.0.0.1:1").status == 421


def test_wrong_tokens_of_an_address_are_slowed_and_logged_in_one_line(caplog: pytest.LogCaptureFixture) -> None:
    server = guard.open_server("127.0.0.1", 0, TOKEN, "Guessed at")
    answers = [get(server, f"/?token={number}").status for number in range(2 * TRIES_AT_ONCE)]
    assert answers[:TRIES_AT_ONCE] == [401] * TRIES_AT_ONCE
    assert 429 in answers[TRIES_AT_ONCE:]
    assert len([text for text in caplog.messages if "token" in text]) == 1
    server.stop()


def test_an_origin_that_was_given_opens_the_console_under_its_name() -> None:
    server = guard.open_server("127.0.0.1", 0, TOKEN, "Proxied", origins=("https://lab.example",))
    login = logged_in(server)
    assert get(server, "/", login.cookie, host="lab.example").status == 200
    with open_socket(server, login, "https://lab.example", "127.0.0.1"):
        pass
    server.stop()
    with pytest.raises(ConsoleError, match=r"--origin lab\.example: expected scheme and host"):
        guard.open_server("127.0.0.1", 0, TOKEN, "Wrong", origins=("lab.example",))


def test_a_certificate_that_cannot_be_used_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ConsoleError, match=r"--certfile .*cannot be used"):
        guard.open_server("127.0.0.1", 0, TOKEN, "Wrong", certificate=(tmp_path / "no.pem", tmp_path / "no.key"))


def test_a_revoked_login_closes_its_pages(tmp_path: Path) -> None:
    access = access_by(tmp_path / "tokens")
    server = guard.open_server("127.0.0.1", 0, access, "Revoked")
    login = log_in(guard.login_url(server, access.token(Role.OPERATOR)))
    with open_socket(server, login) as page:
        (tmp_path / "tokens").write_text(f"observer {access.token(Role.OBSERVER)}\n", encoding="utf-8")
        access.refresh()
        with pytest.raises(ConnectionClosed, match=r"1008.*revoked"):
            while True:
                page.recv(timeout=10)
    assert get(server, "/", login.cookie).status == 401
    server.stop()


def test_a_page_may_not_be_framed_cached_or_fed_by_other_sites(server: viser.ViserServer) -> None:
    headers = get(server, "/", logged_in(server).cookie).headers
    assert headers["X-Frame-Options"] == "SAMEORIGIN"
    assert headers["Cache-Control"] == "no-store"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert "default-src 'self'" in headers["Content-Security-Policy"]


def test_the_cookie_of_one_console_does_not_open_another(server: viser.ViserServer) -> None:
    name, _, value = logged_in(server).cookie.partition("=")
    assert get(server, "/", f"{name}_other={value}").status == 401
    assert get(server, "/", f"{name}={value[::-1]}").status == 401
    assert get(server, "/", f"higvf_1=elsewhere; {name}={value}").status == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "http://localhost:1", "null", None])
def test_a_page_of_another_origin_is_refused(server: viser.ViserServer, origin: str | None) -> None:
    with pytest.raises(InvalidStatus, match="403"):
        open_socket(server, logged_in(server), origin)


def test_a_socket_without_login_is_refused(server: viser.ViserServer) -> None:
    with pytest.raises(InvalidStatus, match="401"):
        open_socket(server, Login("", ""))


def test_a_login_has_half_of_the_seats_and_others_find_one(server: viser.ViserServer) -> None:
    first, second = logged_in(server), logged_in(server)
    with open_socket(server, first):
        with pytest.raises(InvalidStatus, match="503"):
            open_socket(server, first)
        with open_socket(server, second), pytest.raises(InvalidStatus, match="503"):
            open_socket(server, logged_in(server))
        wait_until(lambda: _opens(server, second))


def test_observers_leave_seats_to_those_who_steer(tmp_path: Path) -> None:
    access = access_by(tmp_path / "tokens")
    server = guard.open_server("127.0.0.1", 0, access, "Watched", max_clients=4)
    observer, operator = (guard.login_url(server, access.token(role)) for role in (Role.OBSERVER, Role.OPERATOR))
    with contextlib.ExitStack() as pages:
        for _ in range(3):
            pages.enter_context(open_socket(server, log_in(observer)))
        with pytest.raises(InvalidStatus, match="503"):
            open_socket(server, log_in(observer))
        pages.enter_context(open_socket(server, log_in(operator)))
    server.stop()


def _opens(server: viser.ViserServer, login: Login) -> bool:
    with contextlib.suppress(InvalidStatus), open_socket(server, login):
        return True
    return False


DISHONEST: dict[str, Callable[[str], bytes | str]] = {
    "a silenced widget": lambda uuid: frame(type="GuiUpdateMessage", uuid=uuid, updates={"update_cb": []}),
    "a removed widget": lambda uuid: frame(type="GuiUpdateMessage", uuid=uuid, updates={"removed": True, "value": 2.0}),
    "an empty update": lambda uuid: frame(type="GuiUpdateMessage", uuid=uuid, updates={}),
    "updates that are no mapping": lambda uuid: frame(type="GuiUpdateMessage", uuid=uuid, updates=[["value", 1]]),
    "the share tunnel": lambda _: frame(type="ShareUrlRequest"),
    "a script": lambda _: frame(type="RunJavascriptMessage", source="alert(1)"),
    "a file": lambda uuid: frame(
        type="FileTransferStartUpload", source_component_uuid=uuid, transfer_uuid="t", filename="f", mime_type="m",
        part_count=1, size_bytes=1,
    ),
    "an unknown type": lambda _: frame(type="Nonsense"),
    "a missing field": lambda uuid: frame(type="GuiUpdateMessage", uuid=uuid),
    "no type": lambda uuid: frame(uuid=uuid),
    "no mapping": lambda _: msgspec.msgpack.encode([1, 2]),
    "no msgpack": lambda _: b"\xc1\xc1",
    "nothing": lambda _: b"",
    "text": lambda _: "hello",
}  # fmt: skip


@pytest.mark.parametrize("name", DISHONEST)
def test_a_dishonest_message_is_dropped_and_the_connection_goes_on(
    server: viser.ViserServer, name: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    tunnels: list[viser.ViserServer] = []
    monkeypatch.setattr(viser.ViserServer, "request_share_url", tunnels.append)  # never a real one from a test
    widget = server.gui.add_number("number", 1.0)
    with open_socket(server, logged_in(server)) as page:
        page.send(DISHONEST[name](uuid_of(widget)))
        page.send(frame(type="GuiUpdateMessage", uuid=uuid_of(widget), updates={"value": 7.0}))
        wait_until(lambda: widget.value == 7.0)
    assert "refused from" in caplog.text
    assert tunnels == []
    widget.remove()


def test_a_frame_beyond_two_megabytes_closes_the_connection(server: viser.ViserServer) -> None:
    with open_socket(server, logged_in(server)) as page:
        page.send(b"\0" * (guard.MAX_FRAME_BYTES + 1))
        with pytest.raises(ConnectionClosedError, match="1009"):
            while True:
                page.recv(timeout=10)


def test_a_busy_port_is_an_error_that_names_it_and_the_choice(server: viser.ViserServer) -> None:
    port = server.get_port()
    with pytest.raises(ConsoleError, match=rf"port {port} on 127.0.0.1 is busy.*--port"):
        guard.open_server("127.0.0.1", port, TOKEN, "Second")


@pytest.mark.parametrize(
    ("host", "port", "message"),
    [
        ("203.0.113.7", 0, "203.0.113.7 is not an address of this machine.*--host"),
        ("no-such-host.invalid", 0, "'no-such-host.invalid' is not known.*--host"),
        ("x" * 80, 0, "is not known.*--host"),
        ("127.0.0.1", 65536, "port 65536 does not exist.*--port"),
        ("127.0.0.1", -1, "port -1 does not exist.*--port"),
    ],
)
def test_an_address_that_cannot_be_served_is_an_error_and_not_a_hang(host: str, port: int, message: str) -> None:
    with pytest.raises(ConsoleError, match=message):
        guard.open_server(host, port, TOKEN, "Nowhere")


def test_an_empty_token_is_refused() -> None:
    with pytest.raises(ConsoleError, match="token"):
        guard.open_server("127.0.0.1", 0, "", "Open to all")


def test_another_viser_is_refused_by_its_version(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viser, "__version__", "9.9.9")
    with pytest.raises(ConsoleError, match=re.escape("viser 9.9.9 is installed")) as error:
        guard.open_server("127.0.0.1", 0, TOKEN, "Other")
    assert "pip install viser==1.1.1" in str(error.value)


def test_a_stopped_console_leaves_its_port_free() -> None:
    first = guard.open_server("127.0.0.1", 0, TOKEN, "First")
    port = first.get_port()
    first.stop()
    with socket.socket() as probe:
        wait_until(lambda: probe.connect_ex(("127.0.0.1", port)) != 0)
    second = guard.open_server("127.0.0.1", port, TOKEN, "Second")
    assert second.get_port() == port
    second.stop()


def test_viser_prints_no_address_that_lacks_the_token(capsys: pytest.CaptureFixture[str]) -> None:
    guard.open_server("127.0.0.1", 0, TOKEN, "Quiet").stop()
    assert "http" not in capsys.readouterr().out


@pytest.mark.browser
def test_a_browser_without_the_link_is_told_what_to_do(chromium: Browser, stage: Stage) -> None:
    context = chromium.new_context()
    page = context.new_page()
    page.goto(stage.url.partition("?")[0])
    assert "open that link" in page.locator("body").inner_text()
    context.close()


@pytest.mark.browser
def test_a_page_that_is_refused_a_socket_says_why(chromium: Browser) -> None:
    stage = open_stage(max_clients=2)
    context = chromium.new_context()
    context.add_init_script(SLOW_SCREEN)
    first, second = context.new_page(), context.new_page()
    first.goto(stage.url)
    wait_until(lambda: len(stage.server.get_clients()) == 1)
    second.goto(stage.url)
    told = second.locator("p[role=alert]")
    told.wait_for()
    assert "This login has as many pages as it may have" in told.inner_text()
    screenshot(second, "no-seat")
    first.close()
    told.wait_for(state="detached")
    access = settings_of(stage.server).access
    assert access is not None
    access.log_out(next(iter(access._logins.values())), "on purpose")  # pyright: ignore[reportPrivateUsage]
    told.wait_for()
    wait_until(lambda: told.inner_text() == "The login of this page has ended: open the console by its link again.")
    context.close()
    stage.server.stop()


@pytest.mark.browser
def test_a_button_that_a_page_tried_to_silence_still_works(page: Page, stage: Stage) -> None:
    pressed: list[int] = []

    @stage.button.on_click
    async def _(event: viser.GuiEvent[viser.GuiButtonHandle]) -> None:
        pressed.append(event.client_id or 0)

    page.evaluate(
        """([uuid, updates]) => updates.forEach((update) =>
        window.__viserMutable.sendMessage({ type: "GuiUpdateMessage", uuid, updates: update }))""",
        [uuid_of(stage.button), [{"update_cb": []}, {"removed": True}]],
    )
    page.get_by_role("button", name="button", exact=True).click()
    wait_until(lambda: pressed)
