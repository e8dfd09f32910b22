"""A run without a clock: one command or one control period at a time, and the tally of both.

Live, headless and replayed sessions all drive this class, so the same commands at the same ticks give the same bytes.
"""

import hashlib
import struct
from collections.abc import Callable
from typing import TypeAlias

from higvf_console.commands import OperatorCommand, ResetRun
from higvf_console.control.coupled_filter import CoupledFilter
from higvf_console.session.explain import Moved
from higvf_console.session.sections import FilterKind
from higvf_console.sim import simulation
from higvf_console.sim.certificates import Worst, watched
from higvf_console.sim.events import events_between
from higvf_console.sim.operator import apply_command
from higvf_console.sim.setup import Event, Setup
from higvf_console.state import Motion, SimState, Trace

Advance: TypeAlias = Callable[[SimState], tuple[SimState, Trace]]


class Run:
    """State, trace and tally of a run.

    Attributes:
        setup: what the run started from.
        state: now.
        last: the last control period; at the start of a run, the first one to come.
        ticks: control periods done; a reset of the run does not set it back.
        extinguished: fire indices in the order in which they went out.
        min_clearance: smallest clearance so far [m].
        infeasible_ticks: control periods in which a robot could not meet all barrier rows.
        deadlock_ticks: control periods in which a robot was deadlocked.
        worst: what the certificates of single ticks came to.
    """

    def __init__(self, setup: Setup, filter_kind: FilterKind = FilterKind.DISTRIBUTED) -> None:
        """Starts at tick 0, and computes the first trace ahead."""
        self.setup = setup
        self.state = setup.start
        self.ticks = 0
        self._advance = _advance_by(filter_kind, setup)
        self._forget()

    def _forget(self) -> None:
        ahead, trace = self._advance(self.setup.start)
        self.last = Moved(self.setup.start, ahead.motion, trace)
        self._trace_before: Trace | None = None
        self.extinguished: tuple[int, ...] = ()
        self.min_clearance = float("inf")
        self.infeasible_ticks = 0
        self.deadlock_ticks = 0
        self.worst = Worst()

    @property
    def trace(self) -> Trace:
        """Why the team moved as it did in the last control period."""
        return self.last.trace

    @property
    def time(self) -> float:
        """Session time [s]: control periods since the start, or since the run was reset."""
        return self.state.motion.tick * self.setup.gains.safety.control_period

    def apply(self, command: OperatorCommand) -> tuple[Event, ...]:
        """Gives a command its meaning; a refused one leaves the state as it was and says so."""
        self.state, events = apply_command(self.state, command, self.setup)
        if isinstance(command, ResetRun):
            self._forget()
        return events

    def step(self) -> tuple[Event, ...]:
        """Advances by one control period."""
        before = self.state
        self.state, trace = self._advance(before)
        events = events_between(before, self.state, self._trace_before, trace, self.setup.gains)
        self.last = Moved(before, self.state.motion, trace)
        self._trace_before = trace
        self.ticks += 1
        self._count(before.motion, trace)
        return events

    def _count(self, before: Motion, trace: Trace) -> None:
        was, burns = before.fire_burning, self.state.motion.fire_burning
        if was.tobytes() != burns.tobytes():
            self.extinguished += tuple(int(fire) for fire in (was & ~burns).nonzero()[0])
        self.min_clearance = min(self.min_clearance, float(trace.clearance.min()))
        self.infeasible_ticks += bool(trace.infeasible.any())
        self.deadlock_ticks += bool(trace.deadlocked.any())
        self.worst = watched(self.worst, self.state.motion, trace, self.setup.gains)


def _advance_by(filter_kind: FilterKind, setup: Setup) -> Advance:
    world, gains = setup.world, setup.gains
    if filter_kind is FilterKind.DISTRIBUTED:
        return lambda state: simulation.advance(state, world, gains)
    coupled = CoupledFilter()
    return lambda state: simulation.advance_coupled(state, world, gains, coupled)


class TrajectoryDigest:
    """SHA-256 over the bytes of position, velocity, fire radius, burning and path parameter of every tick."""

    def __init__(self) -> None:
        """Starts with no tick."""
        self._hash = hashlib.sha256()

    def add(self, motion: Motion) -> None:
        """Takes in the state after one tick."""
        update = self._hash.update
        update(motion.position.tobytes())
        update(motion.velocity.tobytes())
        update(motion.fire_radius.tobytes())
        update(motion.fire_burning.tobytes())
        update(struct.pack("<d", motion.path_parameter))

    def hex(self) -> str:
        """The digest of all ticks so far."""
        return self._hash.hexdigest()
