"""A bar on standard error that shows how far a long study has come."""

import sys
from typing import TextIO

_WIDTH = 40


class ProgressBar:
    """Draws itself over its own line; on anything but a terminal it stays silent."""

    def __init__(self, title: str, total: int, stream: TextIO | None = None) -> None:
        """A bar that is full at `total` steps."""
        self._title, self._total, self._done = title, total, 0
        self._stream = sys.stderr if stream is None else stream
        self._draw("")

    def advance(self, steps: int) -> None:
        """Shows that `steps` more are done; ends the line with the last one."""
        self._done += steps
        self._draw("\n" if self._done >= self._total else "")

    def _draw(self, end: str) -> None:
        if self._stream.isatty():
            filled = _WIDTH * self._done // max(self._total, 1)
            bar = "#" * filled + "." * (_WIDTH - filled)
            self._stream.write(f"\r{self._title} [{bar}] {self._done}/{self._total}{end}")
            self._stream.flush()
