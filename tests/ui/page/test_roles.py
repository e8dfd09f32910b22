"""Which messages pass the gate, by role; pages are played by hand."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import pytest
import viser

from higvf_console.core.awake import AwakeClock
from higvf_console.core.commands import (
    ControlChange,
    EmergencyStop,
    HandOver,
    InjectFault,
    LoadScenario,
    OperatorCommand,
    Pause,
)
from higvf_console.core.edits import DeleteEntity
from higvf_console.core.interface import PointerSink
from higvf_console.ui.page import page
from higvf_console.ui.page.access import Role
from higvf_console.ui.page.message_filter import FilterSettings
from higvf_console.ui.page.roles import Roles

CLIENT = 1


def nothing(*_: object) -> None:
    """Does nothing."""


class Pages:
    """One page of a role that has control; notes what it is told."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, role: Role) -> None:
        self.told: list[str] = []
        self.given: list[OperatorCommand] = []
        self.listeners: dict[str, Callable[[int, page.Body], None]] = {}
        self.allows: Callable[[int, str, page.Body], bool] | None = None
        self._role = role
        for name in ("listen", "gate", "call", "role_of"):
            monkeypatch.setattr(page, name, getattr(self, name))
        for name in ("install", "on_leave"):
            monkeypatch.setattr(page, name, nothing)
        sink = cast(PointerSink, SimpleNamespace(push=self.given.append, heartbeat=lambda: None))
        self.roles = Roles(cast(viser.ViserServer, object()), sink, 10.0)
        self.roles.install(nothing)
        self.listeners["hello"](CLIENT, {"identity": "the only page here"})
        self.told.clear()

    def listen(self, _server: object, topic: str, hears: Callable[[int, page.Body], None]) -> None:
        self.listeners[topic] = hears

    def gate(self, _server: object, allows: Callable[[int, str, page.Body], bool], _tell: object) -> None:
        self.allows = allows

    def call(self, _server: object, _script: str, method: str, _argument: object, _client: int) -> None:
        self.told.append(method)

    def role_of(self, _server: object, _client: int) -> Role:
        return self._role

    def become(self, role: Role) -> None:
        """As a page of another login that says the same identity."""
        self._role = role

    def may(self, topic: str, **body: Any) -> bool:
        assert self.allows is not None
        return self.allows(CLIENT, topic, body)


@pytest.mark.parametrize("role", Role)
def test_what_changes_the_world_needs_an_experimenter(monkeypatch: pytest.MonkeyPatch, role: Role) -> None:
    pages = Pages(monkeypatch, role)
    for act in ("load", "own_file", "restore", "dismiss"):
        assert pages.may("card", act=act, value="") is (role is Role.EXPERIMENTER)
    assert pages.may("file", kind="scenario") is (role is Role.EXPERIMENTER)


@pytest.mark.parametrize("role", [Role.OPERATOR, Role.EXPERIMENTER])
def test_commands_of_widgets_that_change_the_world_do_too(monkeypatch: pytest.MonkeyPatch, role: Role) -> None:
    pages = Pages(monkeypatch, role)
    pages.given.clear()
    pages.roles.push(Pause())
    pages.roles.push(DeleteEntity("fire", 0))
    pages.roles.push(LoadScenario(text="", name=""))
    pages.roles.push(InjectFault("console"))
    assert len(pages.given) == (4 if role is Role.EXPERIMENTER else 1)
    assert pages.told == ([] if role is Role.EXPERIMENTER else ["lacks"] * 3)


@pytest.mark.parametrize("act", ["ask", "take"])
def test_an_observer_gets_no_control(monkeypatch: pytest.MonkeyPatch, act: str) -> None:
    pages = Pages(monkeypatch, Role.OBSERVER)
    pages.listeners["control"](CLIENT, {"act": act, "page": ""})
    assert not [command for command in pages.given if isinstance(command, HandOver)]
    assert pages.told == ["lacks"]


def test_an_observer_that_goes_by_the_identity_of_the_page_in_control_may_still_not_steer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pages = Pages(monkeypatch, Role.OPERATOR)
    assert pages.may("key", name="pick_1", number=0)
    pages.become(Role.OBSERVER)
    assert not pages.roles.steers(CLIENT)
    assert not pages.may("key", name="pick_1", number=0)
    assert pages.may("key", name="stop", number=0)


@pytest.mark.parametrize("role", Role)
def test_what_steers_needs_an_operator(monkeypatch: pytest.MonkeyPatch, role: Role) -> None:
    pages = Pages(monkeypatch, role)
    steers = role is not Role.OBSERVER
    assert pages.may("card", act="start", value="") is steers
    assert pages.may("run", act="pause", value="") is steers
    assert pages.may("stroke", phase="start") is steers
    assert ("refused" in pages.told) is not steers


@pytest.mark.parametrize("role", Role)
def test_every_role_may_stop(monkeypatch: pytest.MonkeyPatch, role: Role) -> None:
    pages = Pages(monkeypatch, role)
    assert pages.may("key", name="stop", number=1)
    pages.roles.push_of(CLIENT, EmergencyStop())
    assert EmergencyStop in map(type, pages.given)


def test_a_page_keeps_control_while_the_console_itself_was_stopped_and_loses_it_by_silence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wall = [100.0]
    monkeypatch.setattr("higvf_console.ui.page.roles.AwakeClock", lambda: AwakeClock(lambda: wall[0]))

    def settings_of(_: object) -> FilterSettings:
        return FilterSettings()

    def dropped(_: object) -> dict[int, int]:
        return {}

    monkeypatch.setattr("higvf_console.ui.page.roles.settings_of", settings_of)
    monkeypatch.setattr(page, "dropped", dropped)
    pages = Pages(monkeypatch, Role.OPERATOR)
    pages.given.clear()
    wall[0] += 60.0
    pages.roles.update()
    assert pages.roles.steers(CLIENT)
    assert not pages.given
    for _ in range(20):
        wall[0] += 0.5
        pages.roles.update()
    assert not pages.roles.steers(CLIENT)
    assert [command.how for command in pages.given if isinstance(command, HandOver)] == [ControlChange.LOST]
    pages.listeners["hello"](CLIENT, {"identity": "the only page here"})
    assert pages.roles.steers(CLIENT)
