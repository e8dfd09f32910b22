"""Path options: ending, pace, duration, smoothing, confirmation, preview horizon."""

from typing import Any

import viser

from higvf_console.analysis.preview import LONGEST, SHORTEST
from higvf_console.control.parameters import PathParameters
from higvf_console.core.commands import ShapePath
from higvf_console.core.interface import PointerSink
from higvf_console.core.numbers import legible
from higvf_console.core.path_terms import FASTEST, SLOWEST
from higvf_console.core.quantity import quantities
from higvf_console.core.scale import USUAL_SCALE, Scale
from higvf_console.core.state import NO_PATH, Path, PathKind
from higvf_console.ui.ui_state import UiStore, change_terms
from higvf_console.ui.widgets.callbacks import chosen, mirror, number_in, reaction, truth
from higvf_console.ui.widgets.number import NumberField, NumberRange

LONGEST_DURATION = 3600.0  # [s]
_ENDINGS = {"Go on by itself": "release", "Wait there": "hold", "Start again": "loop"}
_SMOOTHING = quantities(PathParameters)["stroke_smoothing"]
_USUAL_SMOOTHING = PathParameters().stroke_smoothing  # until a scenario is shown [m]


class TermsWidgets:
    """Widgets that show the `UiState`; what is chosen holds for the next paths, and for the one in hand at once."""

    def __init__(self, gui: viser.GuiApi, sink: PointerSink, ui: UiStore) -> None:
        """Builds the widgets; what is chosen for the path in hand goes to `sink`."""
        self._sink, self._ui, self._path = sink, ui, NO_PATH
        self._at_once = gui.add_checkbox(
            "Commit at once",
            ui.state.commit_at_once,
            hint="On: a new or redrawn path is followed at once. Off: it waits for Commit (Enter) or Discard (Esc)",
        )
        self._at_once.on_update(reaction(lambda value: ui.update(commit_at_once=truth(value))))
        self._end = gui.add_dropdown("At its end", tuple(_ENDINGS), hint="What the team does when the path is finished")
        self._end.on_update(reaction(lambda value: self._shape(ending=chosen(value, _ENDINGS))))
        self._speed = gui.add_slider(
            "Pace", SLOWEST, FASTEST, 0.05, 1.0, hint="Speed along the path, as a share of the usual speed"
        )
        self._speed.on_update(reaction(lambda value: self._shape(pace=number_in(value, SLOWEST, FASTEST))))
        self._time = NumberField(
            gui, "Lasts", 0.0, NumberRange("s", 0.0, LONGEST_DURATION), lambda value: self._shape(duration=value),
            hint="The path ends after this time; 0 = no limit",
        )  # fmt: skip
        self._smoothing = NumberField(
            gui, "Smoothing", self._chosen_smoothing(), _range_at(USUAL_SCALE),
            lambda value: ui.change(change_terms(smoothing=value)), hint=_SMOOTHING.text,
        )  # fmt: skip
        self._horizon = gui.add_slider(
            "Look ahead (s)",
            SHORTEST,
            LONGEST,
            5.0,
            ui.state.horizon,
            hint="How far ahead the preview predicts while you draw",
        )
        self._horizon.on_update(reaction(lambda value: ui.update(horizon=number_in(value, SHORTEST, LONGEST))))

    def _chosen_smoothing(self) -> float:
        smoothing = self._ui.state.terms.smoothing
        return _USUAL_SMOOTHING if smoothing is None else smoothing

    def _shape(self, **terms: Any) -> None:
        self._ui.change(change_terms(**terms))
        if self._path.kind != PathKind.NONE:
            self._sink.push(ShapePath(**terms))

    def update(self, path: Path, scale: Scale) -> None:
        """Shows what is chosen; `path` is the one in hand, `scale` that of the team."""
        self._path = path
        state = self._ui.state
        for widget, value in (
            (self._end, next(word for word, ending in _ENDINGS.items() if ending == state.terms.ending)),
            (self._speed, state.terms.pace), (self._at_once, state.commit_at_once), (self._horizon, state.horizon),
        ):  # fmt: skip
            mirror(widget, value)
        self._time.show(state.terms.duration)
        self._smoothing.describe("Smoothing", _range_at(scale), _SMOOTHING.text)
        self._smoothing.show(legible(self._chosen_smoothing()))


def _range_at(scale: Scale) -> NumberRange:
    allowed = _SMOOTHING.at(scale)
    return NumberRange(allowed.unit, allowed.low, allowed.high)
