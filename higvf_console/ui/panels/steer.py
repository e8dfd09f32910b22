"""Whom the operator steers, along what and when: picker, path actions, the scenario's own strokes, commit at once."""

from typing import TYPE_CHECKING, Any

import viser

from higvf_console.arrays import floats
from higvf_console.commands import (
    ClearPath,
    NextTask,
    Pick,
    PointerSink,
    ReversePath,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.quantity import quantities
from higvf_console.session.preview import LONGEST, SHORTEST
from higvf_console.ui.panels.callbacks import mirror, number_in, one_of, reaction, truth
from higvf_console.ui.panels.picker import RobotPicker
from higvf_console.ui.scene import View

if TYPE_CHECKING:
    from higvf_console.session.scenario import Scenario
    from higvf_console.session.sections import ShownStroke
    from higvf_console.session.session import Snapshot

_CLEAR, _REVERSE, _NEXT = "Clear", "Reverse", "Next task"
_FEELS = "The robot that feels your path"


class SteerPanel:
    """Everything about the human intention.

    Attributes:
        smoothing: how far the next drawn path may leave its stroke [m].
    """

    def __init__(self, gui: viser.GuiApi, scenario: "Scenario", robots: int, sink: PointerSink, view: View) -> None:
        """Builds the widgets for a team and the strokes that its scenario ships."""
        self._sink, self._view = sink, view
        self._picker = RobotPicker(gui, "Influence", robots, self._pick, hint=_FEELS)
        self._actions = gui.add_button_group(
            "Path", (_CLEAR, _REVERSE, _NEXT), hint="Remove it (C), turn it round (R), or count it as finished"
        )
        actions: dict[str, Any] = {_CLEAR: ClearPath(), _REVERSE: ReversePath(), _NEXT: NextTask()}
        self._actions.on_click(reaction(lambda value: sink.push(one_of(value, actions))))
        meaning = quantities(type(scenario.gains.path))["stroke_smoothing"]
        self.smoothing = scenario.gains.path.stroke_smoothing
        self._smoothing = gui.add_number(
            "Smoothing m", self.smoothing, min=meaning.low, max=meaning.high, step=1.0, hint=meaning.text
        )
        self._smoothing.on_update(reaction(lambda value: self._smooth(value, meaning.low, meaning.high)))
        self._strokes = [self._make_show_me(gui, stroke) for stroke in scenario.strokes]
        self._at_once = gui.add_checkbox(
            "Commit at once",
            view.commit_at_once,
            hint="On: a path is followed when you end its stroke. Off: it waits for Commit (Enter) or Discard (Esc)",
        )
        self._at_once.on_update(reaction(lambda value: setattr(view, "commit_at_once", truth(value))))
        self._horizon = gui.add_slider(
            "Look ahead s", SHORTEST, LONGEST, 5.0, view.horizon, hint="How far the team is run ahead while you draw"
        )
        self._horizon.on_update(reaction(self._look))

    def _make_show_me(self, gui: viser.GuiApi, stroke: "ShownStroke") -> viser.GuiButtonHandle:
        who = "the chosen robot" if stroke.robot is None else f"robot {stroke.robot + 1}"
        button = gui.add_button(
            f"Show me: {stroke.name}", icon=viser.Icon.WAVE_SINE, color="gray", hint=f"Draws this stroke for {who}"
        )
        button.on_click(reaction(lambda _: self._show(stroke)))
        return button

    def _pick(self, robot: int | None) -> None:
        if robot is not None:
            self._sink.push(Pick(robot))

    def _show(self, stroke: "ShownStroke") -> None:
        end = StrokeEnd(robot=stroke.robot, preview=not self._view.commit_at_once)
        for command in (StrokeBegin(), StrokePoints(points=floats(stroke.points)), end):
            self._sink.push(command)

    def _smooth(self, value: object, low: float, high: float) -> None:
        self.smoothing = number_in(value, low, high)

    def _look(self, value: object) -> None:
        self._view.horizon = number_in(value, SHORTEST, LONGEST)

    def update(self, snapshot: "Snapshot") -> None:
        """Shows who is influenced now, and the settings in force."""
        mirror(self._smoothing, self.smoothing)
        mirror(self._at_once, self._view.commit_at_once)
        mirror(self._horizon, self._view.horizon)
        self._picker.show(snapshot.state.intent.influenced, len(snapshot.state.motion.position))

    def cleanup(self) -> None:
        """Removes the widgets."""
        for widget in (self._picker, self._actions, self._smoothing, *self._strokes, self._at_once, self._horizon):
            widget.remove()
