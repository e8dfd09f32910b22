"""The states of the run that hold together, in words."""

from types import SimpleNamespace
from typing import Any

import pytest

from higvf_console.runtime.phase import Phase, RunPhase
from higvf_console.team.state import Arming, opened
from higvf_console.ui.run_state import ENDED, FROZEN, PAUSED, READY, RUNNING, STOPPED, run_states
from higvf_console.ui.theme import Palette


def snapshot(
    *,
    paused: bool = False,
    stopped: bool = False,
    frozen: bool = False,
    phase: Phase = Phase.RUNNING,
    arming: Arming | None = None,
) -> Any:
    intent = SimpleNamespace(paused=paused, stopped=stopped)
    team = None if arming is None else opened(3)._replace(arming=arming)
    return SimpleNamespace(state=SimpleNamespace(intent=intent), frozen=frozen, phase=RunPhase(phase), team=team)


@pytest.mark.parametrize(
    ("shown", "words"),
    [
        ({}, ["RUNNING"]),
        ({"paused": True}, ["PAUSED"]),
        ({"paused": True, "frozen": True}, ["PAUSED", "FROZEN"]),
        ({"paused": True, "stopped": True}, ["STOPPED"]),
        ({"paused": True, "stopped": True, "frozen": True}, ["STOPPED", "FROZEN"]),
        ({"phase": Phase.CONTINUED}, ["RUNNING"]),
        ({"phase": Phase.READY, "frozen": True}, ["READY", "FROZEN"]),
        ({"phase": Phase.ENDED, "paused": True}, ["PAUSED", "ENDED"]),
        ({"arming": Arming.DISARMED}, ["DISARMED"]),
        ({"arming": Arming.CHECKING, "phase": Phase.READY}, ["CHECKING", "READY"]),
        ({"arming": Arming.CHECKED, "stopped": True}, ["STOPPED", "CHECKED"]),
        ({"arming": Arming.ARMED}, ["RUNNING"]),
    ],
)
def test_all_that_holds_is_said_the_gravest_first(shown: dict[str, Any], words: list[str]) -> None:
    assert [state.word for state in run_states(snapshot(**shown))] == words


def test_each_state_has_a_colour_of_its_own_and_one_sentence() -> None:
    assert len({state.colour for state in (STOPPED, PAUSED, FROZEN, RUNNING)}) == 4
    states = (STOPPED, PAUSED, FROZEN, RUNNING, READY, ENDED)
    assert {state.colour for state in states} <= set(Palette._fields)
    assert all(state.text.endswith(".") for state in states)
