"""Gives each command of a session its meaning: in the run, for the channels, on the clock; and writes it down."""

from higvf_console.channels.channels import Channels
from higvf_console.channels.supervision import Said, Supervisor
from higvf_console.core.commands import EmergencyStop, LoadScenario, OperatorCommand, Redo, Undo
from higvf_console.core.edits import Edit
from higvf_console.core.events import Event, Severity
from higvf_console.runtime.background.loader import Loader
from higvf_console.runtime.clock import Clock
from higvf_console.runtime.dispatch import Prepared, seed_of
from higvf_console.runtime.history import rows_before
from higvf_console.runtime.journal import Journal
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import Scenario


class Executor:
    """Executes commands; one that fails changes nothing and is reported."""

    def __init__(
        self,
        run: Run,
        channels: Channels,
        supervisor: Supervisor,
        clock: Clock,
        journal: Journal,
        loader: Loader | None = None,
    ) -> None:
        """Executes nothing yet.

        Args:
            run: what commands change.
            channels: where they come from.
            supervisor: learns what was applied, and the limits of a scenario that is loaded.
            clock: follows commands such as Freeze.
            journal: has what was applied, and what was refused and why.
            loader: prepares scenarios; None = they are read here, and the team waits.
        """
        self._run, self._clock, self._journal = run, clock, journal
        self._channels, self._supervisor, self._loader = channels, supervisor, loader

    def execute(self, command: OperatorCommand, channel: str, prepared: Prepared | None = None) -> None:
        """Executes a command; one that loads a scenario begins to prepare it.

        Args:
            command: what is asked for.
            channel: by whom.
            prepared: of a LoadScenario, what it was prepared to.
        """
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
            text = f"Input '{source}' sent {type(command).__name__}, which cannot be used: {error}"
            self._journal.refuse(self._run.time, text)
            return
        refused = isinstance(command, LoadScenario) and self._run.scenario is former
        self._journal.command(self._run.time, command, self._run.scenario, recorded=not refused)

    def execute_loaded(self) -> None:
        """Goes over to the scenarios that have been prepared meanwhile."""
        for loaded in () if self._loader is None else self._loader.take():
            if loaded.prepared is None:
                self._journal.refuse(self._run.time, f"Not done: {loaded.refusal}.")
            else:
                self.execute(loaded.said.command, loaded.said.channel, loaded.prepared)

    def _latched(self) -> bool:
        """Whether a STOP is active and nobody has begun to reset it."""
        state = self._run.state
        return state.intent.stopped and not state.pointer_state.ask_reset

    def _give(self, command: OperatorCommand, channel: str, prepared: Prepared | None) -> None:
        run, add = self._run, self._journal.add
        before, history, scenario = run.state, run.history, run.scenario
        add(run.apply(command, prepared))
        changed = run.history is not history and isinstance(command, Edit | Undo | Redo)
        rows = rows_before(run.history, undone=isinstance(command, Undo)) if changed else None
        add(self._supervisor.applied(Said(channel, command), run.time, before, run.state, rows))
        self._journal.refuse(run.time, self._clock.command(command, stands=run.stands))
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
                self._journal.add((Event(self._run.time, Severity.WARNING, "channel", text),))
