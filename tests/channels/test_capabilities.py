"""Capabilities, not names, decide how the console treats a channel."""

from dataclasses import replace

import numpy as np
import pytest

from higvf_console.channels.channel_state import OnLost
from higvf_console.channels.channels import open_interface
from higvf_console.channels.console import ConsoleChannel
from higvf_console.core.command import Command
from higvf_console.core.commands import (
    EmergencyStop,
    InjectFault,
    Pick,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    StrokeUse,
    TakeUpPath,
)
from higvf_console.core.errors import InputError
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, InputSpec, capabilities_of
from higvf_console.runtime.background.previewer import Choice, Previewer
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, parse_scenario
from tests.fake_interfaces import FakeConsole, FakeInterface

STROKE = np.array([[600.0, 350.0], [500.0, 400.0], [400.0, 400.0], [300.0, 300.0]])


class Table(FakeConsole):
    """A touch table of another package: as capable as the console's own channel; silent for a while."""

    def __init__(self, silent: float = np.inf, back: float = np.inf) -> None:
        super().__init__(name="table")
        self.silent, self.back = silent, back

    def health(self, now: float) -> ChannelHealth:
        return ChannelHealth(ChannelState.LIVE, "a table", self.silent if self.silent < now < self.back else now)


def ticked(session: Session, time: float) -> Session:
    while session.snapshot.time < time - 1e-9:
        session.tick()
    return session


def state_of(session: Session, channel: str) -> ChannelState:
    return dict(session.snapshot.channels)[channel].state


def test_an_interface_that_offers_none_has_those_of_a_device_that_is_polled() -> None:
    assert capabilities_of(FakeInterface("console")) == Capabilities()
    assert capabilities_of(FakeInterface("mouse")).stale_after == 1.0


def test_the_consoles_own_channel_is_opened_by_its_name_and_by_the_one_from_before() -> None:
    for name in ("console", "mouse"):
        opened = open_interface(InputSpec(name))
        assert isinstance(opened, ConsoleChannel)
        assert opened.name == "console"
        assert capabilities_of(opened) == Capabilities(True, True, True, 2.0)


def test_the_pages_give_their_commands_to_another_packages_channel(team: Scenario) -> None:
    table = Table()
    session = Session(team, [FakeInterface("emg"), table])
    session.pointer.push(EmergencyStop())
    session.pointer.heartbeat()
    session.tick()
    assert session.snapshot.state.intent.stopped
    assert table.heartbeats == 1


def test_of_two_channels_that_take_the_pointer_the_first_does(team: Scenario) -> None:
    table, console = Table(), FakeConsole()
    assert Session(team, [table, console]).pointer is table


def test_a_name_alone_gives_no_capability(team: Scenario) -> None:
    with pytest.raises(InputError, match=r"no input accepts the pointer and keys .*; inputs: console"):
        _ = Session(team, [FakeInterface("console")]).pointer


def test_a_channel_worked_by_hand_acknowledges_itself_and_another_does_not(team: Scenario) -> None:
    for by_hand in (True, False):
        table = Table(silent=0.1, back=9.0)
        table.capabilities = replace(table.capabilities, self_acknowledging=by_hand)
        session = ticked(Session(team, [table]), 9.2)
        assert state_of(session, "table") is ChannelState.RECOVERED
        table.push(Pick(2))
        session.tick()
        assert (session.snapshot.state.intent.influenced == 2) is by_hand
        ticked(session, 9.6)
        assert state_of(session, "table") is (ChannelState.LIVE if by_hand else ChannelState.RECOVERED)


def test_a_channel_is_stale_after_its_own_time_and_the_scenarios_goes_over_it(team: Scenario) -> None:
    session = ticked(Session(team, [Table(silent=0.1)]), 1.8)
    assert session.pointer_limits == (2.0, 8.0, OnLost.AUTONOMY)
    assert state_of(session, "table") is ChannelState.LIVE
    assert state_of(ticked(session, 2.3), "table") is ChannelState.STALE
    hasty = parse_scenario(f"{team.text}\ninputs: {{table: {{lost: 1, on_lost: hold}}}}\n", "team.yaml")
    session = Session(hasty, [Table(silent=0.1)])
    assert session.pointer_limits == (0.25, 1.0, OnLost.HOLD)
    assert state_of(ticked(session, 1.3), "table") is ChannelState.LOST


@pytest.mark.parametrize("chosen", [True, False])
def test_its_strokes_are_previewed_with_the_chosen_terms_where_it_says_so(team: Scenario, chosen: bool) -> None:
    table = Table()
    table.capabilities = replace(table.capabilities, draws_previewed=chosen)
    session = Session(team, [table])
    previewer = Previewer(session, lambda: Choice(horizon=1.0, use=StrokeUse.OBSTACLE))
    for command in (StrokeBegin(), StrokePoints(STROKE)):
        table.push(replace(command, source="table"))
    session.tick()
    previewer.look()
    assert (previewer.latest is None) is chosen, "an outline is no path that could be foreseen"


@pytest.mark.parametrize(
    ("offered", "said"),
    [
        ({"takes_pointer": True}, "interface 'odd': its capabilities are {'takes_pointer': True}, not a Capabilities"),
        (Capabilities(stale_after=0.0), "interface 'odd': stale_after: 0.0 is not a time above 0 s"),
        (Capabilities(takes_pointer=True), "interface 'odd': takes_pointer, but it has no method heartbeat"),
    ],
)
def test_capabilities_that_cannot_be_are_refused(team: Scenario, offered: object, said: str) -> None:
    odd = FakeInterface("odd")
    odd.capabilities = offered  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(InputError) as refusal:
        Session(team, [odd])
    assert str(refusal.value).startswith(said)


def test_a_fault_for_a_channel_by_its_name_from_before_is_injected_with_a_warning(team: Scenario) -> None:
    session = Session(team, [FakeConsole((0.0, InjectFault(channel="mouse", kind="drop", seconds=1.0)))])
    session.tick()
    (event,) = (event for event in session.snapshot.events if event.kind == "channel")
    assert event.text == (
        "Fault injected: drop of input 'console' for 1 s. The channel 'mouse' is renamed; write 'console'."
    )


def test_a_scenarios_section_of_a_channel_may_have_its_name_from_before(team: Scenario) -> None:
    scenario = parse_scenario(f"{team.text}\ninputs: {{mouse: {{stale: 30, lost: 60}}}}\n", "team.yaml")
    assert scenario.warnings == ("team.yaml: inputs.mouse: channel 'mouse' is renamed; write 'console'",)
    assert Session(scenario, [FakeConsole()]).pointer_limits.lost == 60.0


def test_commands_are_the_consoles_unless_they_say_otherwise() -> None:
    assert Command().source == "console"
    assert StrokeEnd().source == TakeUpPath(0).source == "console"
