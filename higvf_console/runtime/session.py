"""A session: the one loop between operator and team.

    each tick:  poll the interfaces -> apply their commands -> watch the channels -> advance -> record -> publish

STOP is looked for before each command. A run in real time gives commands a share of each control period, and what does
not fit in waits for the next one.

The session owns the clock (freeze, step, speed). Views read `snapshot`, which is immutable and replaced as a whole.
"""

import logging
import math
from collections.abc import Iterable
from threading import Event as Signal
from threading import Thread
from time import perf_counter
from typing import cast

from higvf_console.analysis.baseline import Baseline
from higvf_console.channels.channel_state import Limits
from higvf_console.channels.channels import Channels
from higvf_console.channels.input_reports import InputReports, Reporter
from higvf_console.channels.marker_outlet import MarkerOutlet
from higvf_console.channels.supervision import Said, Supervisor
from higvf_console.core.arguments import instance, whole
from higvf_console.core.command import SESSION
from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import Interface, OperatorContext, PointerSink, Targets
from higvf_console.core.limiter import Limiter
from higvf_console.core.reports import Calibrated
from higvf_console.core.team import Picture
from higvf_console.core.viewport import Viewport
from higvf_console.runtime.admission import Admission
from higvf_console.runtime.background.baseline_thread import keep_baseline
from higvf_console.runtime.background.loader import Loader
from higvf_console.runtime.background.worker import Worker
from higvf_console.runtime.clock import Clock
from higvf_console.runtime.compiling import announce
from higvf_console.runtime.execution import Executor
from higvf_console.runtime.failsafe import failure_event, halted, interruption_event
from higvf_console.runtime.inputs import opening_warnings
from higvf_console.runtime.journal import Journal
from higvf_console.runtime.persistence.checkpoints import Checkpoint
from higvf_console.runtime.phase import Phase, RunPhase
from higvf_console.runtime.recording import Recorder
from higvf_console.runtime.run import Run
from higvf_console.runtime.snapshot import snapshot_of
from higvf_console.runtime.team_exchange import TeamExchange
from higvf_console.scenario.scenario import Scenario
from higvf_console.team.driver import TeamDriver
from higvf_console.world.setup import Setup

HELD_UP = 5.0  # time lost at once that is reported by itself [s]
COMMAND_SHARE = 0.25  # of a control period, for the commands of a run in real time
_WATCH_EVERY = 5  # ticks from one look after the channels to the next
_TOLD_LOST = 0.05  # the run lags by less than this without a message, which would say 0.0 s [s]

_log = logging.getLogger(__name__)


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
        team: TeamDriver | None = None,
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
            team: robots that drive; None = they are integrated here.

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
        self.error: Exception | None = None
        self.answered = Signal()
        phase = RunPhase(Phase.READY if waits else Phase.RUNNING)
        self.attended, self.waits = attended, waits
        rules = None if team is None else team.rules
        self._run = Run(scenario.setup(seed), scenario.filter, scenario, phase, timed=attended, rules=rules)
        self.interrupted = None if interrupted is None else interrupted.time
        if interrupted is not None:
            self._run.restore(*interrupted.stopped())
        self._channels = Channels(interfaces)
        self._supervisor = Supervisor(self._channels, scenario.limits)
        self._reporter = Reporter(self._channels, self._run.setup.params.safety.control_period)
        self._admission = Admission()
        self.command_time = math.inf  # for the commands of one tick [s]
        self._limiter = Limiter()
        self._clock = Clock(real_time=team is not None)
        self._markers = markers
        self._journal = Journal(recorder, markers)
        self.commands = self._journal.commands
        self._exchange = TeamExchange(team, self._run, self._journal)
        self.worker = worker
        loader = None if worker is None else Loader(worker)
        self._executor = Executor(self._run, self._channels, self._supervisor, self._clock, self._journal, loader)
        self._heartbeats = 0
        self._journal.add(opening_warnings(scenario, self._channels))
        if self.interrupted is not None:
            self._journal.add((interruption_event(self.interrupted),))
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
    def has_picture(self) -> bool:
        """Whether a camera shows the arena."""
        return self._exchange.has_picture

    def picture(self) -> Picture | None:
        """The newest picture of that camera; None = there is none yet. May be called on any thread."""
        return self._exchange.picture()

    @property
    def ticks(self) -> int:
        """Control periods done; a reset of the run does not set it back."""
        return self._run.ticks

    def tick(self, *, advance: bool = True) -> None:
        """Polls and applies, then advances by one control period unless the clock stands, and publishes.

        Args:
            advance: False polls, applies and publishes only (between the ticks of a slowed clock).
        """
        started, known = perf_counter(), self._journal.applied
        self._exchange.hear()
        self._attend()
        self._exchange.stop_if_asked()
        advance = self._clock.advances(wanted=advance)
        if advance and not self._run.stands:
            self._journal.add(self._run.step())
            self._journal.step(self._run.time, self._run.state.motion)
        self._exchange.answer()
        self._journal.keep(self._run.time)
        self._publish(started)
        if self._journal.applied > known:
            self.answered.set()

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
            if lost >= HELD_UP:
                self._report_hold_up(lost)
            elif lost > 0.0:
                self._report_lateness()

    def close(self) -> None:
        """Closes the interfaces and completes the recording."""
        try:
            self._exchange.close()
            self._channels.close()
        finally:
            known = self._journal.events
            self._journal.close(self._run.time)
            if self._journal.events is not known:  # the recording could not be completed
                self._publish(perf_counter())
            if self._markers is not None:
                self._markers.close()

    def _report_lateness(self) -> None:
        if self._clock.lost < _TOLD_LOST or self._run.stands:
            return
        if count := self._limiter.due("late", perf_counter()):
            delays = f"{count} new delay" + "s" * (count > 1)
            text = f"The computer is busy: the run lags {self._clock.lost:.1f} s behind real time ({delays})."
            self._journal.add((Event(self._run.time, Severity.WARNING, "late", text),))

    def _report_hold_up(self, lost: float) -> None:
        """Reports each time for which the loop stood, which no report a minute could tell."""
        text = f"The console was held up for {lost:.1f} s: the run stood meanwhile, and goes on from there."
        self._journal.add((Event(self._run.time, Severity.WARNING, "late", text),))

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
        self._executor.execute_loaded()
        said, failures = self._supervisor.poll(context)
        self._admission.take_in(said)
        self._apply_waiting(context)
        self._journal.add(failures)
        if failures or self._heartbeats % _WATCH_EVERY == 0:
            commands, events = self._supervisor.watch(self._run.time, self._run.state)
            self._journal.add(events)
            for command in commands:
                self._executor.execute(command, SESSION)
        self._heartbeats += 1

    def _apply_waiting(self, context: OperatorContext) -> None:
        """Applies what waits, STOP first, until all is done or the time for it is used up."""
        end = perf_counter() + self.command_time
        while True:
            self._admission.take_in(Said(*stop) for stop in self._channels.take_stops(context))
            said = self._admission.next()
            if said is None:
                break
            self._executor.execute(said.command, said.channel)
            if perf_counter() >= end:
                self._admission.yield_turn()
                break
        for channel, dropped in self._admission.take_dropped().items():
            if count := self._limiter.due(("dropped", channel), perf_counter(), dropped):
                text = f"Input '{channel}' sends faster than commands can be applied: {count} were dropped."
                self._journal.add((Event(self._run.time, Severity.WARNING, "channel", text),))

    def set_speed(self, factor: float) -> None:
        """Lets the clock run at `factor` times real time; one outside [0.25, 8] is refused with an event."""
        self._journal.refuse(self._run.time, self._clock.set_speed(factor))

    def _halt(self, error: Exception) -> None:
        _log.error("the engine failed at %.2f s; the team stands", self._run.time, exc_info=error)
        self.error = error
        self._clock.halt()
        self._run.state = halted(self._run.state)
        self._exchange.stop()
        self._journal.add((failure_event(error, self._run.time),))
        self._publish(perf_counter())

    def _publish(self, started: float) -> None:
        run, inputs = self._run, self._reporter.take(self._run.time)
        self.checkpoint = Checkpoint(run.run_state, run.ticks)
        for channel, report in self._reporter.new_calibrations():
            self._journal.calibration(run.time, channel, report)
        self.snapshot = snapshot_of(
            run,
            self._clock,
            self._supervisor.health,
            self._journal.events,
            inputs,
            tick_ms=1e3 * (perf_counter() - started),
        )
