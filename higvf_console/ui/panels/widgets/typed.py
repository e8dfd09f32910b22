"""What is being typed into fields: a page sends every key stroke, and a value that is half typed must never hold."""

import threading
import time
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

Field = TypeVar("Field", bound=Hashable)
Value = TypeVar("Value")
TYPED_S = 0.7  # [s] without a key stroke, after which a value is meant


class Typed(Generic[Field, Value]):
    """The latest value of each field that is being typed into; callable from any thread."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        """Starts with nothing typed; `now` is the clock [s]."""
        self._now, self._lock = now, threading.Lock()
        self._values: dict[Field, tuple[float, Value]] = {}

    def note(self, field: Field, value: Value) -> None:
        """A key stroke in a field has made its value this one."""
        with self._lock:
            self._values[field] = (self._now(), value)

    def __contains__(self, field: object) -> bool:
        """Whether a field is still being typed into."""
        return field in self._values

    def meant(self) -> dict[Field, Value]:
        """The values whose typing has ended, each once."""
        with self._lock:
            due = [field for field, (at, _) in self._values.items() if self._now() - at >= TYPED_S]
            return {field: self._values.pop(field)[1] for field in due}
