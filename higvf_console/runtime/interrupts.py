"""Ctrl-C between two control periods: raised while compiled code makes its results, it would crash the process."""

import signal
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def held_back() -> Generator[Callable[[], None]]:
    """Keeps a Ctrl-C until the function that this gives is called, or the end; a second one is raised at once.

    Outside the main thread, which alone is interrupted, and where interrupts are ignored or somebody else's, nothing
    changes.

    Raises:
        KeyboardInterrupt: from that function, or at the end.
    """
    asked = False

    def note(_number: int, _frame: FrameType | None) -> None:
        nonlocal asked
        if asked:
            raise KeyboardInterrupt
        asked = True

    def give() -> None:
        if asked:
            raise KeyboardInterrupt

    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not usual or threading.current_thread() is not threading.main_thread():
        yield give
        return
    signal.signal(signal.SIGINT, note)
    try:
        yield give
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    give()
