"""viser's queues of messages, made safe for threads that are not viser's own.

`AsyncMessageBuffer.push` of viser 1.1.1 sets an asyncio event on whatever thread it is called from, and then asks its
loop to set it again. asyncio allows the second only: the first walks through the tasks that wait, while the loop may
change them, and then raises in the panel that pushed.
"""

import asyncio
from typing import Any

from viser.infra import _infra  # pyright: ignore[reportPrivateUsage]
from viser.infra._async_message_buffer import AsyncMessageBuffer


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
    """A buffer that any thread may push to."""

    def __init__(self, *args: Any, **options: Any) -> None:
        """As viser makes it."""
        super().__init__(*args, **options)
        self.message_event = LoopEvent(self.event_loop)


def use_safe_buffers() -> None:
    """Lets servers and their connections use `SafeBuffer` from now on."""
    _infra.AsyncMessageBuffer = SafeBuffer  # pyright: ignore[reportPrivateImportUsage]
