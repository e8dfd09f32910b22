"""A preview is renewed while it may still change, and gone when there is nothing left to foresee."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from higvf_console.analysis.preview import Preview, foresee
from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    Confirm,
    Discard,
    EmergencyStop,
    LoadScenario,
    OperatorCommand,
    StrokeBegin,
    StrokeCancel,
    StrokeEnd,
    StrokePoints,
    StrokeUse,
)
from higvf_console.core.path_terms import PathTerms
from higvf_console.runtime.background import previewer as module
from higvf_console.runtime.background.previewer import Choice, Previewer
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario
from higvf_console.scenario.sections import FilterKind
from tests.fake_interfaces import FakeConsole

LINE = floats([[700.0, 300.0], [500.0, 320.0], [300.0, 250.0], [200.0, 300.0]])
DRAWING: list[OperatorCommand] = [StrokeBegin(), StrokePoints(LINE[:3])]


class Desk:
    """A session whose ticks are given by hand, and its previewer."""

    def __init__(self, scenario: Scenario) -> None:
        self.hand = FakeConsole()
        self.session = Session(scenario, [self.hand], seed=1)
        self.choice = Choice(horizon=4.0)
        self.previewer = Previewer(self.session, lambda: self.choice)

    def give(self, *commands: OperatorCommand, advance: bool = False) -> Preview | None:
        for command in commands:
            self.hand.push(command)
        self.session.tick(advance=advance)
        self.previewer.look()
        return self.previewer.latest


@pytest.fixture
def desk(team: Scenario) -> Desk:
    return Desk(team)


def test_a_preview_of_what_waits_is_bit_for_bit_the_session_after_its_confirmation(desk: Desk) -> None:
    for _ in range(40):
        desk.session.tick()
    preview = desk.give(*DRAWING, StrokeEnd(preview=True))
    assert preview is not None
    desk.give(Confirm())
    for _ in range(200):
        desk.session.tick()
    now = desk.session.snapshot
    assert preview.tracks[:, -1].tobytes() == now.state.motion.position.tobytes()
    assert preview.future.loss_area == now.loss_area.sum()


def test_a_stroke_that_grows_is_foreseen_anew_and_one_that_rests_is_not(desk: Desk) -> None:
    assert desk.give() is None
    first = desk.give(*DRAWING)
    assert first is not None
    assert desk.give() is first
    grown = desk.give(StrokePoints(LINE[3:]))
    assert grown is not None
    assert grown.start.intent.path.length > first.start.intent.path.length + 50.0


def test_another_horizon_is_another_preview(desk: Desk) -> None:
    desk.give(*DRAWING)
    desk.choice = Choice(horizon=6.0)
    further = desk.give()
    assert further is not None
    assert further.horizon == pytest.approx(6.0)


@pytest.mark.parametrize("ending", [StrokeCancel(), StrokeEnd()])
def test_nothing_is_foreseen_once_the_stroke_is_cancelled_or_followed(desk: Desk, ending: OperatorCommand) -> None:
    assert desk.give(*DRAWING) is not None
    assert desk.give(ending) is None


@pytest.mark.parametrize("ending", [Discard(), Confirm(), EmergencyStop()])
def test_nothing_is_foreseen_once_nothing_waits(desk: Desk, ending: OperatorCommand) -> None:
    assert desk.give(*DRAWING, StrokeEnd(preview=True)) is not None
    assert desk.give(ending) is None


def test_a_preview_that_was_overtaken_while_it_was_made_is_not_shown(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    def slow(*arguments: Any) -> Preview | None:
        found = foresee(*arguments)
        assert found is not None
        desk.hand.push(Discard())
        desk.session.tick(advance=False)
        return found

    monkeypatch.setattr(module, "foresee", slow)
    assert desk.give(*DRAWING, StrokeEnd(preview=True)) is None
    assert desk.previewer.count == 0


def test_the_thread_looks_ahead_by_itself_and_ends(desk: Desk) -> None:
    shown: list[Preview] = []
    desk.previewer.start()
    desk.hand.plan += [(0.0, command) for command in DRAWING]
    desk.session.tick()
    while not shown:
        if desk.previewer.latest is not None:
            shown.append(desk.previewer.latest)
    desk.previewer.close()
    desk.previewer.close()
    assert np.isfinite(shown[0].tracks).all()


def test_with_the_centralised_filter_nothing_is_foreseen(team: Scenario) -> None:
    desk = Desk(dataclasses.replace(team, filter=FilterKind.CENTRALISED))
    assert not desk.previewer.available


def test_the_stroke_is_foreseen_as_the_operator_chose_to_end_it(desk: Desk) -> None:
    plain = desk.give(*DRAWING)
    desk.choice = Choice(horizon=4.0, terms=PathTerms(ending="hold", pace=0.5, duration=2.0))
    chosen = desk.give()
    assert plain is not None
    assert chosen is not None
    path = chosen.start.intent.path
    assert (path.pace, path.duration) == (0.5, 2.0)
    assert path.ending != plain.start.intent.path.ending
    desk.choice = Choice(horizon=4.0, use=StrokeUse.OBSTACLE)
    assert desk.give() is None


def test_a_scenario_with_the_centralised_filter_that_is_loaded_ends_the_looking_ahead(desk: Desk) -> None:
    assert desk.give(*DRAWING) is not None
    text = desk.session.scenario.text + "filter: centralised\n"
    assert desk.give(LoadScenario(text=text, name="other.yaml"), *DRAWING) is None
    assert not desk.previewer.available


def test_the_rehearsal_goes_through_a_whole_preview(team: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    foreseen: list[object] = []

    def note(*given: object) -> None:
        foreseen.append(given)

    monkeypatch.setattr(module, "foresee", note)
    module.rehearse(team.setup(0))
    assert len(foreseen) == 1
