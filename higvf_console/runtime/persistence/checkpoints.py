"""The run on disk, for a console that is killed: the next one comes up stopped, with that run as it was, and asks.

    checkpoints/PID.state         what changes in each control period; written each second, and at once where STOP,
                                  pause or the influenced robot has changed
    checkpoints/PID.NUMBER.world  world and scenario; written where they have changed

A thread of its own writes them from what the session has published, so that no disk holds up the control loop. Files
are written as a whole or not at all, can be read by their owner alone, and are removed when a console ends as it
should. One that another version wrote, or that is damaged, is refused.
"""

import hashlib
import logging
import os
import pickle
import sys
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from threading import Event as Signal
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple

from higvf_console.core.errors import ScenarioError
from higvf_console.runtime.background.scheduling import stand_back
from higvf_console.runtime.failsafe import halted
from higvf_console.runtime.history import RunState
from higvf_console.runtime.phase import Phase
from higvf_console.scenario.kept import process_runs, write_whole

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session

EVERY = 1.0  # [s] between two checkpoints of a run
_LOOK = 0.02  # [s] between two looks for what is to be written at once
_FOLDER = "checkpoints"
_log = logging.getLogger(__name__)


class Checkpoint(NamedTuple):
    """A run as it was.

    Attributes:
        run_state: all that changes in it.
        ticks: control periods done; a reset of the run does not set it back.
    """

    run_state: RunState
    ticks: int

    @property
    def time(self) -> float:
        """Session time [s]."""
        return self.run_state.state.motion.tick * self.run_state.setup.params.safety.control_period

    def stopped(self) -> "Checkpoint":
        """The same with a STOP that has to be reset."""
        return self._replace(run_state=self.run_state._replace(state=halted(self.run_state.state)))


class Checkpoints:
    """Writes the checkpoints of one session."""

    def __init__(self, session: "Session", folder: Path) -> None:
        """Writes nothing yet.

        Args:
            session: whose run is kept.
            folder: the user's state folder.
        """
        self._session, self._folder = session, folder / _FOLDER
        self._name = str(os.getpid())
        self._kept: Checkpoint | None = None
        self._world: Path | None = None
        self._next = 0.0  # [s]
        self._failed = False

    def run(self, stopping: Signal) -> None:
        """Keeps the run until `stopping` is set; then it has ended as it should, and its files are removed."""
        stand_back()
        while not stopping.wait(_LOOK):
            try:
                self.keep()
                self._failed = False
            except OSError as error:
                if not self._failed:
                    _log.warning("The run is not kept in %s: %s", self._folder, error.strerror or error)
                self._failed = True
        self.remove()

    def keep(self) -> None:
        """Writes the run if it is time for it.

        Raises:
            OSError: it cannot be written.
        """
        now, kept = self._session.checkpoint, self._kept
        if now.run_state.phase.phase is Phase.READY or now is kept:
            return
        urgent = kept is None or _held(now) != _held(kept)
        if not urgent and monotonic() < self._next:
            return
        former = self._world
        if kept is None or now.run_state.setup is not kept.run_state.setup:
            self._world = self._folder / f"{self._name}.{now.ticks}-{id(now.run_state.setup)}.world"
            _write(self._world, now.run_state._replace(state=None, tally=None))  # pyright: ignore[reportArgumentType]
        world = self._world
        assert world is not None
        _write(self._folder / f"{self._name}.state", (world.name, now.ticks, *now.run_state[1:3], now.run_state.phase))
        if former is not None and former != world:
            former.unlink(missing_ok=True)
        self._kept, self._next = now, monotonic() + EVERY

    def remove(self) -> None:
        """Removes the files: nothing is to be restored."""
        remove(self._folder / f"{self._name}.state")


def left_checkpoints(folder: Path) -> list[Path]:
    """Those of consoles that run no more, the latest first; to be called before this console writes its own."""

    def left(process: str) -> bool:
        # In a container, every console has the same number.
        return process.isdecimal() and (int(process) == os.getpid() or not process_runs(int(process)))

    found = [file for file in (folder / _FOLDER).glob("*.state") if left(file.stem)]
    return sorted(found, key=lambda file: -file.stat().st_mtime)


def restored(file: Path) -> Checkpoint:
    """The run of a file.

    Raises:
        ScenarioError: it is damaged, or of another version.
    """
    world, ticks, state, tally, phase = _read(file)
    rest: RunState = _read(file.with_name(world))
    return Checkpoint(rest._replace(state=state, tally=tally, phase=phase), ticks)


def remove(file: Path) -> None:
    """Removes a checkpoint with its world."""
    for part in (file, *file.parent.glob(f"{file.stem}.*.world")):
        with suppress(OSError):
            part.unlink()


def _held(checkpoint: Checkpoint) -> tuple[bool, bool, int]:
    """What must be on disk at once."""
    intent = checkpoint.run_state.state.intent
    return intent.stopped, intent.paused, intent.influenced


def _write(file: Path, content: object) -> None:
    payload = pickle.dumps((version("higvf-console"), content), protocol=pickle.HIGHEST_PROTOCOL)
    write_whole(file, hashlib.sha256(payload).digest() + payload)


def _read(file: Path) -> Any:
    try:
        if sys.platform != "win32" and file.stat().st_uid != os.getuid():
            raise ScenarioError(f"{file}: belongs to another user")
        content = file.read_bytes()
    except OSError as error:
        raise ScenarioError(f"{file}: {error.strerror}") from error
    digest, payload = content[:32], content[32:]
    if hashlib.sha256(payload).digest() != digest:
        raise ScenarioError(f"{file}: damaged")
    try:
        made_by, value = pickle.loads(payload)
    except Exception as error:  # whatever another version's objects raise
        raise ScenarioError(f"{file}: of another version ({type(error).__name__})") from error
    if made_by != version("higvf-console"):
        raise ScenarioError(f"{file}: of version {made_by}; this is {version('higvf-console')}")
    return value
