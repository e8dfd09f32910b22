"""What is being typed into fields: a page sends every key stroke, and a value that is half typed must never hold."""

import threading
import time
from collections.abc import Callable

TYPED_S = 0.7  # [s] without a key stroke, after which a value is meant


class Typed:
    """The latest value of each field that is being typed into; callable from any thread."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        """Starts with nothing typed; `now` is the clock [s]."""
        self._now, self._lock = now, threading.Lock()
        self._values: dict[str, tuple[float, object]] = {}

    def note(self, name: str, value: object) -> None:
        """A key stroke in the field `name` has made its value this one."""
        with self._lock:
            self._values[name] = (self._now(), value)

    def __contains__(self, name: object) -> bool:
        """Whether a field is still being typed into."""
        return name in self._values

    def meant(self) -> dict[str, object]:
        """The values whose typing has ended, each once."""
        with self._lock:
            due = [name for name, (at, _) in self._values.items() if self._now() - at >= TYPED_S]
            return {name: self._values.pop(name)[1] for name in due}
