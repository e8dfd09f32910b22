"""A session: the one loop between operator and team.

    each tick:  poll the interfaces -> apply their commands -> watch the channels -> advance -> record -> publish

STOP is looked for before each command. A run in real time gives commands a share of each control period, and what does
not fit in waits for the next one.

The session owns the clock (freeze, step, speed). Views read `snapshot`, which is immutable and replaced as a whole.
"""

import logging
import math
from collections import deque
from collections.abc import Iterable
from threading import Event as Signal
from threading import Thread
from time import perf_counter
from typing import Any, NamedTuple, cast

from higvf_console.analysis.baseline import Baseline
from higvf_console.channels.channel_state import Limits
from higvf_console.channels.channels import Channels
from higvf_console.channels.input_reports import InputReports, Reporter, calibration_event
from higvf_console.channels.marker_outlet import MarkerOutlet
from higvf_console.channels.supervision import Said, Supervisor
from higvf_console.core.arguments import instance, whole
from higvf_console.core.command import SESSION
from higvf_console.core.commands import (
    Cursor,
    EmergencyStop,
    LoadScenario,
    OperatorCommand,
    Redo,
    StrokePoints,
    Undo,
)
from higvf_console.core.edits import Edit
from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import Interface, OperatorContext, PointerSink, Targets
from higvf_console.core.limiter import Limiter
from higvf_console.core.reports import Calibrated
from higvf_console.core.viewport import Viewport
from higvf_console.runtime.admission import Admission
from higvf_console.runtime.background.baseline_thread import keep_baseline
from higvf_console.runtime.background.loader import Loaded, Loader
from higvf_console.runtime.background.worker import Worker
from higvf_console.runtime.clock import Clock
from higvf_console.runtime.compiling import announce
from higvf_console.runtime.dispatch import Prepared, seed_of
from higvf_console.runtime.failsafe import failure_event, halted, interruption_event
from higvf_console.runtime.history import rows_before
from higvf_console.runtime.inputs import opening_warnings
from higvf_console.runtime.persistence.checkpoints import Checkpoint
from higvf_console.runtime.phase import Phase, RunPhase
from higvf_console.runtime.recording import Recorder
from higvf_console.runtime.run import Run
from higvf_console.runtime.snapshot import Snapshot
from higvf_console.scenario.scenario import Scenario
from higvf_console.sim.metrics import loss_area
from higvf_console.world.setup import Setup

EVENTS_KEPT = 2000
COMMANDS_KEPT = 20_000
COMMAND_SHARE = 0.25  # of a control period, for the commands of a run in real time
_WATCH_EVERY = 5  # ticks from one look after the channels to the next

_log = logging.getLogger(__name__)


class AppliedCommand(NamedTuple):
    """A command and the session time at which it was applied [s]."""

    time: float
    command: OperatorCommand


class Session:
    """A scenario, its operator's interfaces and the clock.

    Attributes:
        seed: of the start positions.
        snapshot: the latest moment.
        baseline: loss area without an operator; None until it is known.
        viewport: how the operator's screen lies over the arena; set by the view.
        command_time: what the commands of one tick may take [s]; a run in real time limits it.
        commands: the latest that were applied, without cursors and stroke points, which come by the thousand.
        error: what halted the engine; None while all is well.
        attended: whether the clock stands once a run has ended.
        waits: whether the clock of a run that a person begins waits for a StartRun.
        interrupted: session time [s] at which a console was killed whose run this is, until the operator has decided
            what becomes of it; None = it is not.
        checkpoint: the run, to be kept on disk.
        worker: for what must not hold up the loop; None = there is none.
        answered: set when there is an answer to the operator to show, such as what a command did; the view clears it.
    """

    def __init__(
        self,
        scenario: Scenario,
        interfaces: Iterable[Interface],
        seed: int = 0,
        recorder: Recorder | None = None,
        markers: MarkerOutlet | None = None,
        *,
        attended: bool = False,
        waits: bool = False,
        worker: Worker | None = None,
        interrupted: Checkpoint | None = None,
    ) -> None:
        """Sets the run up and publishes its first moment; nothing moves before `tick` or `run`.

        Args:
            scenario: what to run.
            interfaces: polled each tick, in this order.
            seed: of the start positions.
            recorder: writes everything down.
            markers: reports to the laboratory's other devices.
            attended: whether a person watches the run: its clock stands once it has ended, which the scenario's
                duration does too.
            waits: whether the clock of the first run waits for a StartRun.
            worker: reads what is loaded during the run, so that the team does not wait; None = the session itself does.
            interrupted: a run to go on with, stopped.

        Raises:
            ScenarioError: the start is not safe with this seed.
            InputError: two interfaces have the same name, or one offers capabilities that cannot be.
            ArgumentError: an argument is of another type, or an interface lacks one of its functions.
        """
        instance("scenario", scenario, Scenario)
        self.seed = whole("seed", seed, 0)
        announce()
        self.baseline: Baseline | None = None
        self.viewport: Viewport | None = None
        self.commands: deque[AppliedCommand] = deque(maxlen=COMMANDS_KEPT)
        self.error: Exception | None = None
        self.answered = Signal()
        phase = RunPhase(Phase.READY if waits else Phase.RUNNING)
        self.attended, self.waits = attended, waits
        self._run = Run(scenario.setup(seed), scenario.filter, scenario, phase, timed=attended)
        self.interrupted = None if interrupted is None else interrupted.time
        if interrupted is not None:
            self._run.restore(*interrupted.stopped())
        self._channels = Channels(interfaces)
        self._supervisor = Supervisor(self._channels, scenario.limits)
        self._reporter = Reporter(self._channels, self._run.setup.params.safety.control_period)
        self._admission = Admission()
        self.command_time = math.inf  # for the commands of one tick [s]
        self._limiter = Limiter()
        self._applied = 0  # commands but cursors and stroke points
        self._recorder, self._markers = recorder, markers
        self._clock = Clock()
        self.worker = worker
        self._loader = None if worker is None else Loader(worker)
        self._heartbeats = 0
        self._events = opening_warnings(scenario, self._channels)
        if self.interrupted is not None:
            self._add((interruption_event(self.interrupted),))
        self._publish(perf_counter())

    @property
    def pointer(self) -> PointerSink:
        """Where the view leaves its pages' commands: the first interface that takes them; InputError without one."""
        return self._channels.pointer

    @property
    def pointer_limits(self) -> Limits:
        """When silence of that interface matters."""
        return self._supervisor.limits[self._channels.pointer_name]

    def draws_previewed(self, source: str) -> bool:
        """Whether strokes of a source are previewed with what is chosen at the console, see `Capabilities`."""
        return source in self._channels.names and self._channels.capabilities[source].draws_previewed

    @property
    def scenario(self) -> Scenario:
        """What is run."""
        return cast(Scenario, self._run.scenario)

    @property
    def calibrated(self) -> Calibrated | None:
        """The interface whose calibration can be made; None = none has a screen."""
        return self._reporter.calibrated

    @property
    def input_reports(self) -> InputReports:
        """What the interfaces report at this moment; the snapshot's may be half a second old."""
        return self._reporter.count(self._run.time, self.snapshot.inputs)

    @property
    def setup(self) -> Setup:
        """What a reset of the run starts from."""
        return self._run.setup

    @property
    def ticks(self) -> int:
        """Control periods done; a reset of the run does not set it back."""
        return self._run.ticks

    def tick(self, *, advance: bool = True) -> None:
        """Polls and applies, then advances by one control period unless the clock stands, and publishes.

        Args:
            advance: False polls, applies and publishes only (between the ticks of a slowed clock).
        """
        started, known = perf_counter(), self._applied
        self._attend()
        advance = self._clock.advances(wanted=advance)
        if advance and not self._stands:
            self._add(self._run.step())
            if self._recorder is not None:
                self._record(self._recorder.step, self._run.state.motion)
        if self._recorder is not None:
            self._record(self._recorder.keep)
        self._publish(started)
        if self._applied > known:
            self.answered.set()

    @property
    def _stands(self) -> bool:
        """Whether the run has not begun, or has ended for who watches it."""
        phase = self._run.phase.phase
        return phase is Phase.READY or (phase is Phase.ENDED and self.attended)

    def run(self, stopping: Signal) -> None:
        """Ticks at the pace of the clock until `stopping` is set; an engine that fails halts the team, not the loop."""
        Thread(target=keep_baseline, args=(self, stopping), name="baseline", daemon=True).start()
        self.command_time = COMMAND_SHARE * self.setup.params.safety.control_period
        due = perf_counter()
        while not stopping.is_set():
            try:
                self.tick(advance=self._clock.beat())
            except Exception as error:  # the operator must learn of any failure, and the robots must stand
                self._halt(error)
            due, lost = self._clock.wait(due, self.setup.params.safety.control_period, stopping)
            if lost > 0.0:
                self._report_lateness()

    def close(self) -> None:
        """Closes the interfaces and completes the recording."""
        try:
            self._channels.close()
        finally:
            if self._recorder is not None:
                self._record(self._recorder.close)
                self._publish(perf_counter())  # an event reports if that failed
            if self._markers is not None:
                self._markers.close()

    def _report_lateness(self) -> None:
        if count := self._limiter.due("late", perf_counter()):
            delays = f"{count} new delay" + "s" * (count > 1)
            text = f"The computer is busy: the run lags {self._clock.lost:.1f} s behind real time ({delays})."
            self._add((Event(self._run.time, Severity.WARNING, "late", text),))

    def _attend(self) -> None:
        intent, motion = self._run.state.intent, self._run.state.motion
        context = OperatorContext(
            time=self._run.time,
            operator="operator",
            viewport=self.viewport,
            clutch=self._run.state.pointer_state.clutch,
            paused=intent.paused,
            influenced=intent.influenced,
            extinguished=self._run.tally.extinguished,
            robots=len(motion.position),
            targets=Targets(self._run.setup.world.fire_position, motion.fire_radius, motion.position),
        )
        if self._loader is not None:
            for loaded in self._loader.take():
                self._load(loaded)
        said, failures = self._supervisor.poll(context)
        self._admission.take_in(said)
        self._apply_waiting(context)
        self._add(failures)
        if failures or self._heartbeats % _WATCH_EVERY == 0:
            commands, events = self._supervisor.watch(self._run.time, self._run.state)
            self._add(events)
            for command in commands:
                self._apply(command, SESSION)
        self._heartbeats += 1

    def _apply_waiting(self, context: OperatorContext) -> None:
        """Applies what waits, STOP first, until all is done or the time for it is used up."""
        end = perf_counter() + self.command_time
        while True:
            self._admission.take_in(Said(*stop) for stop in self._channels.take_stops(context))
            said = self._admission.next()
            if said is None:
                break
            self._apply(said.command, said.channel)
            if perf_counter() >= end:
                self._admission.yield_turn()
                break
        for channel, dropped in self._admission.take_dropped().items():
            if count := self._limiter.due(("dropped", channel), perf_counter(), dropped):
                text = f"Input '{channel}' sends faster than commands can be applied: {count} were dropped."
                self._add((Event(self._run.time, Severity.WARNING, "channel", text),))

    def _load(self, loaded: Loaded) -> None:
        """Goes over to a scenario that has been prepared."""
        if loaded.prepared is None:
            self._refuse(f"Not done: {loaded.refusal}.")
        else:
            self._apply(loaded.said.command, loaded.said.channel, loaded.prepared)

    def _apply(self, command: OperatorCommand, channel: str, prepared: Prepared | None = None) -> None:
        if isinstance(command, EmergencyStop) and self._latched():
            return  # it is latched already, and repeating it must cost nothing
        if isinstance(command, LoadScenario) and self._loader is not None and prepared is None:
            self._loader.submit(channel, command, seed_of(self._run.setup))
            return
        former = self._run.scenario
        try:
            self._give(command, channel, prepared)
        except Exception as error:  # a device may send what no type checker saw; the state is as it was
            source = getattr(command, "source", "?")
            self._refuse(f"Input '{source}' sent {type(command).__name__}, which cannot be used: {error}")
            return
        if not isinstance(command, Cursor | StrokePoints):
            self._applied += 1
            self.commands.append(AppliedCommand(self._run.time, command))
            if self._markers is not None:
                self._markers.command(self._run.time, command)
        refused = isinstance(command, LoadScenario) and self._run.scenario is former
        if self._recorder is not None and not refused:
            self._record(self._recorder.command, command, self._run.scenario)

    def _latched(self) -> bool:
        """Whether a STOP is active and nobody has begun to reset it."""
        state = self._run.state
        return state.intent.stopped and not state.pointer_state.ask_reset

    def _give(self, command: OperatorCommand, channel: str, prepared: Prepared | None) -> None:
        """Gives a command its meaning, for the run, the channels and the clock."""
        before, history, scenario = self._run.state, self._run.history, self._run.scenario
        self._add(self._run.apply(command, prepared))
        changed = self._run.history is not history and isinstance(command, Edit | Undo | Redo)
        rows = rows_before(self._run.history, undone=isinstance(command, Undo)) if changed else None
        self._add(self._supervisor.applied(Said(channel, command), self._run.time, before, self._run.state, rows))
        self._refuse(self._clock.command(command, stands=self._stands))
        self._follow(scenario)

    def _follow(self, former: Scenario | None) -> None:
        """After a scenario was loaded, or came back: its limits hold; what its inputs are given counts at the start."""
        scenario = self._run.scenario
        if scenario is former or scenario is None:
            return
        self._supervisor.limit(scenario.limits)
        for name in self._channels.names:
            if former is not None and scenario.inputs.get(name) != former.inputs.get(name):
                text = f"Input '{name}' keeps its settings; those of '{scenario.title}' count when the console starts."
                self._add((Event(self._run.time, Severity.WARNING, "channel", text),))

    def set_speed(self, factor: float) -> None:
        """Lets the clock run at `factor` times real time; one outside [0.25, 8] is refused with an event."""
        self._refuse(self._clock.set_speed(factor))

    def _refuse(self, text: str) -> None:
        """Reports why something was not done, where it was not."""
        if text:
            self._add((Event(self._run.time, Severity.WARNING, "refused", text),))

    def _record(self, write: Any, *arguments: object) -> None:
        try:
            write(*arguments)
        except (OSError, TypeError, ValueError) as error:  # the last two: what JSON does not know
            self._recorder = None
            text = f"The recording ends here: {getattr(error, 'strerror', None) or error}."
            self._add((Event(self._run.time, Severity.ALARM, "recording", text),))

    def _add(self, events: tuple[Event, ...]) -> None:
        if self._markers is not None:
            for event in events:
                self._markers.event(event)
        if events:
            self._events = (self._events + events)[-EVENTS_KEPT:]

    def _halt(self, error: Exception) -> None:
        _log.error("the engine failed at %.2f s; the team stands", self._run.time, exc_info=error)
        self.error = error
        self._clock.halt()
        self._run.state = halted(self._run.state)
        self._add((failure_event(error, self._run.time),))
        self._publish(perf_counter())

    def _publish(self, started: float) -> None:
        run, inputs = self._run, self._reporter.take(self._run.time)
        self.checkpoint = Checkpoint(run.run_state, run.ticks)
        for channel, report in self._reporter.new_calibrations():
            self._add((calibration_event(channel, report, run.time),))
            if self._recorder is not None:
                self._record(self._recorder.calibration, channel, report)
        self.snapshot = Snapshot(
            scenario=self.scenario,
            setup=run.setup,
            state=run.state,
            trace=run.trace,
            last=run.last,
            time=run.time,
            phase=run.phase,
            frozen=self._clock.frozen,
            speed=self._clock.speed,
            loss_area=loss_area(run.state.motion),
            min_clearance=run.tally.min_clearance,
            tick_ms=1e3 * (perf_counter() - started),
            lost_time=self._clock.lost,
            infeasible_ticks=run.tally.infeasible_ticks,
            deadlock_s=run.tally.deadlock_ticks * self.setup.params.safety.control_period,
            worst=run.tally.worst,
            extinguished=run.tally.extinguished,
            history=run.history,
            channels=self._supervisor.health,
            events=self._events,
            inputs=inputs,
        )
