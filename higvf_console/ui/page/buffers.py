"""viser's queues of messages, made safe for threads that are not viser's own.

`AsyncMessageBuffer.push` of viser 1.1.1 sets an asyncio event on whatever thread it is called from, and then asks its
loop to set it again. asyncio allows the second only: the first walks through the tasks that wait, while the loop may
change them, and then raises in the panel that pushed.

Its loop over the messages for a new page counts through the numbers of all that there ever were, most of them replaced
since: after an hour some million, for which no other page, and no STOP, would be read for a second.
"""

import asyncio
from collections.abc import AsyncGenerator, Iterable, Sequence
from contextlib import suppress
from typing import Any

from viser.infra import _infra  # pyright: ignore[reportPrivateUsage]
from viser.infra._async_message_buffer import AsyncMessageBuffer
from viser.infra._messages import Message


class LoopEvent(asyncio.Event):
    """An event that its loop alone sets; on another thread, `set` leaves it to the loop, which viser asks as well."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        """Belongs to `loop`."""
        super().__init__()
        self._owner = loop

    def set(self) -> None:
        """Wakes all who wait, if called by the loop."""
        if asyncio._get_running_loop() is self._owner:  # pyright: ignore[reportPrivateUsage]
            super().set()


class SafeBuffer(AsyncMessageBuffer):
    """A buffer that any thread may push to, and a new page reads as fast after a day as after a minute."""

    def __init__(self, *args: Any, **options: Any) -> None:
        """As viser makes it."""
        super().__init__(*args, **options)
        self.message_event = LoopEvent(self.event_loop)

    async def _window_loop(
        self, client_id: int, backlog_last_id: int, backlog_done_message: Message | None
    ) -> AsyncGenerator[Sequence[Message], None]:
        """What viser's does, with `_window` in the place of its count.

        Args:
            client_id: the page.
            backlog_last_id: number of the last message that was there before it.
            backlog_done_message: follows that one; None = nothing does.
        """
        sent, marker = -1, backlog_done_message
        flushing = self.event_loop.create_task(self.flush_event.wait())
        self.generator_cursors[client_id] = sent
        try:
            while not self.done:
                last = self.message_counter - 1
                window, sent = self._window(client_id, sent, last if marker is None else min(last, backlog_last_id))
                self.generator_cursors[client_id] = sent
                if marker is not None and sent >= backlog_last_id and self.atomic_counter == 0:
                    window.append(marker)
                    marker = None
                if window:
                    yield window
                else:
                    await self.message_event.wait()
                    self.message_event.clear()
                if not window or self.message_counter - 1 == sent:
                    done, _ = await asyncio.wait([flushing], timeout=self.window_duration_sec)
                    if flushing in done and not self.done:
                        self.flush_event.clear()
                        flushing = self.event_loop.create_task(self.flush_event.wait())
        finally:
            self.generator_cursors.pop(client_id, None)
            flushing.cancel()
            with suppress(asyncio.CancelledError):
                await flushing

    def _window(self, client_id: int, sent: int, last: int) -> tuple[list[Message], int]:
        """The messages after number `sent`, up to `last` or as many as go at once, and the number up to which."""
        window: list[Message] = []
        for number in self._numbers(sent, last):
            if len(window) >= self.max_window_size or self.atomic_counter:
                return window, sent
            sent = number
            if self.persistent_messages:
                message = self.message_from_id.get(number)
            else:
                with self.buffer_lock:
                    message = self.pop_message_locked(number)
            if message is not None and message.excluded_self_client != client_id:
                window.append(message)
        return window, max(sent, last)

    def _numbers(self, sent: int, last: int) -> Iterable[int]:
        """Those after `sent`, up to `last`; of many, only those that are still there."""
        if last - sent <= len(self.message_from_id):
            return range(sent + 1, last + 1)
        return [number for number in list(self.message_from_id) if sent < number <= last]


def use_safe_buffers() -> None:
    """Lets servers and their connections use `SafeBuffer` from now on."""
    _infra.AsyncMessageBuffer = SafeBuffer  # pyright: ignore[reportPrivateImportUsage]
