"""At a glance: fires and the latest messages, nothing where there is nothing to tell."""

from types import SimpleNamespace
from typing import Any

from higvf_console.core.events import Event, Severity
from higvf_console.sim.simulation import advance
from higvf_console.ui.alarms import add_alarms
from higvf_console.ui.panels.glance import MOST_MESSAGES, GlancePanel
from higvf_console.ui.ui_state import UiStore
from tests.fake_gui import Gui
from tests.teams import team


def shown(fires: list[tuple[float, float, float]], *events: Event, ui: UiStore | None = None) -> tuple[str, str]:
    """The block of fires and that of messages."""
    setup, gui = team(fires=fires), Gui()
    state, trace = advance(setup.start, setup.world, setup.params)
    panel = GlancePanel(gui.as_viser, ui or UiStore())
    snapshot: Any = SimpleNamespace(setup=setup, state=state, trace=trace, events=events, loss_area=[0.0] * len(fires))
    panel.update(snapshot)
    fire_block, messages = gui.html
    return fire_block.content, messages.content


def messages(count: int) -> list[Event]:
    return [Event(float(k), Severity.INFO, "target", f"Message {k}.") for k in range(count)]


def test_without_fires_and_messages_there_is_nothing_to_see() -> None:
    assert shown([]) == ("", "")


def test_the_fires_and_the_latest_messages_have_titles() -> None:
    fires, latest = shown([(500.0, 250.0, 20.0)], *messages(MOST_MESSAGES + 3))
    assert "Fires" in fires
    assert "Latest messages" in latest
    assert latest.count("Message") == MOST_MESSAGES
    assert f"Message {MOST_MESSAGES + 2}." in latest


def test_alarms_that_stand_are_marked_here_too() -> None:
    ui, stop = UiStore(), Event(1.0, Severity.ALARM, "stop", "STOP")
    ui.change(add_alarms([stop]))
    assert "class=alarm" in shown([], stop, ui=ui)[1]
    assert "class=alarm" not in shown([], stop)[1]
