"""The socket of a page: what is left of it when it has ended."""

import asyncio
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest
from websockets.asyncio.server import ServerConnection

from higvf_console.ui.page.message_filter import FilteredConnection


def test_what_was_never_read_is_let_go_once_the_socket_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    unread, left = deque([b"frame"] * 100), list[int]()

    async def closed(_self: object, _code: int, _reason: str) -> None:
        left.append(len(unread))

    monkeypatch.setattr(ServerConnection, "close", closed)
    connection = FilteredConnection.__new__(FilteredConnection)
    monkeypatch.setattr(
        connection, "recv_messages", SimpleNamespace(frames=SimpleNamespace(queue=unread)), raising=False
    )
    monkeypatch.setattr(connection, "protocol", SimpleNamespace(), raising=False)
    with ThreadPoolExecutor(1) as executor:  # the browser of other tests has a loop that runs on this thread
        executor.submit(asyncio.run, connection.close()).result()
    assert left == [100], "not before its reader has ended"
    assert not unread
