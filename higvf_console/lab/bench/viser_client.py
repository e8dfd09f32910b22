"""A headless viser client: counts the traffic of a console, records when the robot markers move, and sends messages.

The wire format is that of viser 1.1.1, `viser.infra._infra`: two sizes, a compressed msgpack of messages, then the
arrays that the messages refer to, each aligned to 8 bytes.
"""

import re
import threading
import time
from contextlib import suppress
from http.client import HTTPConnection
from typing import Any, NamedTuple
from urllib.parse import urlsplit

import msgspec.msgpack
import numpy as np
import viser
import zstandard
from numpy.typing import NDArray
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from higvf_console.core.errors import HigvfError
from higvf_console.runtime.background.scheduling import go_first, stand_back

ROBOTS_NODE = "/team/robots"
_ALIGNMENT, _HEADER = 8, 16  # [bytes]
Positions = NDArray[np.float32]


class Frame(NamedTuple):
    """Positions of the robot markers in one message.

    Attributes:
        at: time of arrival [s since the epoch].
        positions: (N, 3) [m].
    """

    at: float
    positions: Positions


class ViserClient:
    """A client that reads as fast as the console sends.

    Attributes:
        received: bytes received so far.
        messages: messages received so far.
    """

    def __init__(self, url: str, *, positions: bool = True) -> None:
        """Connects to a console.

        Args:
            url: login link of the console.
            positions: whether to decode what comes and keep the positions of the robots, before all other programs.

        Raises:
            HigvfError: the server does not accept the login link.
        """
        self.received, self.messages = 0, 0
        self._frames: list[Frame] = []
        self._positions = positions
        place, (cookie, key) = urlsplit(url).netloc, _login(url)
        if positions:
            go_first()  # raises the priority of the reading thread, so that the measured load does not delay it
        try:
            self._socket = connect(
                f"ws://{place}/?key={key}",
                origin=Origin(f"http://{place}"),
                subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
                additional_headers={"Cookie": cookie},
                compression=None,
                max_size=None,
            )
            self._thread = threading.Thread(target=self._read, name="viser-client", daemon=True)
            self._thread.start()
        finally:
            stand_back()

    def _read(self) -> None:
        try:
            for message in self._socket:
                now = time.time()
                if isinstance(message, bytes):
                    self.received += len(message)
                    self.messages += 1
                    if self._positions and (positions := robots_in(message)) is not None:
                        self._frames.append(Frame(now, positions))
        except ConnectionClosed:
            return

    @property
    def closed(self) -> bool:
        """Whether the connection has ended."""
        return not self._thread.is_alive()

    def say(self, topic: str, **body: Any) -> None:
        """Sends a message as a script of the page does; nothing where the connection has ended."""
        with suppress(ConnectionClosed):
            self._socket.send(msgspec.msgpack.encode({"type": "PageMessage", "topic": topic, "body": body}))

    def frames(self) -> tuple[Frame, ...]:
        """All frames since the last `forget`, oldest first."""
        return tuple(self._frames)

    def forget(self) -> None:
        """Drops all frames except the newest."""
        del self._frames[:-1]

    def close(self) -> None:
        """Closes the connection."""
        self._socket.close()
        self._thread.join()


def _login(url: str) -> tuple[str, str]:
    """The cookie that the login link sets, and the key that its page keeps."""
    parts = urlsplit(url)
    link = HTTPConnection(parts.netloc, timeout=10.0)
    try:
        link.request("GET", f"{parts.path}?{parts.query}")
        answer = link.getresponse()
        cookie, key = answer.headers.get("Set-Cookie"), re.search(r'setItem\(.*, "([\w-]+)"\)', answer.read().decode())
    finally:
        link.close()
    if cookie is None or key is None:
        raise HigvfError(f"{url}: the server does not accept this login link")
    return cookie.split(";")[0], key[1]


def robots_in(message: bytes) -> Positions | None:
    """Positions (N, 3) [m] of the robot markers in a message; None if it holds none."""
    size = int.from_bytes(message[8:16], "little")
    body: dict[str, Any] = msgspec.msgpack.decode(
        zstandard.ZstdDecompressor().decompress(message[_HEADER : _HEADER + size])
    )
    found: Positions | None = None
    for entry in body["messages"]:
        moved = entry.get("updates", {}).get("batched_positions") if entry.get("name") == ROBOTS_NODE else None
        if moved is not None:
            start = _start(body["binaryBufferLengths"], moved["__binary_index"], _HEADER + size)
            length = body["binaryBufferLengths"][moved["__binary_index"]]
            found = np.frombuffer(message[start : start + length], np.dtype(moved["dtype"])).reshape(-1, 3)
    return found


def _start(lengths: list[int], index: int, end: int) -> int:
    """Offset of array `index` in a message whose compressed part ends at `end`."""
    for length in lengths[:index]:
        end = -(-end // _ALIGNMENT) * _ALIGNMENT + length
    return -(-end // _ALIGNMENT) * _ALIGNMENT


def first_motion(frames: tuple[Frame, ...], after: float) -> float | None:
    """Time at which the robot markers first moved after `after` [s since the epoch]; None if they have not moved."""
    rest: Positions | None = None
    for at, positions in frames:
        if at <= after or rest is None:
            rest = positions
        elif not np.array_equal(positions, rest):
            return at
    return None
