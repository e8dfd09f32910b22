"""A run without a clock: one command or one control period at a time, and the tally of both.

Live, headless and replayed sessions all drive this class, so the same commands at the same ticks give the same bytes.
"""

import hashlib
import math
import struct
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

from higvf_console.analysis.explain import Moved
from higvf_console.analysis.violation import violation_text
from higvf_console.control.parameters import Parameters, controlled
from higvf_console.core.commands import AskArm, OperatorCommand, Redo, ResetRun, TeamCommand, Undo
from higvf_console.core.errors import ScenarioError
from higvf_console.core.events import Event, Severity
from higvf_console.core.state import Motion, SimState, Trace
from higvf_console.core.team import Drive
from higvf_console.runtime.dispatch import Prepared, dispatch
from higvf_console.runtime.history import History, RunState, Tally
from higvf_console.runtime.phase import END_TEXTS, FIRST, Phase, RunPhase, after_period
from higvf_console.scenario.ends import Ends, EndWhen
from higvf_console.scenario.scenario import Scenario
from higvf_console.scenario.sections import FilterKind
from higvf_console.sim import simulation
from higvf_console.sim.certificates import watched
from higvf_console.sim.events import events_between
from higvf_console.sim.guard import NO_GUARD
from higvf_console.team.arming import disarmed
from higvf_console.team.commands import NO_TEAM, commanded_by_hand
from higvf_console.team.guard import advanced
from higvf_console.team.state import Arming, TeamReport, TeamState, events_of, opened
from higvf_console.team.supervision import commanded, supervised
from higvf_console.team.tracking import Rules
from higvf_console.world.setup import Setup


class Tick(NamedTuple):
    """What a run has come to after one control period; its arrays do not change.

    Attributes:
        time: session time [s].
        state: robots, fires and what the operator asks for.
        trace: why the team moved so.
        setup: world and parameters in force.
    """

    time: float
    state: SimState
    trace: Trace
    setup: Setup


Advance: TypeAlias = Callable[[SimState], tuple[SimState, Trace]]


class Run:
    """State, trace and tally of a run.

    Attributes:
        state: now.
        last: the last control period; at the start of a run and after an edit, the first one to come.
        ticks: control periods done; a reset of the run does not set it back.
        tally: what it has come to so far.
        filter: the safety filter that runs.
        scenario: where it comes from; None for a run that no scenario file describes.
        history: what was done, to be undone.
        phase: where it is between its beginning and its end; `step` advances it in each.
        team: robots that are not integrated here, as they were last heard of; None = all are.
        rules: what those robots can do; None = there are none.
    """

    def __init__(
        self,
        setup: Setup,
        filter_kind: FilterKind = FilterKind.DISTRIBUTED,
        scenario: Scenario | None = None,
        phase: RunPhase = FIRST,
        *,
        timed: bool = False,
        rules: Rules | None = None,
    ) -> None:
        """Starts at tick 0, and computes the first trace ahead.

        Args:
            setup: world and start.
            filter_kind: which safety filter runs.
            scenario: where the run comes from.
            phase: where it begins.
            timed: whether a person watches it, so that the scenario's duration ends it.
            rules: of a team that is not integrated here; None = there is none.
        """
        self.state = setup.start
        self.ticks = 0
        self.tally = Tally()
        self.filter = filter_kind
        self.scenario = scenario
        self.history = History()
        self.phase = phase
        self._timed = timed
        self.rules = rules
        self.team: TeamState | None = None if rules is None else opened(len(setup.start.motion.position))
        self._answers = False  # whether a report waits for what the robots are told
        self._moved = False  # whether a control period has passed since the last report
        self._take(setup)

    def _take(self, setup: Setup) -> None:
        """Goes on in another world, or in the same one from another state."""
        self._setup = setup
        self._advance = _advance_by(self.filter, setup)
        ahead, trace = self._advance(self.state)
        self.last = Moved(self.state, ahead.motion, trace)
        self._trace_before: Trace | None = None

    def restore(self, run_state: RunState, ticks: int) -> None:
        """Goes on from another run state, after so many control periods; there is nothing to undo."""
        _, self.state, self.tally, self.filter, self.scenario, self.phase = run_state
        self.ticks, self.history = ticks, History()
        self._take(run_state.setup)

    @property
    def setup(self) -> Setup:
        """World and parameters in force, and what a reset starts from."""
        return self._setup

    @property
    def run_state(self) -> RunState:
        """The run as it is now."""
        return RunState(self._setup, self.state, self.tally, self.filter, self.scenario, self.phase)

    @property
    def stands(self) -> bool:
        """Whether the run has not begun, or has ended for who watches it: a session takes no step then."""
        phase = self.phase.phase
        return phase is Phase.READY or (phase is Phase.ENDED and self._timed)

    @property
    def trace(self) -> Trace:
        """Why the team moved as it did in the last control period."""
        return self.last.trace

    @property
    def time(self) -> float:
        """Session time [s]: control periods since the start, or since the run was reset."""
        return self.state.motion.tick * self._setup.params.safety.control_period

    def apply(self, command: OperatorCommand, prepared: Prepared | None = None) -> tuple[Event, ...]:
        """Gives a command its meaning; a refused one leaves everything as it was and says so.

        Args:
            command: what the operator asks for.
            prepared: of a LoadScenario, where it was prepared ahead.
        """
        try:
            if isinstance(command, TeamCommand):
                return self._command_team(command)
            run_state, history, events = dispatch(self.run_state, self.history, command, prepared)
            self._keep_robots(run_state)
        except ScenarioError as error:
            return _refused((Event(self.time, Severity.WARNING, "refused", f"Not done: {error}."),), command)
        again = run_state.setup is not self._setup or isinstance(command, ResetRun | Undo | Redo)
        self.state, self.tally, self.history = run_state.state, run_state.tally, history
        self.filter, self.scenario, self.phase = run_state.filter, run_state.scenario, run_state.phase
        if again:
            self._take(run_state.setup)
        return _refused(events, command)

    def _command_team(self, command: TeamCommand) -> tuple[Event, ...]:
        if self.team is None or self.rules is None:
            raise ScenarioError(NO_TEAM)
        if isinstance(command, AskArm) and self.state.intent.stopped:
            raise ScenarioError("STOP is active, and the check moves every robot: reset it first")
        self.team, text = commanded_by_hand(self.team, command, self.rules)
        return (Event(self.time, Severity.INFO, "team", text),)

    def _keep_robots(self, become: RunState) -> None:
        """Refuses what would have a team of other robots, or lead them faster, than those that there are."""
        if self.team is None or self.rules is None:
            return
        robots, params = len(become.state.motion.position), become.setup.params
        if robots != len(self.team.stopped):
            raise ScenarioError(f"the team has {len(self.team.stopped)} robots, and there would be {robots}")
        if (ahead := params.robots.look_ahead) != self.rules.look_ahead:
            raise ScenarioError(
                f"the team's robots are led at {self.rules.look_ahead:g} m ahead of their centres, and it would be "
                f"{ahead:g} m"
            )
        if become.filter is not FilterKind.DISTRIBUTED:
            raise ScenarioError(f"a team needs the filter '{FilterKind.DISTRIBUTED}', not '{become.filter}'")
        if (noise := params.robots.position_noise) > 0.0:
            raise ScenarioError(f"the poses of a team are measured, and {noise:g} m of simulated error would be added")
        limit, own = controlled(params).safety.speed_limit, self.rules.speed_limit
        if limit > own:
            raise ScenarioError(f"the team's robots drive {own:g} m/s, and it would be {limit:g} m/s")

    def hear(self, report: TeamReport) -> tuple[Event, ...]:
        """Takes in where the team is; to be called once in each beat of the clock, be it that it stands."""
        if self.team is None or self.rules is None:
            raise ScenarioError(NO_TEAM)
        if self._answers:
            self.command()
        self.team, told = supervised(self.team, report, self.rules)
        self._answers, self._moved = True, False
        return events_of(told, self.time)

    def command(self) -> Drive | None:
        """What the team is told after its report, and after the control period if one has passed; None = nothing."""
        self._answers = False
        if self.team is None or self.rules is None:
            return None
        if self.state.intent.stopped and self.team.arming is Arming.CHECKING:  # whose motion asks for no velocity
            self.team = disarmed(self.team)
        drives = self._moved and not self.state.intent.stopped
        period = self._setup.params.safety.control_period
        self.team, command = commanded(self.team, self.state.motion, self.rules, period, drives=drives)
        return command

    def step(self) -> tuple[Event, ...]:
        """Advances by one control period."""
        before, guard = self.state, NO_GUARD
        if self.team is None or self.rules is None:
            self.state, trace = self._advance(before)
        else:
            world, params = self._setup.world, self._setup.params
            before, self.state, trace, guard = advanced(before, self.team, world, params, self.rules)
            self._moved = True
        events = events_between(before, self.state, self._trace_before, trace, self._setup.params, self._violation)
        self.last = Moved(before, self.state.motion, trace, guard)
        self._trace_before = trace
        self.ticks += 1
        self.tally = _counted(self.tally, before.motion, self.state.motion, trace, self._setup.params)
        return events + self._follow_phase()

    def _follow_phase(self) -> tuple[Event, ...]:
        """Whether the last control period was the run's last, and the event that reports it."""
        ends, limit = Ends(), math.inf
        if self.scenario is not None:
            ends = self.scenario.ends
            limit = self.scenario.duration if self._timed and ends.when is not EndWhen.NEVER else math.inf
        before = self.phase
        self.phase = after_period(before, self.state.motion, ends, limit, self._setup.params.safety.control_period)
        if self.phase.phase is before.phase or self.phase.reason is None:
            return ()
        text = f"The run has ended: {END_TEXTS[self.phase.reason]}."
        return (Event(self.time, Severity.GOOD, "run", text),)

    def _violation(self, robot: int, motion: Motion) -> str:
        return violation_text(robot, motion, self._setup)


def _refused(events: tuple[Event, ...], command: OperatorCommand) -> tuple[Event, ...]:
    """The events, each refusal with what was refused."""
    name = type(command).__name__
    return tuple(event._replace(command=name) if event.kind == "refused" else event for event in events)


def _counted(tally: Tally, before: Motion, after: Motion, trace: Trace, params: Parameters) -> Tally:
    """The tally after one control period."""
    extinguished, was, burns = tally.extinguished, before.fire_burning, after.fire_burning
    if was.tobytes() != burns.tobytes():
        extinguished += tuple(int(fire) for fire in (was & ~burns).nonzero()[0])
    return Tally(
        extinguished,
        min(tally.min_clearance, float(trace.clearance.min(initial=math.inf))),
        tally.infeasible_ticks + bool(trace.infeasible.any()),
        tally.deadlock_ticks + bool(trace.deadlocked.any()),
        watched(tally.worst, after, trace, params),
    )


def _advance_by(filter_kind: FilterKind, setup: Setup) -> Advance:
    world, params = setup.world, setup.params
    if filter_kind is FilterKind.DISTRIBUTED:
        return lambda state: simulation.advance(state, world, params)
    from higvf_console.control.safety.coupled_filter import CoupledFilter  # noqa: PLC0415 (loads OSQP)

    coupled = CoupledFilter()
    return lambda state: simulation.advance_coupled(state, world, params, coupled)


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
