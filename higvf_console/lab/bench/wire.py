"""What a console sends to a page: a client without a screen that counts it and notes when the robots' marks move.

Wire format of viser 1.1.1, `viser.infra._infra`: two sizes, a compressed msgpack of messages, then the arrays that
these refer to, each at a multiple of 8 bytes.
"""

import threading
import time
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
from higvf_console.runtime.scheduling import go_first, stand_back

ROBOTS_NODE = "/team/robots"
_ALIGNMENT, _HEADER = 8, 16  # [bytes]
Positions = NDArray[np.float32]


class Frame(NamedTuple):
    """Where the robots' marks are from a moment on.

    Attributes:
        at: when the message arrived [s since the epoch].
        positions: (N, 3) [m].
    """

    at: float
    positions: Positions


class Watcher:
    """A page that only watches, reading as fast as the console sends.

    Attributes:
        received: bytes of all messages so far.
        messages: how many there were.
    """

    def __init__(self, url: str) -> None:
        """Connects.

        Args:
            url: the console's login link.

        Raises:
            HigvfError: the console does not answer as one.
        """
        self.received, self.messages = 0, 0
        self._frames: list[Frame] = []
        place = urlsplit(url).netloc
        go_first()  # with the threads that read: who measures must not wait for what is measured
        try:
            self._socket = connect(
                f"ws://{place}",
                origin=Origin(f"http://{place}"),
                subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
                additional_headers={"Cookie": _cookie(url)},
                compression=None,
                max_size=None,
            )
            self._thread = threading.Thread(target=self._read, name="watcher", daemon=True)
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
                    if (positions := robots_in(message)) is not None:
                        self._frames.append(Frame(now, positions))
        except ConnectionClosed:
            return

    def frames(self) -> tuple[Frame, ...]:
        """All frames since the last `forget`, oldest first."""
        return tuple(self._frames)

    def forget(self) -> None:
        """Drops all frames but the newest."""
        del self._frames[:-1]

    def close(self) -> None:
        """Hangs up."""
        self._socket.close()
        self._thread.join()


def _cookie(url: str) -> str:
    """The cookie that the login link gives."""
    parts = urlsplit(url)
    link = HTTPConnection(parts.netloc, timeout=10.0)
    try:
        link.request("GET", f"{parts.path}?{parts.query}")
        found = link.getresponse().headers.get("Set-Cookie")
    finally:
        link.close()
    if found is None:
        raise HigvfError(f"{url}: no console lets anybody in by this link")
    return found.split(";")[0]


def robots_in(message: bytes) -> Positions | None:
    """Positions (N, 3) [m] of the robots' marks in a message; None = it does not move them."""
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
    """Where an array begins in a message whose compressed part ends at `end`."""
    for length in lengths[:index]:
        end = -(-end // _ALIGNMENT) * _ALIGNMENT + length
    return -(-end // _ALIGNMENT) * _ALIGNMENT


def first_motion(frames: tuple[Frame, ...], after: float) -> float | None:
    """When the robots' marks first moved after a moment [s since the epoch]; None = they have not yet."""
    rest: Positions | None = None
    for at, positions in frames:
        if at <= after or rest is None:
            rest = positions
        elif not np.array_equal(positions, rest):
            return at
    return None
