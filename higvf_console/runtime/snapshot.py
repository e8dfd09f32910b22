"""All that a view needs of one moment of a session."""

from typing import NamedTuple, cast

from higvf_console.analysis.explain import Moved
from higvf_console.channels.input_reports import InputReports
from higvf_console.core.arrays import Floats
from higvf_console.core.events import Event
from higvf_console.core.interface import ChannelHealth
from higvf_console.core.state import SimState, Trace
from higvf_console.runtime.clock import Clock
from higvf_console.runtime.history import History
from higvf_console.runtime.phase import RunPhase
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import Scenario
from higvf_console.sim.certificates import Worst
from higvf_console.sim.metrics import loss_area
from higvf_console.team.state import TeamState
from higvf_console.team.tracking import Rules
from higvf_console.world.setup import Setup


class Snapshot(NamedTuple):
    """All that a view needs of one moment.

    Attributes:
        scenario: what is run; another object once another one is loaded.
        setup: world and parameters in force; another object once they are edited.
        state: now.
        trace: of the last control period.
        last: the last control period as a whole; at the start of a run, the first one to come.
        time: session time [s].
        phase: whether the run waits for its start, runs, or has ended.
        frozen: whether the operator has frozen the simulation clock.
        speed: factor of the simulation clock.
        loss_area: (M,) burnt by each fire [m^2].
        min_clearance: smallest of the run so far [m]; the present one is in the trace.
        tick_ms: how long the tick took [ms].
        lost_time: by which the run lags behind real time, because the computer was busy [s].
        infeasible_ticks: control periods in which a robot could not meet all barrier constraints.
        deadlock_s: time in which a robot was deadlocked [s].
        worst: what the certificates of single ticks came to so far.
        extinguished: fire indices in the order in which they went out.
        history: what was done and may be undone.
        channels: how each interface is.
        events: what happened, oldest first; the last `EVENTS_KEPT`.
        inputs: what the interfaces report: attention, decoding, calibration.
        team: robots that are not integrated here, as they were last heard of; None = all are.
        rules: what those robots can do; None = there are none.
    """

    scenario: Scenario
    setup: Setup
    state: SimState
    trace: Trace
    last: Moved
    time: float
    phase: RunPhase
    frozen: bool
    speed: float
    loss_area: Floats
    min_clearance: float
    tick_ms: float
    lost_time: float
    infeasible_ticks: int
    deadlock_s: float
    worst: Worst
    extinguished: tuple[int, ...]
    history: History
    channels: tuple[tuple[str, ChannelHealth], ...]
    events: tuple[Event, ...]
    inputs: InputReports = InputReports()
    team: TeamState | None = None
    rules: Rules | None = None


def snapshot_of(
    run: Run,
    clock: Clock,
    channels: tuple[tuple[str, ChannelHealth], ...],
    events: tuple[Event, ...],
    inputs: InputReports,
    *,
    tick_ms: float,
) -> Snapshot:
    """A run of a scenario, as it is now.

    Args:
        run: what is shown.
        clock: of its session.
        channels: how each interface is.
        events: what happened, oldest first.
        inputs: what the interfaces report.
        tick_ms: how long the tick took [ms].
    """
    tally = run.tally
    return Snapshot(
        scenario=cast(Scenario, run.scenario),
        setup=run.setup,
        state=run.state,
        trace=run.trace,
        last=run.last,
        time=run.time,
        phase=run.phase,
        frozen=clock.frozen,
        speed=clock.speed,
        loss_area=loss_area(run.state.motion),
        min_clearance=tally.min_clearance,
        tick_ms=tick_ms,
        lost_time=clock.lost,
        infeasible_ticks=tally.infeasible_ticks,
        deadlock_s=tally.deadlock_ticks * run.setup.params.safety.control_period,
        worst=tally.worst,
        extinguished=tally.extinguished,
        history=run.history,
        channels=channels,
        events=events,
        inputs=inputs,
        team=run.team,
        rules=run.rules,
    )
