"""The states of the run that hold together, in words."""

from types import SimpleNamespace
from typing import Any

import pytest

from higvf_console.ui.run_state import FROZEN, PAUSED, RUNNING, STOPPED, run_states
from higvf_console.ui.theme import Palette


def snapshot(*, paused: bool = False, stopped: bool = False, frozen: bool = False) -> Any:
    return SimpleNamespace(state=SimpleNamespace(intent=SimpleNamespace(paused=paused, stopped=stopped)), frozen=frozen)


@pytest.mark.parametrize(
    ("shown", "words"),
    [
        ({}, ["RUNNING"]),
        ({"paused": True}, ["PAUSED"]),
        ({"paused": True, "frozen": True}, ["PAUSED", "FROZEN"]),
        ({"paused": True, "stopped": True}, ["STOPPED"]),
        ({"paused": True, "stopped": True, "frozen": True}, ["STOPPED", "FROZEN"]),
    ],
)
def test_all_that_holds_is_said_the_gravest_first(shown: dict[str, bool], words: list[str]) -> None:
    assert [state.word for state in run_states(snapshot(**shown))] == words


def test_each_state_has_a_colour_of_its_own_and_one_sentence() -> None:
    states = (STOPPED, PAUSED, FROZEN, RUNNING)
    assert len({state.colour for state in states}) == len(states)
    assert {state.colour for state in states} <= set(Palette._fields)
    assert all(state.text.endswith(".") for state in states)
