"""Scenarios that are loaded in the middle of a run: read and built by the worker, then handed over whole.

The team goes on with its task meanwhile. What cannot be read changes nothing.
"""

from collections import deque
from concurrent.futures import Future
from typing import NamedTuple

from higvf_console.channels.supervision import Said
from higvf_console.core.commands import LoadScenario
from higvf_console.core.errors import ScenarioError
from higvf_console.runtime.background.worker import Worker
from higvf_console.runtime.dispatch import Prepared, prepare
from higvf_console.scenario.scenario import load_scenario


class Loaded(NamedTuple):
    """What became of a command to load a scenario.

    Attributes:
        said: the command.
        prepared: the scenario; None where it cannot be used.
        refusal: why not.
    """

    said: Said
    prepared: Prepared | None
    refusal: str = ""


def _warm_up() -> None:
    """Loads what the first scenario would have to wait for."""
    prepare(LoadScenario(text=load_scenario("empty").text, name="empty.yaml"), 0)


class Loader:
    """The scenarios that are being prepared, in the order of their commands."""

    def __init__(self, worker: Worker) -> None:
        """Starts with none."""
        self._worker = worker
        worker.submit(_warm_up)
        self._pending: deque[tuple[Said, Future[Prepared]]] = deque()

    def submit(self, channel: str, command: LoadScenario, seed: int) -> None:
        """Begins to prepare a scenario."""
        self._pending.append((Said(channel, command), self._worker.submit(prepare, command, seed)))

    def take(self) -> list[Loaded]:
        """Those that have come to an end since the last call; never waits."""
        done: list[Loaded] = []
        while self._pending and self._pending[0][1].done():
            said, outcome = self._pending.popleft()
            try:
                done.append(Loaded(said, outcome.result()))
            except ScenarioError as error:
                done.append(Loaded(said, None, str(error)))
        return done
