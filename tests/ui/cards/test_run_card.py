"""The card of the run: which one a phase shows, and what its buttons do; without a browser."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import pytest

from higvf_console.core.commands import ContinueRun, LoadScenario, ResetRun, StartRun
from higvf_console.core.interface import PointerSink
from higvf_console.runtime.persistence.drafts import Drafts
from higvf_console.runtime.phase import Phase, RunPhase
from higvf_console.runtime.session import Session
from higvf_console.scenario.kept import Draft
from higvf_console.ui.cards import run_card
from higvf_console.ui.cards.run_card import RunCard
from higvf_console.ui.page import cards
from tests.fake_gui import PAGE, Gui

DRAFT = cast(Draft, SimpleNamespace(saved=0.0, text="version: 1"))


class Shown:
    """The card of a session, what pages see of it, and what it has done."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, drafts: Any = None) -> None:
        self.cards, self.given, self.chosen = list[tuple[str, str]](), list[Any](), list[int]()
        self.session: Any = SimpleNamespace(
            interrupted=None, attended=True, baseline=None, waits=True, scenario=SimpleNamespace(text="", name="mine")
        )
        monkeypatch.setattr(cards, "install", self._install)
        monkeypatch.setattr(cards, "show", self._show)
        for name in ("ready_html", "run_result", "result_html"):
            monkeypatch.setattr(run_card, name, self._nothing)
        self.card = RunCard(
            Gui().as_server(get_clients=dict[int, Any]),
            cast(Session, self.session),
            cast(PointerSink, SimpleNamespace(push=self.given.append)),
            cast("Drafts | None", drafts),
            self.chosen.append,
        )

    def _install(self, _server: object, act: Callable[[int, str, str], None]) -> None:
        self._act = act

    def press(self, name: str, value: str = "") -> None:
        self._act(PAGE, name, value)

    def _show(self, _server: object, kind: str, html: str) -> None:
        self.cards.append((kind, html))

    def _nothing(self, *_: object) -> str:
        return ""

    def show(self, phase: Phase) -> None:
        snapshot: Any = SimpleNamespace(
            phase=RunPhase(phase), scenario=SimpleNamespace(title="Mine"), setup=None, last=None, team=None
        )
        self.card.update(snapshot)


class KeptDraft:
    """A draft that waits to be taken up or dismissed."""

    def __init__(self) -> None:
        self.offered: Draft | None = DRAFT

    def take(self) -> Draft | None:
        taken, self.offered = self.offered, None
        return taken

    def dismiss(self) -> None:
        self.offered = None


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Shown:
    return Shown(monkeypatch)


def test_a_run_shows_its_briefing_then_nothing_then_its_result(shown: Shown) -> None:
    for phase in (Phase.READY, Phase.READY, Phase.RUNNING, Phase.ENDED):
        shown.show(phase)
    assert [kind for kind, _ in shown.cards] == ["ready", "", "ended"], "the same card is sent once"


def test_an_end_that_nobody_attends_shows_no_result(shown: Shown) -> None:
    shown.session.attended = False
    shown.show(Phase.ENDED)
    assert shown.cards == []


def test_a_run_that_was_cut_off_asks_first_whatever_its_phase(shown: Shown) -> None:
    shown.session.interrupted = 65.0
    shown.show(Phase.READY)
    ((kind, html),) = shown.cards
    assert kind == "interrupted"
    assert "1:05.0" in html
    shown.press("keep")
    shown.show(Phase.RUNNING)
    assert shown.cards[-1] == ("", "")
    assert shown.given == []


def test_each_button_gives_its_command(shown: Shown) -> None:
    shown.session.interrupted = 65.0
    for act in ("start", "continue", "again"):
        shown.press(act)
    assert shown.given == [StartRun(), ContinueRun(), ResetRun()]
    assert shown.session.interrupted is None
    shown.press("own_file")
    assert shown.chosen == [PAGE]


def test_a_button_or_a_scenario_that_is_not_offered_is_refused(shown: Shown) -> None:
    with pytest.raises(ValueError, match="button of a card"):
        shown.press("explode")
    with pytest.raises(ValueError, match="scenario"):
        shown.press("load", "../../secret.yaml")
    assert shown.given == []


def test_a_draft_is_offered_and_taken_up_once(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = Shown(monkeypatch, KeptDraft())
    shown.show(Phase.RUNNING)
    assert shown.cards[-1][0] == "draft"
    shown.press("restore")
    shown.press("restore")
    assert shown.given == [LoadScenario("version: 1", "draft.yaml", waits=True)]
    shown.show(Phase.RUNNING)
    assert shown.cards[-1] == ("", "")


def test_a_draft_can_be_dismissed(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = Shown(monkeypatch, KeptDraft())
    shown.press("dismiss")
    shown.show(Phase.RUNNING)
    assert shown.given == []
    assert shown.cards == []
