"""What an attack costs the attacked console."""

import ctypes
import gc
import time
from pathlib import Path

from higvf_console.core.commands import EmergencyStop, OperatorCommand
from higvf_console.runtime.session import Session
from tests.consoles import Running


class Watch:
    """What becomes of the session's ticks, counted in ticks and control periods.

    Attributes:
        longest: work of the longest tick, in control periods of the processor's time.
        stop_received: tick in which the first STOP came in; None = none has.
        stop_done: tick after which the team was stopped.
        stopped_at: when that was [s, `time.perf_counter`].
    """

    def __init__(self, session: Session) -> None:
        """Looks on."""
        self._session = session
        self._tick, self._push = session.tick, session.pointer.push
        self.clear()

    def clear(self) -> None:
        """Forgets what was seen."""
        self.longest = 0.0
        self.stop_received: int | None = None
        self.stop_done: int | None = None
        self.stopped_at = 0.0

    def tick(self, *, advance: bool = True) -> None:
        """A tick of the session, measured."""
        before = time.thread_time()
        self._tick(advance=advance)
        self.longest = max(self.longest, (time.thread_time() - before) / self.period)
        if self._session.snapshot.state.intent.stopped and self.stop_done is None:
            self.stop_done, self.stopped_at = self._session.ticks, time.perf_counter()

    @property
    def period(self) -> float:
        """Of control [s]."""
        return self._session.setup.params.safety.control_period

    def push(self, command: OperatorCommand) -> None:
        """A command of a page, on its way to the session."""
        if isinstance(command, EmergencyStop) and self.stop_received is None:
            self.stop_received = self._session.ticks
        self._push(command)

    @property
    def ticks_to_stop(self) -> int:
        """From the one in which STOP came in to the one after which the team was stopped."""
        assert self.stop_received is not None and self.stop_done is not None
        return self.stop_done - self.stop_received


def moves(running: Running) -> bool:
    """Whether the run, set back to its start, is not stopped; a STOP of an attack may still come in."""
    if running.state.intent.stopped:
        running.start_again()
        time.sleep(0.5)  # two resets at once would undo each other
    return not running.state.intent.stopped


def memory_mb() -> float:
    """Memory that this process holds [MB], without what it has freed and would use again."""
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * 4096 / 1e6
