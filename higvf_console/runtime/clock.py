"""The session's clock: frozen or running, how fast, and how late. It decides when a tick is due, never what it does."""

from threading import Event as Signal
from time import perf_counter

from higvf_console.core.commands import Freeze, OperatorCommand, SetSpeed, Step

SLOWEST, FASTEST = 0.25, 8.0  # speed factors
CATCH_UP = 3  # ticks by which the loop may lag before it gives up the lost time


class Clock:
    """Real time, slowed, hastened or standing.

    Attributes:
        frozen: whether it stands but for single steps.
        speed: factor of real time.
        lost: by which the run lags behind real time, because the computer was busy [s].
    """

    def __init__(self, *, real_time: bool = False) -> None:
        """Starts running, in real time; with `real_time` it keeps to that, for robots that are not simulated."""
        self._real_time = real_time
        self.frozen, self.speed, self.lost = False, 1.0, 0.0
        self._steps_due = 0
        self._credit = 0.0  # ticks of a slowed clock

    def command(self, command: OperatorCommand, *, stands: bool = False) -> str:
        """Follows a command on the clock; returns why it is refused, empty where it is not.

        Args:
            command: any; those that are not on the clock change nothing.
            stands: whether the run has not begun, or has ended, so that no step can be made.
        """
        match command:
            case Freeze(frozen=frozen):
                self.frozen, self._steps_due = bool(frozen), 0
            case Step() if stands:
                return "No step: start the run, or continue one that has ended, first."
            case Step():
                self._steps_due += 1
            case SetSpeed(factor=factor):
                return self.set_speed(factor)
            case _:
                pass
        return ""

    def set_speed(self, factor: float) -> str:
        """Runs at `factor` times real time; returns why that is refused, empty where it is not."""
        if not SLOWEST <= factor <= FASTEST:
            return f"The clock cannot run at {factor:g} times real time: choose {SLOWEST:g} to {FASTEST:g}."
        if self._real_time and factor != 1.0:
            return f"The clock cannot run at {factor:g} times real time: the robots of a team drive in real time."
        self.speed = float(factor)
        return ""

    def halt(self) -> None:
        """Stands from now on."""
        self.frozen, self._steps_due = True, 0

    def advances(self, *, wanted: bool = True) -> bool:
        """Whether this tick is one of the simulation; a frozen clock spends one of its steps."""
        if self.frozen:
            wanted, self._steps_due = self._steps_due > 0, max(0, self._steps_due - 1)
        return wanted

    def beat(self) -> bool:
        """Whether a slowed clock is due to advance, at a beat of the loop."""
        self._credit += min(self.speed, 1.0)
        due = self._credit >= 1.0
        self._credit -= due
        return due

    def wait(self, due: float, period: float, stopping: Signal) -> tuple[float, float]:
        """Waits for the next beat.

        Args:
            due: when the last one was due [s].
            period: dt [s].
            stopping: ends the wait.

        Returns:
            When the next beat was due, and the time lost since the last one that cannot be caught up with [s].
        """
        period /= max(self.speed, 1.0)
        due += period
        now = perf_counter()
        if now < due:
            stopping.wait(due - now)
        lost = max(0.0, now - CATCH_UP * period - due)
        self.lost += lost
        return due + lost, lost
