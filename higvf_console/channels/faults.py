"""Faults put on a channel on purpose: what it says is held back, lost or late, and its silence is judged as a real one.

A replay under a fault goes on with the session clock, as an operator goes on who does not know of it. STOP, what takes
a channel back into service, and who steers pass every fault.
"""

from collections import deque
from collections.abc import Iterable

from higvf_console.core.commands import Acknowledge, EmergencyStop, FaultKind, HandOver, InjectFault, OperatorCommand
from higvf_console.core.interface import ChannelHealth, ChannelState

LONGEST = 3600.0  # [s]
_MOST_HELD = 4096  # commands
_GRAIN = 1e-9  # [s]


def problem(fault: InjectFault) -> str:
    """Why a fault cannot be put on a channel; empty where it can."""
    if not (0.0 < fault.seconds <= LONGEST and 0.0 <= fault.delay <= LONGEST):
        return f"a fault of {fault.seconds:g} s with a delay of {fault.delay:g} s: give 0 to {LONGEST:g} s"
    return ""


class Line:
    """The line from one interface to the session, sound until a fault is put on it."""

    def __init__(self) -> None:
        """Starts sound."""
        self._fault: InjectFault | None = None
        self._since = 0.0
        self._held: deque[tuple[float, OperatorCommand]] = deque(maxlen=_MOST_HELD)

    def inject(self, fault: InjectFault, now: float) -> None:
        """Puts a fault on the line from session time `now` on [s]; it takes the place of an earlier one."""
        self._fault, self._since = fault, now

    def carry(self, commands: Iterable[OperatorCommand], now: float) -> list[OperatorCommand]:
        """What of `commands` and of those held back reaches the session at time `now` [s]; nothing overtakes."""
        given: list[OperatorCommand] = []
        fault = self._active(now)
        for command in commands:
            if isinstance(command, EmergencyStop | Acknowledge | InjectFault | HandOver) or (
                fault is None and not self._held
            ):
                given.append(command)
            elif fault is None or fault.kind != FaultKind.DROP:
                self._held.append((self._due(fault, now), command))
        come: list[OperatorCommand] = []
        while self._held and self._held[0][0] <= now + _GRAIN:
            come.append(self._held.popleft()[1])
        return come + given

    def seen(self, health: ChannelHealth, now: float) -> ChannelHealth:
        """How the channel looks at the session's end of the line."""
        fault = self._active(now)
        if fault is None or health.state in (ChannelState.NEVER_SEEN, ChannelState.ENDED):
            return health
        last_seen = now if health.last_seen is None else health.last_seen
        late = now - fault.delay if fault.kind == FaultKind.DELAY else self._since
        detail = f"fault injected: {fault.kind}, {self._since + fault.seconds - now:.1f} s to go; {health.detail}"
        return ChannelHealth(health.state, detail, min(last_seen, max(self._since, late)))

    def _active(self, now: float) -> InjectFault | None:
        """The fault on the line now."""
        fault = self._fault
        if fault is not None and not self._since <= now < self._since + fault.seconds - _GRAIN:
            self._fault = fault = None
        return fault

    def _due(self, fault: InjectFault | None, now: float) -> float:
        """When what is said now comes through."""
        if fault is None:
            return self._held[-1][0] if self._held else now
        due = now + fault.delay if fault.kind == FaultKind.DELAY else self._since + fault.seconds
        return max(due, self._held[-1][0]) if self._held else due
