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

    def advance(self, steps: int, note: str = "") -> None:
        """Adds `steps` finished steps, with a note behind the count; ends the line after the last one."""
        self._done += steps
        self._draw("\n" if self._done >= self._total else "", note)

    def end(self) -> None:
        """Ends the line, if fewer steps were made than the bar has."""
        if self._done < self._total:
            self._draw("\n")

    def _draw(self, end: str, note: str = "") -> None:
        if self._stream.isatty():
            filled = _WIDTH * self._done // max(self._total, 1)
            bar = "#" * filled + "." * (_WIDTH - filled)
            text = f"{self._title} [{bar}] {self._done}/{self._total} {note}".rstrip()
            self._stream.write(f"\r{text}\x1b[K{end}")  # erases the rest of a longer line
            self._stream.flush()
