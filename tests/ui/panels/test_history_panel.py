"""The history lists actions, the latest first, and its buttons undo and redo."""

from types import SimpleNamespace
from typing import Any, cast

from higvf_console.core.commands import Redo, Undo
from higvf_console.core.interface import PointerSink
from higvf_console.runtime.history import Entry
from higvf_console.ui.panels.history import SHOWN, HistoryPanel, history_html
from tests.fake_gui import Gui


def entry(number: int, *, undone: bool = False) -> Any:
    return cast(Entry, SimpleNamespace(time=float(number), text=f"Action {number}.", undone=undone))


def snapshot(*entries: Any) -> Any:
    return SimpleNamespace(history=SimpleNamespace(entries=lambda: entries))


def test_the_buttons_undo_and_redo_and_nothing_else() -> None:
    gui, given = Gui(), list[Any]()
    HistoryPanel(gui.as_viser, cast(PointerSink, SimpleNamespace(push=given.append)))
    for value in ("Undo", "Redo", "Erase"):
        gui["History"].touch(value)
    assert given == [Undo(), Redo()]
    assert "Undo" in gui["History"].told[0], "a refusal names the choices"


def test_the_list_is_made_anew_only_when_the_history_is_another() -> None:
    gui = Gui()
    panel = HistoryPanel(gui.as_viser, cast(PointerSink, SimpleNamespace()))
    first = snapshot(entry(1))
    panel.update(first)
    assert "Action 1." in gui.html[0].content
    gui.html[0].content = "as it was"
    panel.update(first)
    assert gui.html[0].content == "as it was"
    panel.update(snapshot(entry(1), entry(2)))
    html = gui.html[0].content
    assert html.index("Action 2.") < html.index("Action 1.")


def test_undone_actions_are_struck_through_and_a_long_list_shows_where_the_run_is() -> None:
    assert history_html((entry(1), entry(2, undone=True))).count('class="undone"') == 1
    long = tuple(entry(k, undone=k >= 20) for k in range(40))
    html = history_html(long)
    assert html.count("Action") == SHOWN
    assert "Action 19." in html
    assert "Action 20." in html
    assert "No actions yet" in history_html(())
