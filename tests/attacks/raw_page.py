"""A page without a browser: logs in by the link, speaks viser's frames, and keeps no rule of its own.

Frames are made ahead and written as one block of bytes, so that a flood costs the attacked process next to nothing.
"""

import base64
import contextlib
import http.client
import os
import re
import socket
import struct
import threading
from collections.abc import Iterable
from types import TracebackType
from typing import Any, NamedTuple, Self
from urllib.parse import urlsplit

import msgspec
import viser

PATIENCE = 60.0  # [s] for a busy machine
_PING, _PONG = 9, 10  # kinds of frames


class Login(NamedTuple):
    """What the link gives a browser."""

    cookie: str
    key: str


def log_in(url: str) -> Login:
    """The cookie that the link gives, and the key that its page keeps."""
    link = urlsplit(url)
    connection = http.client.HTTPConnection(link.hostname or "", link.port, timeout=PATIENCE)
    connection.request("GET", f"{link.path}?{link.query}")
    answer = connection.getresponse()
    key = re.search(r'setItem\(.*, "([\w-]+)"\)', answer.read().decode())
    assert key is not None, answer.status
    return Login(answer.headers["Set-Cookie"].split(";")[0], key[1])


def said(topic: str, **body: Any) -> bytes:
    """A message of a script of the page, as one frame."""
    return framed(msgspec.msgpack.encode({"type": "PageMessage", "topic": topic, "body": body}))


def message(kind: str, **fields: Any) -> bytes:
    """A message of viser's, as one frame."""
    return framed(msgspec.msgpack.encode({"type": kind, **fields}))


def framed(payload: bytes, code: int = 2) -> bytes:
    """A WebSocket frame of a client, masked with zeros: the payload stays as it is."""
    size = len(payload)
    if size < 126:
        head = struct.pack("!BB", 0x80 | code, 0x80 | size)
    elif size < 2**16:
        head = struct.pack("!BBH", 0x80 | code, 0x80 | 126, size)
    else:
        head = struct.pack("!BBQ", 0x80 | code, 0x80 | 127, size)
    return head + bytes(4) + payload


class RawPage:
    """One connection.

    Attributes:
        status: of the answer to its handshake; 101 = it is open.
        closed: set once the console has closed it.
        close_code: that the console gave; 0 = none.
    """

    def __init__(self, url: str, login: Login | None = None) -> None:
        """Opens it.

        Args:
            url: login link of the console.
            login: an earlier one; None = logs in.
        """
        link = urlsplit(url)
        login = log_in(url) if login is None else login
        self._socket = socket.create_connection((link.hostname, link.port or 80), timeout=PATIENCE)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [
            f"GET /?key={login.key} HTTP/1.1", f"Host: {link.netloc}", "Upgrade: websocket", "Connection: Upgrade",
            f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13", f"Origin: http://{link.netloc}",
            f"Sec-WebSocket-Protocol: viser-v{viser.__version__}", f"Cookie: {login.cookie}",
        ]  # fmt: skip
        self._socket.sendall("".join(f"{line}\r\n" for line in [*lines, ""]).encode())
        answer, _, rest = self._head().partition(b"\r\n\r\n")
        self.status = int(answer.split()[1])
        self.closed, self.close_code = threading.Event(), 0
        self._rest, self._sending = rest, threading.Lock()
        self._reader = threading.Thread(target=self._read, daemon=True)
        if self.status == 101:
            self._reader.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def send(self, *frames: bytes) -> None:
        """Writes frames at once; a connection that the console has closed takes none."""
        with contextlib.suppress(OSError), self._sending:
            self._socket.sendall(b"".join(frames))

    def hello(self, identity: str) -> None:
        """Says who it is."""
        self.send(said("hello", identity=identity))

    def stop(self, number: int) -> None:
        """Presses STOP."""
        self.send(said("key", name="stop", number=number))

    def close(self) -> None:
        """Hangs up."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def _head(self) -> bytes:
        head = b""
        while b"\r\n\r\n" not in head and (more := self._socket.recv(4096)):
            head += more
        return head

    def _read(self) -> None:
        """Takes what the console sends, looking at nothing but a close frame, and answers pings as browsers do."""
        waiting = self._rest
        with contextlib.suppress(OSError):
            self._socket.settimeout(None)
            while more := self._socket.recv(2**16):
                waiting = self._frames(waiting + more)
        self.closed.set()

    def _frames(self, content: bytes) -> bytes:
        """Reads whole frames; the rest is returned."""
        while len(content) >= 2:
            size, start = content[1] & 0x7F, 2
            if size == 126 and len(content) >= 4:
                size, start = struct.unpack("!H", content[2:4])[0], 4
            elif size == 127 and len(content) >= 10:
                size, start = struct.unpack("!Q", content[2:10])[0], 10
            elif size > 125:
                return content
            if len(content) < start + size:
                return content
            if content[0] & 0x0F == 8 and size >= 2:
                self.close_code = struct.unpack("!H", content[start : start + 2])[0]
            if content[0] & 0x0F == _PING:
                self.send(framed(content[start : start + size], _PONG))
            content = content[start + size :]
        return content


def strokes(count: int, points: int = 4, *, number: int = 1) -> bytes:
    """Frames of one stroke that begins and grows, and does not end."""
    phases = ["start", *["update"] * (count - 1)]
    line: list[float] = [600.0, 300.0] * points
    return b"".join(
        said("stroke", id=number, sequence=place, phase=phase, points=line, group=False)
        for place, phase in enumerate(phases)
    )


def joined(frames: Iterable[bytes]) -> bytes:
    """Frames as one block."""
    return b"".join(frames)
