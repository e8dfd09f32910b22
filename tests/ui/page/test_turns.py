"""Sockets take turns: what one page has sent, however much, holds up no other page."""

import asyncio
import base64
import gc
import logging
import socket
import weakref
from collections.abc import AsyncGenerator, Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from typing import Any

import pytest
from websockets.asyncio.server import serve
from websockets.exceptions import ConnectionClosed

from higvf_console.ui.page import message_filter
from higvf_console.ui.page.message_filter import PIECE_READ, FilteredConnection, FilterSettings, filtering
from higvf_console.ui.page.pace import Limits
from tests.attacks.raw_page import framed, said

PICK, STOP = said("key", name="pick_1", number=0), said("key", name="stop", number=7)
SEVERAL = 8  # turns of the loop that a frame may take from the socket to its reader
PATIENT = Limits(messages=1e6, messages_at_once=1e6)


class Site:
    """A server of such sockets in a loop, with clients that write without waiting."""

    def __init__(self) -> None:
        self.passed: list[list[bytes]] = []
        self.connections: list[FilteredConnection] = []
        self.port = 0

    async def read(self, connection: Any) -> None:
        number = len(self.connections)
        self.connections.append(connection)
        self.passed.append([])
        while True:
            try:
                self.passed[number].append(await connection.recv())
            except ConnectionClosed:
                return

    async def page(self) -> socket.socket:
        """Opens a socket; the loop runs meanwhile."""
        number = len(self.connections)
        page = socket.create_connection(("127.0.0.1", self.port))
        page.setblocking(False)
        key = base64.b64encode(bytes(16)).decode()
        head = f"GET / HTTP/1.1\r\nHost: localhost:{self.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        page.send(f"{head}Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        await until(lambda: len(self.connections) > number)
        return page


async def until(reached: Callable[[], object]) -> None:
    async with asyncio.timeout(60.0):
        while not reached():
            await asyncio.sleep(0)


@asynccontextmanager
async def site(limits: Limits) -> AsyncGenerator[Site]:
    made = Site()
    of: Any = filtering(FilterSettings(limits=limits))
    logger = logging.getLogger("test of turns")
    async with serve(made.read, "127.0.0.1", 0, create_connection=of, compression=None, logger=logger) as server:
        made.port = next(iter(server.sockets)).getsockname()[1]
        yield made


def run(test: Callable[[], Awaitable[None]]) -> None:
    """On a thread of its own: the browser of other tests has a loop that runs on this one."""
    with ThreadPoolExecutor(1) as executor:
        executor.submit(asyncio.run, test()).result()  # pyright: ignore[reportArgumentType]


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> dict[FilteredConnection, int]:
    """Frames that were parsed, by socket."""
    counts: dict[FilteredConnection, int] = {}
    process = FilteredConnection.process_event

    def counted(connection: FilteredConnection, event: Any) -> None:
        counts[connection] = counts.get(connection, 0) + 1
        process(connection, event)

    monkeypatch.setattr(FilteredConnection, "process_event", counted)
    return counts


def test_a_stop_waits_for_a_few_pieces_of_a_flood_not_for_all_of_it(parsed: dict[FilteredConnection, int]) -> None:
    async def test() -> None:
        async with site(Limits()) as made:
            flooders = [await made.page() for _ in range(3)]
            honest = await made.page()
            before = sum(parsed.values())
            sent = sum(flooder.send(PICK * 2000) for flooder in flooders) // len(PICK)
            assert sent > 2000
            honest.send(STOP)
            await until(lambda: made.passed[3])
            assert sum(parsed.values()) - before <= 3 * SEVERAL * -(-PIECE_READ // len(PICK))

    run(test)


def test_all_that_was_sent_arrives_in_order_whatever_its_size() -> None:
    frames = [said("file", kind="scenario", name="x", size=1, part=n, parts=9, content="A" * 100 * n) for n in range(9)]

    async def test() -> None:
        async with site(PATIENT) as made:
            page = await made.page()
            page.send(b"".join(frames))
            page.send(STOP)
            page.shutdown(socket.SHUT_WR)  # the end comes behind it
            await until(lambda: len(made.passed[0]) == len(frames) + 1)
            assert [framed(frame) for frame in made.passed[0]] == [*frames, STOP]

    run(test)


def test_no_more_is_read_while_there_is_something_to_parse(monkeypatch: pytest.MonkeyPatch) -> None:
    longest: list[int] = []
    take_turn = FilteredConnection._take_turn  # pyright: ignore[reportPrivateUsage]

    def noted(connection: FilteredConnection) -> None:
        longest.append(len(connection._unparsed))  # pyright: ignore[reportPrivateUsage]
        take_turn(connection)

    monkeypatch.setattr(FilteredConnection, "_take_turn", noted)

    async def test() -> None:
        async with site(PATIENT) as made:
            page = await made.page()
            left = memoryview(PICK * 20_000)
            while left:
                try:
                    left = left[page.send(left) :]
                except BlockingIOError:
                    await asyncio.sleep(0)
            await until(lambda: len(made.passed[0]) == 20_000)

    run(test)
    assert max(longest) <= 2**18, "what the transport reads at once"


@pytest.mark.parametrize(
    "frame", [framed(b"", 9), framed(b"", 10), b"\x00\x80" + bytes(4)], ids=["ping", "pong", "part"]
)
def test_a_page_that_floods_with_what_no_reader_sees_is_cut_off(frame: bytes, caplog: pytest.LogCaptureFixture) -> None:
    first = bytes([0x02]) + framed(b"")[1:]  # a message begins, and does not end

    async def test() -> None:
        async with site(Limits(messages=10.0, messages_at_once=20.0)) as made:
            page = await made.page()
            page.send((first if frame[0] == 0 else b"") + frame * 99)
            await asyncio.sleep(0.05)
            assert made.connections[0].close_code is None
            page.send(frame * 1000)
            await until(lambda: made.connections[0].protocol.close_rcvd or made.connections[0].protocol.close_sent)
            assert made.connections[0].protocol.close_sent is not None
            assert made.connections[0].protocol.close_sent.code == 1008
            page.close()

    run(test)
    assert not [record for record in caplog.records if record.name == "asyncio"], "no task failed"


def test_a_page_that_was_cut_off_leaves_nothing_for_the_garbage_collector() -> None:
    async def test() -> None:
        async with site(Limits(messages=10.0, messages_at_once=20.0)) as made:
            page = await made.page()
            page.send(PICK * 1000)
            left = weakref.ref(made.connections[0])
            await until(lambda: made.connections[0].protocol.close_sent)
            page.close()
            await until(made.connections[0].connection_lost_waiter.done)
            made.connections.clear()
            gc.disable()
            try:
                await until(lambda: left() is None)
            finally:
                gc.enable()

    run(test)


def test_a_piece_is_small_beside_what_a_transport_reads_at_once() -> None:
    assert 16 * message_filter.PIECE_READ <= 2**18
