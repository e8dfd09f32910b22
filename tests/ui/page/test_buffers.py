"""Threads may push messages while viser's loop waits for them."""

import asyncio
import threading
from collections.abc import Coroutine, Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
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


def label(text: str) -> _messages.Message:
    return _messages.SetGuiPanelLabelMessage(text)


def test_a_new_page_looks_at_what_is_there_not_at_all_that_ever_was() -> None:
    looked = list[int]()

    class Noting(dict[int, Any]):
        def get(self, key: int, default: Any = None) -> Any:
            looked.append(key)
            return super().get(key, default)

    async def first() -> list[str | None]:
        buffer = SafeBuffer(asyncio.get_running_loop(), persistent_messages=True)
        for turn in range(1000):
            buffer.push(label(f"{turn}"))
        buffer.message_from_id = Noting(buffer.message_from_id)
        windows = buffer.window_generator(0)
        window = await anext(windows)
        await windows.aclose()
        return [message.label for message in window if isinstance(message, _messages.SetGuiPanelLabelMessage)]

    assert run(first()) == ["999"], "each replaces the one before"
    assert looked == [999]


def test_a_page_gets_the_backlog_in_order_then_its_end_then_what_is_new() -> None:
    async def received() -> list[int]:
        buffer = SafeBuffer(asyncio.get_running_loop(), persistent_messages=True)
        scripts = [_messages.RunJavascriptMessage(f"{number}") for number in range(300)]
        for script in scripts:
            buffer.push(script)
            buffer.push(label("replaced"))
        end = _messages.RunJavascriptMessage("end")
        windows = buffer.window_generator(0, backlog_done_message=end)
        buffer.push(_messages.RunJavascriptMessage("new"))
        got, sizes = list[str](), list[int]()
        while "new" not in got:
            window = await asyncio.wait_for(anext(windows), 20.0)
            sizes.append(len(window))
            got += [message.source for message in window if isinstance(message, _messages.RunJavascriptMessage)]
        with buffer_held(buffer):
            buffer.push(_messages.RunJavascriptMessage("held"))
            waiting = asyncio.ensure_future(anext(windows))
            await asyncio.sleep(0.05)
            assert not waiting.done(), "not in the middle of an atomic block"
        assert [getattr(message, "source", "") for message in await asyncio.wait_for(waiting, 20.0)] == ["held"]
        await windows.aclose()
        assert not buffer.generator_cursors
        assert got == [*(script.source for script in scripts), "end", "new"]
        return sizes

    assert max(run(received())) <= 129, "and the marker"


@contextmanager
def buffer_held(buffer: SafeBuffer) -> Generator[None]:
    buffer.atomic_start()
    yield
    buffer.atomic_end()


def test_a_console_uses_safe_buffers() -> None:
    server = guard.open_server("127.0.0.1", 0, guard.new_token(), "Console")
    try:
        assert type(server._websock_server.get_message_buffer()) is SafeBuffer  # pyright: ignore[reportPrivateUsage]
    finally:
        server.stop()
