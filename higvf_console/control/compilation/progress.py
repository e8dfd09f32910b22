"""Tells who listens that a kernel is about to be compiled, since the cache does not hold it."""

from collections.abc import Callable, Generator
from contextlib import contextmanager

_listeners: list[Callable[[str], None]] = []


def compiling(name: str) -> None:
    """Tells all listeners which kernel is compiled next; what a listener raises ends the call of the kernel."""
    for listener in tuple(_listeners):
        listener(name)


def listen(listener: Callable[[str], None]) -> None:
    """Calls `listener` with the name of each kernel that is compiled from now on."""
    if listener not in _listeners:
        _listeners.append(listener)


@contextmanager
def listening(listener: Callable[[str], None]) -> Generator[None]:
    """The same for the time of a block."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)
