"""Pages without a browser that stay open for long: one in control, and those that watch."""

import time
from collections.abc import Iterator
from contextlib import ExitStack
from types import TracebackType
from typing import Self

from higvf_console.core.arrays import Floats
from higvf_console.core.errors import HigvfError
from higvf_console.lab.bench.viser_client import ViserClient
from higvf_console.runtime.history import KEPT

STROKE_EVERY = 5  # turns
AHEAD = 3 * KEPT // 2  # strokes that fill the history; a console that still loads takes none
AHEAD_EVERY = 0.2  # [s] between two of them, so that each falls into a control period of its own


class LivePages:
    """Pages of one console, which `act` once a second as browsers do."""

    def __init__(self, url: str, watching: str, observers: int) -> None:
        """Opens them.

        Args:
            url: login link of the page in control.
            watching: login link of an observer.
            observers: how many there are.
        """
        self._watching, self._turn = watching, 0
        self._pages: list[ViserClient] = []
        with ExitStack() as failing:
            failing.callback(self.close)
            self._pages.append(ViserClient(url, positions=False))
            for _ in range(observers):
                self._pages.append(ViserClient(watching, positions=False))
            failing.pop_all()

    def __enter__(self) -> Self:
        """For `with`."""
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        """Closes all of them."""
        self.close()

    def fill_history(self, strokes: Iterator[Floats]) -> None:
        """The page in control draws, until all actions that can be undone are strokes.

        Each of them holds a state of the whole team, 0.2 MB of 1 000 robots: memory would rise until there are as many
        as are kept. Actions of one control period share their state, so they come one by one.

        Args:
            strokes: each (n, 2) [m].
        """
        for number in range(AHEAD):
            self._pages[0].say("hello", identity=_identity(0))
            self._draw(number, next(strokes))
            time.sleep(AHEAD_EVERY)

    def act(self, strokes: Iterator[Floats]) -> None:
        """All give a sign of life; one observer reloads; the page in control draws in every fifth turn.

        Args:
            strokes: each (n, 2) [m].

        Raises:
            HigvfError: the console has closed a page.
        """
        if closed := sum(page.closed for page in self._pages):
            raise HigvfError(f"suite endurance: the console has closed {closed} of {len(self._pages)} pages")
        if len(self._pages) > 1:
            place = 1 + self._turn % (len(self._pages) - 1)
            self._pages[place].close()
            self._pages[place] = ViserClient(self._watching, positions=False)
        for number, page in enumerate(self._pages):
            page.say("hello", identity=_identity(number))
        if self._turn % STROKE_EVERY == 0:
            self._draw(AHEAD + self._turn, next(strokes))
        self._turn += 1

    def _draw(self, number: int, stroke: Floats) -> None:
        points = stroke.ravel().tolist()
        for sequence, (phase, some) in enumerate((("start", points[:2]), ("update", points[2:]), ("end", []))):
            self._pages[0].say("stroke", id=number, sequence=sequence, phase=phase, points=some, group=False)

    def close(self) -> None:
        """Closes all of them."""
        for page in self._pages:
            page.close()


def _identity(number: int) -> str:
    return f"page of endurance {number}"
