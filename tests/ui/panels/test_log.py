"""The log lists what happened and marks the alarms that stand; its button and a page acknowledge them."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from higvf_console.core.events import Event, Severity
from higvf_console.ui.alarms import add_alarms
from higvf_console.ui.page import page
from higvf_console.ui.panels.log import LogPanel
from higvf_console.ui.ui_state import UiStore
from tests.fake_gui import PAGE, Gui, Widget

STOP = Event(1.0, Severity.ALARM, "stop", "STOP: all robots stand still.")
LOST = Event(2.0, Severity.ALARM, "channel", "Input 'gaze' is lost.")


class Shown:
    """A log panel, and what a page sees of it and sends."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.gui, self.ui = Gui(), UiStore()
        monkeypatch.setattr(page, "listen", self._listen)
        self.panel = LogPanel(self.gui.as_server(), self.ui)
        self.button: Widget = self.gui["Acknowledge"]

    def _listen(self, _server: object, topic: str, callback: Callable[[int, Any], None]) -> None:
        assert topic == "read"
        self.read = callback  # a page sends what it has put away

    def update(self, *events: Event) -> str:
        self.panel.update(SimpleNamespace(events=events))  # pyright: ignore[reportArgumentType]
        return self.gui.html[0].content


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Shown:
    return Shown(monkeypatch)


def test_before_anything_has_happened_the_log_says_so(shown: Shown) -> None:
    assert "Nothing has happened yet" in shown.update()
    assert not shown.button.visible


def test_an_alarm_stands_out_until_the_button_is_pressed(shown: Shown) -> None:
    shown.ui.change(add_alarms([STOP, LOST]))
    assert shown.update(STOP, LOST).count("class=alarm") == 2
    assert (shown.button.visible, shown.button.label) == (True, "Acknowledge 2 alarms")
    shown.button.touch()
    html = shown.update(STOP, LOST)
    assert "class=alarm" not in html
    assert STOP.text in html, "what was read stays in the list"
    assert not shown.button.visible


def test_a_page_that_puts_an_alarm_away_acknowledges_it_alone(shown: Shown) -> None:
    shown.ui.change(add_alarms([STOP, LOST]))
    shown.read(PAGE, {"text": STOP.text})
    assert shown.ui.state.alarms == (LOST,)


def test_the_panel_by_itself_makes_no_event_an_alarm(shown: Shown) -> None:
    shown.update(STOP)
    assert shown.ui.state.alarms == ()
