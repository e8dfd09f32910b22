"""Keeps the edited world of a console in a draft file every few seconds, off the control loop.

A draft is the world as a reset of the run would start it. One that is saved, dismissed or undone is gone; one that a
console left behind when it ended is offered again.
"""

import logging
import os
import threading
from pathlib import Path
from threading import Event as Signal
from typing import TYPE_CHECKING, get_args

from higvf_console.core.commands import OperatorCommand
from higvf_console.core.edits import Edit
from higvf_console.core.errors import ScenarioError
from higvf_console.core.reading.document import read_text
from higvf_console.runtime.background.scheduling import stand_back
from higvf_console.runtime.history import Action, History
from higvf_console.scenario.kept import Draft, Recent, draft_file, left_drafts, remember, write_whole
from higvf_console.scenario.scenario import data_folder, scenario_names
from higvf_console.scenario.writer import scenario_yaml
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session
    from higvf_console.scenario.scenario import Scenario

EVERY = 3.0  # [s] between two looks
_EDITS = frozenset(kind.__name__ for kind in get_args(OperatorCommand) if issubclass(kind, Edit))
_log = logging.getLogger(__name__)


class Drafts:
    """The draft of one console, and those that others left.

    Attributes:
        folder: the user's state folder.
        offered: the latest draft that a console left; None = there is none, or it has been answered.
    """

    def __init__(self, session: "Session", folder: Path) -> None:
        """Looks for drafts that were left.

        Args:
            session: whose world is kept.
            folder: the user's state folder.
        """
        self.folder = folder
        self._session = session
        self._known = {read_text(data_folder() / "scenarios" / f"{name}.yaml") for name in scenario_names()}
        self._file = draft_file(folder, os.getpid())
        self._lock = threading.Lock()
        self._kept: Setup | None = None  # that the file holds, or that was saved
        self._opened: Scenario | None = None
        self._failed = False
        left = left_drafts(folder)
        self.offered: Draft | None = left[0] if left else None

    def run(self, stopping: Signal) -> None:
        """Looks every few seconds until `stopping` is set, and once more then."""
        stand_back()
        while not stopping.wait(EVERY):
            self.keep()
        self.keep()

    def keep(self) -> None:
        """Writes the world if it was edited since the last look; removes the draft of edits that are all undone."""
        with self._lock:
            try:
                self._remember()
                self._keep()
                self._failed = False
            except (OSError, ScenarioError) as error:
                if not self._failed:
                    _log.warning("the edited world is not kept in %s: %s", self._file, error)
                self._failed = True

    def saved(self, setup: Setup) -> None:
        """The operator has saved a world: its draft is gone."""
        with self._lock:
            self._kept = setup
            self._file.unlink(missing_ok=True)

    def dismiss(self) -> None:
        """The draft that was offered is removed; the next one that was left, if any, is offered."""
        with self._lock:
            if self.offered is not None:
                self.offered.file.unlink(missing_ok=True)
            left = left_drafts(self.folder)
            self.offered = left[0] if left else None

    def take(self) -> Draft | None:
        """The draft that was offered becomes that of this console, until it is saved or edited."""
        with self._lock:
            draft, self.offered = self.offered, None
            if draft is not None:
                draft.file.replace(self._file)
                self._known.add(draft.text)  # it is no own file
            return draft

    def _keep(self) -> None:
        snapshot = self._session.snapshot
        if snapshot.setup is self._kept:
            return
        if _edited(snapshot.history.done):
            write_whole(self._file, scenario_yaml(snapshot.setup, snapshot.setup.start, snapshot.scenario))
            self._kept = snapshot.setup
        elif _undone(snapshot.history) and self._kept is not None:
            self._file.unlink(missing_ok=True)
            self._kept = None

    def _remember(self) -> None:
        scenario = self._session.scenario
        if scenario is self._opened:
            return
        self._opened = scenario
        if scenario.text not in self._known:
            remember(self.folder, Recent(scenario.title, scenario.source, scenario.text))


def _edited(done: tuple[Action, ...]) -> bool:
    """Whether the world was edited since its scenario was loaded."""
    for action in reversed(done):
        if action.kind in _EDITS:
            return True
        if action.kind == "LoadScenario":
            return False
    return False


def _undone(history: History) -> bool:
    """Whether an edit has been undone."""
    return any(action.kind in _EDITS for action in history.undone)
