"""The operator's inputs: how each is and why, what is decoded and looked at, the calibration, fault injection."""

from typing import TYPE_CHECKING

import viser

from higvf_console.core.commands import Acknowledge
from higvf_console.core.interface import ChannelState, PointerSink
from higvf_console.core.reports import Calibrated
from higvf_console.ui.widgets.callbacks import reaction
from higvf_console.ui.widgets.faults import FaultWidgets
from higvf_console.ui.widgets.html import block
from higvf_console.ui.widgets.inputs_tables import (
    attention_html,
    calibration_html,
    channels_html,
    decisions_html,
)

if TYPE_CHECKING:
    from higvf_console.runtime.session import Session
    from higvf_console.runtime.snapshot import Snapshot


class InputsPanel:
    """Tables that are renewed, two buttons, and the folder of faults."""

    def __init__(self, gui: viser.GuiApi, session: "Session", sink: PointerSink) -> None:
        """Builds the widgets.

        Args:
            gui: where.
            session: whose inputs they are.
            sink: takes what the operator acknowledges, and faults.
        """
        self._gaze: Calibrated | None = session.calibrated
        self._channels = gui.add_html("")
        self._acknowledge = gui.add_button(
            "Acknowledge",
            icon=viser.Icon.CHECK,
            color="yellow",
            hint="Use the inputs again that were lost and are back",
        )
        self._acknowledge.visible = False
        self._acknowledge.on_click(reaction(lambda _: sink.push(Acknowledge())))
        self._decisions = gui.add_html("")
        self._attention = gui.add_html("")
        self._calibration = gui.add_html("")
        self._calibrate = gui.add_button("Calibrate gaze", icon=viser.Icon.TARGET, color="gray")
        self._calibrate.on_click(reaction(lambda _: self._begin()))
        self._calibrate.disabled = True
        with gui.add_folder("Fault injection", expand_by_default=False):
            FaultWidgets(gui, [name for name, _ in session.snapshot.channels], sink)

    def _begin(self) -> None:
        if self._gaze is not None:
            self._gaze.begin_capture()

    def update(self, snapshot: "Snapshot") -> None:
        """Shows a snapshot."""
        inputs = snapshot.inputs
        self._channels.content = block(channels_html(snapshot.channels))
        self._acknowledge.visible = any(health.state is ChannelState.RECOVERED for _, health in snapshot.channels)
        self._decisions.content = block("".join(decisions_html(*entry) for entry in inputs.decisions))
        self._decisions.visible = bool(inputs.decisions)
        self._attention.content = block(attention_html(inputs.attention))
        self._calibration.content = block(calibration_html(inputs.calibrations, inputs.capture))
        self._calibration.visible = inputs.capture is not None
        self._calibrate.visible = inputs.capture is not None
        capture = inputs.capture
        self._calibrate.disabled = capture is None or bool(capture.refusal) or capture.target is not None
