"""Threads may push messages while viser's loop waits for them."""

import asyncio
import threading
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

from viser import _messages

from higvf_console.ui.page import guard
from higvf_console.ui.page.buffers import LoopEvent, SafeBuffer

Value = TypeVar("Value")


def run(coroutine: Coroutine[Any, Any, Value]) -> Value:
    """On a thread of its own: the browser of other tests has a loop that runs on this one."""
    with ThreadPoolExecutor(1) as executor:
        return executor.submit(asyncio.run, coroutine).result()


def test_an_event_is_set_by_its_loop_alone() -> None:
    async def woken() -> tuple[bool, bool]:
        loop = asyncio.get_running_loop()
        event = LoopEvent(loop)
        waiting = asyncio.create_task(event.wait())
        await asyncio.sleep(0)
        other = threading.Thread(target=event.set)
        other.start()
        other.join()
        early = event.is_set()
        await loop.run_in_executor(None, loop.call_soon_threadsafe, event.set)
        return early, await waiting

    assert run(woken()) == (False, True)


def test_what_another_thread_pushes_arrives() -> None:
    async def received() -> int:
        buffer = SafeBuffer(asyncio.get_running_loop(), persistent_messages=False)
        windows = buffer.window_generator(0)
        first = asyncio.create_task(anext(windows))
        await asyncio.sleep(0.05)
        assert not first.done()
        other = threading.Thread(target=buffer.push, args=(_messages.SetGuiPanelLabelMessage("Label"),))
        other.start()
        window = await asyncio.wait_for(first, 20.0)
        other.join()
        await windows.aclose()
        return len(window)

    assert run(received()) == 1


def test_a_console_uses_safe_buffers() -> None:
    server = guard.open_server("127.0.0.1", 0, guard.new_token(), "Console")
    try:
        assert type(server._websock_server.get_message_buffer()) is SafeBuffer  # pyright: ignore[reportPrivateUsage]
    finally:
        server.stop()
