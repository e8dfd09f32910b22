"""The panel *Inputs*: what can be acknowledged and calibrated when, and the faults that it injects."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from higvf_console.core.commands import Acknowledge, FaultKind, InjectFault
from higvf_console.core.interface import ChannelHealth, ChannelState, PointerSink
from higvf_console.core.reports import CaptureReport
from higvf_console.runtime.session import Session
from higvf_console.ui.panels.inputs import InputsPanel
from tests.fake_gui import Gui


def snapshot(state: ChannelState = ChannelState.LIVE, capture: CaptureReport | None = None) -> Any:
    inputs = SimpleNamespace(decisions=(), attention=None, calibrations=(), capture=capture)
    return SimpleNamespace(channels=(("gaze", ChannelHealth(state, "why")),), inputs=inputs)


class Shown:
    """The panel of a session with a gaze tracker, and what it has done."""

    def __init__(self) -> None:
        self.gui, self.given, self.captures = Gui(), list[Any](), 0
        gaze = SimpleNamespace(begin_capture=self._begin)
        session = cast(Session, SimpleNamespace(calibrated=gaze, snapshot=snapshot()))
        sink = cast(PointerSink, SimpleNamespace(push=self.given.append))
        self.panel = InputsPanel(self.gui.as_viser, session, sink)

    def _begin(self) -> None:
        self.captures += 1


@pytest.fixture
def shown() -> Shown:
    return Shown()


def test_inputs_that_are_back_can_be_acknowledged(shown: Shown) -> None:
    button = shown.gui["Acknowledge"]
    shown.panel.update(snapshot(ChannelState.LOST))
    assert not button.visible
    shown.panel.update(snapshot(ChannelState.RECOVERED))
    assert button.visible
    button.touch()
    assert shown.given == [Acknowledge()]


def test_a_calibration_begins_when_the_tracker_can_and_not_while_one_goes_on(shown: Shown) -> None:
    button = shown.gui["Calibrate gaze"]
    shown.panel.update(snapshot())
    assert not button.visible
    shown.panel.update(snapshot(capture=CaptureReport("gaze is replayed")))
    assert (button.visible, button.disabled) == (True, True)
    shown.panel.update(snapshot(capture=CaptureReport("")))
    assert not button.disabled
    button.touch()
    assert shown.captures == 1


def test_a_fault_is_injected_as_it_was_chosen(shown: Shown) -> None:
    drop = next(name for name in shown.gui["Fault"].options if name.startswith("Drop"))
    shown.gui["Fault"].touch(drop)
    shown.gui["Inject"].touch()
    (fault,) = shown.given
    assert isinstance(fault, InjectFault)
    assert (fault.channel, fault.kind) == ("gaze", FaultKind.DROP)
    shown.gui["Input"].touch("sonar")
    assert "gaze" in shown.gui["Input"].told[0], "a refusal names the choices"
