"""The executor: what one command does to run, clock and journal; a command that fails changes nothing."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from higvf_console.channels.channels import Channels
from higvf_console.channels.supervision import Supervisor
from higvf_console.core.commands import Acknowledge, EmergencyStop, Freeze, LoadScenario, OperatorCommand, Pick, Undo
from higvf_console.runtime.background.loader import Loaded, Loader
from higvf_console.runtime.clock import Clock
from higvf_console.runtime.dispatch import prepare
from higvf_console.runtime.execution import Executor
from higvf_console.runtime.journal import Journal
from higvf_console.runtime.recording import Recorder
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import Scenario

OTHER = "version: 1\nname: other\narena: {size_m: [400, 300]}\nrobots: {start_m: [[100, 150], [100, 200]]}\n"

pytestmark = pytest.mark.usefixtures("plain_kernels")


class Executed:
    """A run of three robots, and what its executor has told the others."""

    def __init__(self, scenario: Scenario, loader: Loader | None = None) -> None:
        self.run, self.clock = Run(scenario.setup(3), scenario=scenario), Clock()
        self.applied, self.recorded, self.limits = list[OperatorCommand](), list[Any](), list[Any]()
        self.journal = Journal(cast(Recorder, SimpleNamespace(command=self._record)))
        supervisor = SimpleNamespace(applied=self._applied, limit=self.limits.append)
        self.executor = Executor(
            self.run,
            cast(Channels, SimpleNamespace(names=("gaze",))),
            cast(Supervisor, supervisor),
            self.clock,
            self.journal,
            loader,
        )

    def _record(self, command: OperatorCommand, _: Scenario | None) -> None:
        self.recorded.append(command)

    def _applied(self, said: Any, *_: object) -> tuple[()]:
        self.applied.append(said.command)
        return ()

    def give(self, *commands: Any) -> list[str]:
        """The texts of the events of some commands."""
        before = len(self.journal.events)
        for command in commands:
            self.executor.execute(command, "console")
        return [event.text for event in self.journal.events[before:]]


@pytest.fixture(name="executed")
def _executed(team: Scenario) -> Executed:
    return Executed(team)


def test_a_command_changes_the_run_and_is_written_down(executed: Executed) -> None:
    executed.give(Pick(2), Freeze(True))
    assert executed.run.state.intent.influenced == 2
    assert executed.clock.frozen
    assert [entry.command for entry in executed.journal.commands] == [Pick(2), Freeze(True)]
    assert executed.applied == executed.recorded == [Pick(2), Freeze(True)]


def test_an_action_can_be_undone_by_the_next_command(executed: Executed) -> None:
    executed.give(Pick(2), Undo())
    assert executed.run.state.intent.influenced == 0


def test_a_command_that_fails_changes_nothing_and_names_its_input(executed: Executed) -> None:
    before = executed.run.state
    (text,) = executed.give(Pick(cast(int, "two"), source="emg"))
    assert text.startswith("Input 'emg' sent Pick, which cannot be used: ")
    assert executed.run.state is before
    assert executed.journal.applied == 0


def test_a_stop_that_is_active_already_costs_nothing(executed: Executed) -> None:
    executed.give(EmergencyStop())
    assert executed.run.state.intent.stopped
    assert executed.give(EmergencyStop()) == []
    assert executed.journal.applied == 1


def test_a_scenario_goes_into_force_with_its_limits(executed: Executed) -> None:
    executed.give(LoadScenario(OTHER, "other.yaml"))
    assert executed.run.scenario is not None
    assert executed.run.scenario.name == "other"
    assert len(executed.limits) == 1


def test_a_scenario_that_cannot_be_read_is_refused_and_not_recorded(executed: Executed) -> None:
    (text,) = executed.give(LoadScenario("version: 1\narena: 7\n", "bad.yaml"))
    assert text.startswith("Not done: ")
    assert executed.recorded == []
    assert executed.limits == []


def test_with_a_loader_a_scenario_is_prepared_elsewhere_and_taken_when_it_is_ready(team: Scenario) -> None:
    submitted: list[LoadScenario] = []
    ready: list[Loaded] = []

    def submit(_channel: str, command: LoadScenario, _seed: int) -> None:
        submitted.append(command)

    loader = SimpleNamespace(submit=submit, take=lambda: ready)
    executed = Executed(team, cast(Loader, loader))
    command = LoadScenario(OTHER, "other.yaml")
    assert executed.give(command) == []
    assert submitted == [command]
    assert executed.run.scenario is team
    said: Any = SimpleNamespace(command=command, channel="console")
    ready += [Loaded(said, None, "it is empty"), Loaded(said, prepare(command, 0))]
    executed.executor.execute_loaded()
    assert any("Not done: it is empty." in event.text for event in executed.journal.events)
    assert executed.run.scenario is not None
    assert executed.run.scenario.name == "other"


def test_what_concerns_neither_run_nor_clock_reaches_the_supervisor(executed: Executed) -> None:
    executed.give(Acknowledge())
    assert executed.applied == [Acknowledge()]
