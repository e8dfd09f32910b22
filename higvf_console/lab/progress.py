"""A progress bar on standard error."""

import sys
from typing import TextIO

_WIDTH = 40


class ProgressBar:
    """A one-line progress bar; draws nothing if the stream is not a terminal."""

    def __init__(self, title: str, total: int, stream: TextIO | None = None) -> None:
        """Draws the empty bar.

        Args:
            title: text before the bar.
            total: number of steps of the full bar.
            stream: output; None = standard error.
        """
        self._title, self._total, self._done = title, total, 0
        self._stream = sys.stderr if stream is None else stream
        self._draw("")

    def advance(self, steps: int) -> None:
        """Adds `steps` finished steps; ends the line after the last one."""
        self._done += steps
        self._draw("\n" if self._done >= self._total else "")

    def _draw(self, end: str) -> None:
        if self._stream.isatty():
            filled = _WIDTH * self._done // max(self._total, 1)
            bar = "#" * filled + "." * (_WIDTH - filled)
            self._stream.write(f"\r{self._title} [{bar}] {self._done}/{self._total}{end}")
            self._stream.flush()
