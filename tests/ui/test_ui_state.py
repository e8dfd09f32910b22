"""What is chosen in the browser is in one place: replaced as a whole, from any thread, and seen by all."""

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import viser

from higvf_console.control.guidance.paths import sketch_path
from higvf_console.core.arrays import floats
from higvf_console.core.commands import OperatorCommand, ShapePath, StrokeEnd, StrokeUse
from higvf_console.core.interface import PointerSink
from higvf_console.core.path_terms import PathTerms, terms_of_stroke
from higvf_console.core.scale import USUAL_SCALE
from higvf_console.core.state import NO_PATH, Path
from higvf_console.core.viewport import Viewport
from higvf_console.operator.path_commands import with_terms
from higvf_console.runtime.background.previewer import Choice
from higvf_console.runtime.session import Session
from higvf_console.ui.console import Console
from higvf_console.ui.interaction.arena import ArenaInteraction
from higvf_console.ui.interaction.grips import Drag
from higvf_console.ui.interaction.tools import Tool
from higvf_console.ui.page.roles import Roles
from higvf_console.ui.panels.view import ViewPanel
from higvf_console.ui.theme import LIGHT
from higvf_console.ui.ui_state import (
    MOST_LINKED,
    UiState,
    UiStore,
    begin_scenario,
    change_look,
    end_of_stroke,
    follow_path,
    move_drag,
)
from higvf_console.ui.widgets.terms import TermsWidgets
from tests.page_actions import no_page
from tests.teams import team

PATH = with_terms(sketch_path(floats([[100, 100], [200, 150], [300, 100]]), 0.0), PathTerms("hold", 0.5, 30.0))
PAGE = 7


class Widget:
    """A widget that a page may touch."""

    update_timestamp = 0.0

    def __init__(self, value: object) -> None:
        self.value, self.react = value, cast(Any, None)

    def on_update(self, react: Callable[[Any], Any]) -> None:
        self.react = react

    def touch(self, value: object) -> None:
        event = SimpleNamespace(client_id=PAGE, client=None, target=SimpleNamespace(value=value))
        with ThreadPoolExecutor(1) as server:  # as viser does; this thread may have a loop of a browser test
            server.submit(lambda: asyncio.run(self.react(event))).result()


class Gui:
    """Makes widgets; `widgets` has them by label."""

    def __init__(self) -> None:
        self.widgets: dict[str, Widget] = {}

    def _add(self, label: str, value: object = None, *_: object, **options: object) -> Widget:
        self.widgets[label] = Widget(options.get("initial_value", value))
        return self.widgets[label]

    def __getattr__(self, name: str) -> Callable[..., Widget]:
        return self._add


def hand_over_a_team(ui: UiStore, given: list[OperatorCommand]) -> ArenaInteraction:
    setup = team(robots=[(100.0, 100.0), (300.0, 100.0)])
    snapshot = SimpleNamespace(setup=setup, state=setup.start, frozen=False, time=0.0)
    session = cast(Session, SimpleNamespace(setup=setup, snapshot=snapshot, viewport=None))
    roles = cast(Roles, SimpleNamespace(push=given.append, steers={PAGE}.__contains__))
    hand = ArenaInteraction(session, ui, roles, no_page())
    hand.viewport(PAGE, Viewport(1200.0, 700.0, 600.0, 350.0, 1.0))
    return hand


def draw(hand: ArenaInteraction) -> None:
    hand.stroke(PAGE, "start", floats([[100.0, 100.0]]))
    hand.stroke(PAGE, "end", floats([[200.0, 150.0]]))


def test_a_state_that_was_read_never_changes() -> None:
    ui = UiStore()
    before = ui.state
    ui.update(trails=False, horizon=40.0)
    assert (before.trails, before.horizon) == (True, 20.0)
    assert (ui.state.trails, ui.state.horizon) == (False, 40.0)
    with pytest.raises(AttributeError):
        before.trails = False  # pyright: ignore[reportAttributeAccessIssue]


def test_what_is_no_part_of_the_state_is_refused_and_changes_nothing() -> None:
    ui = UiStore()
    before = ui.state
    with pytest.raises(TypeError, match="trials"):
        ui.update(trials=False, links=False)
    assert ui.state is before


def test_no_change_is_lost_whatever_threads_make_it() -> None:
    ui, start = UiStore(), threading.Barrier(4)

    def count() -> None:
        start.wait()
        for _ in range(500):
            ui.change(lambda state: replace(state, among=state.among + 1))

    threads = [threading.Thread(target=count) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert ui.state.among == 2000


def test_what_changes_together_is_never_seen_apart() -> None:
    ui, seen, stopping = UiStore(UiState(among=0, horizon=0.0)), set[bool](), threading.Event()

    def watch() -> None:
        while not stopping.is_set():
            state = ui.state
            seen.add(state.among == state.horizon)

    watcher = threading.Thread(target=watch)
    watcher.start()
    for number in range(2000):
        ui.update(among=number, horizon=float(number))
    stopping.set()
    watcher.join()
    assert seen == {True}


def test_a_subscriber_sees_each_change_once_in_order_until_it_ends() -> None:
    ui, seen = UiStore(), list[tuple[int, int]]()
    end = ui.subscribe(lambda before, now: seen.append((before.among, now.among)))
    ui.update(among=1)
    ui.change(lambda state: state)
    ui.update(among=2)
    end()
    end()
    ui.update(among=3)
    assert seen == [(0, 1), (1, 2)]


def test_a_subscriber_may_change_the_state_itself() -> None:
    ui = UiStore()
    ui.subscribe(lambda _, now: ui.update(links=now.trails) if now.links != now.trails else None)
    ui.update(trails=False)
    assert not ui.state.links


def test_what_a_panel_writes_is_what_the_pointer_draws_with() -> None:
    ui, gui, given = UiStore(begin_scenario(3.0, 3)(UiState())), Gui(), list[OperatorCommand]()
    TermsWidgets(cast(viser.GuiApi, gui), cast(PointerSink, SimpleNamespace(push=given.append)), ui)
    gui.widgets["At its end"].touch("Start again")
    gui.widgets["Pace"].touch(0.5)
    gui.widgets["Lasts (s)"].touch("20")
    gui.widgets["Smoothing (m)"].touch("7")
    gui.widgets["Commit at once"].touch(False)
    assert given == [], "there is no path that could be followed otherwise"
    draw(hand_over_a_team(ui, given))
    end = given[-1]
    assert isinstance(end, StrokeEnd)
    assert terms_of_stroke(end) == ("loop", 0.5, 20.0, 7.0)
    assert end.preview


def test_what_a_panel_refuses_changes_nothing() -> None:
    ui, gui = UiStore(), Gui()
    TermsWidgets(cast(viser.GuiApi, gui), cast(PointerSink, None), ui)
    before = ui.state
    for label, value in (("At its end", "Explode"), ("Pace", 9.0), ("Lasts (s)", "long"), ("Commit at once", 1)):
        gui.widgets[label].touch(value)
    assert ui.state is before


def test_terms_hold_for_the_path_in_hand_at_once() -> None:
    ui, gui, given = UiStore(), Gui(), list[OperatorCommand]()
    widgets = TermsWidgets(cast(viser.GuiApi, gui), cast(PointerSink, SimpleNamespace(push=given.append)), ui)
    widgets.update(PATH, USUAL_SCALE)
    gui.widgets["Pace"].touch(0.75)
    assert given == [ShapePath(pace=0.75)]


def test_what_a_key_writes_is_what_the_panel_shows() -> None:
    ui, gui = UiStore(), Gui()
    panel = ViewPanel(cast(viser.GuiApi, gui), ui)
    hand_over_a_team(ui, []).key(PAGE, "field_arrows")
    ui.change(change_look(palette=LIGHT))
    panel.update(cast(Any, None))
    assert (gui.widgets["Field"].value, gui.widgets["Theme"].value) == ("Path", "Light")


def test_the_picture_of_a_camera_has_a_switch_where_there_is_a_camera() -> None:
    ui, without, camera = UiStore(), Gui(), Gui()
    ViewPanel(cast(viser.GuiApi, without), ui)
    assert "Camera picture" not in without.widgets
    ViewPanel(cast(viser.GuiApi, camera), ui, camera=True)
    camera.widgets["Camera picture"].touch(False)
    assert not ui.state.camera


@pytest.mark.parametrize(("path", "terms"), [(PATH, ("hold", 0.5, 30.0, 4.0)), (NO_PATH, ("loop", 1.0, 0.0, 4.0))])
def test_the_terms_of_the_path_in_hand_are_those_of_the_next_one(path: Path, terms: tuple[object, ...]) -> None:
    state = UiState(terms=PathTerms(ending="loop", smoothing=4.0))
    assert follow_path(path)(state).terms == terms


def test_the_look_ahead_takes_what_the_stroke_is_for_while_it_is_drawn() -> None:
    ui = UiStore(UiState(terms=PathTerms(pace=0.5)))
    hand = hand_over_a_team(ui, [])
    hand.tool(PAGE, Tool.PRIORITY)
    console = cast(Console, SimpleNamespace(ui=ui))
    assert chosen(console) == Choice(20.0, StrokeUse.PATH, PathTerms(pace=0.5))
    hand.stroke(PAGE, "start", floats([[100.0, 100.0]]))
    assert chosen(console).use is StrokeUse.PRIORITY
    hand.stroke(PAGE, "cancel", floats([], 0, 2))
    assert chosen(console).use is StrokeUse.PATH


def chosen(console: Console) -> Choice:
    return Console._choice(console)  # pyright: ignore[reportPrivateUsage]


def test_only_what_can_wait_for_a_commit_waits() -> None:
    waits = UiState(commit_at_once=False)
    assert [use for use in StrokeUse if end_of_stroke(waits, use).preview] == [StrokeUse.PATH, StrokeUse.REDRAW]
    assert not any(end_of_stroke(UiState(), use).preview for use in StrokeUse)


def test_what_was_let_go_is_not_dragged_on() -> None:
    start = floats([1.0, 2.0])
    dragged = UiState(drag=Drag(start, start))
    moved = move_drag(floats([3.0, 4.0]))
    drag = moved(dragged).drag
    assert drag is not None
    assert (drag.start.tolist(), drag.now.tolist()) == ([1.0, 2.0], [3.0, 4.0])
    assert moved(replace(dragged, drag=None)).drag is None


def test_choices_wake_the_view_and_a_drag_waits_for_the_next_frame() -> None:
    answered = threading.Event()
    console = cast(Console, SimpleNamespace(_session=SimpleNamespace(answered=answered)))
    wake: Callable[[Console, UiState, UiState], None] = Console._wake  # pyright: ignore[reportPrivateUsage]
    still = UiState()
    wake(console, still, replace(still, drag=Drag(np.zeros(2), np.zeros(2))))
    assert not answered.is_set()
    wake(console, still, replace(still, trails=False))
    assert answered.is_set()


def test_the_links_of_a_large_team_are_hidden_at_first() -> None:
    assert begin_scenario(3.0, MOST_LINKED)(UiState(links=False)).links
    assert not begin_scenario(3.0, MOST_LINKED + 1)(UiState()).links
