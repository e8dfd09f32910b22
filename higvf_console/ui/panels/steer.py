"""Whom the operator steers, along what and how: picker, path actions, paths drawn so far, priorities, shown strokes."""

import math
from typing import TYPE_CHECKING, Any

import viser

from higvf_console.analysis.preview import LONGEST, SHORTEST
from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    ClearPath,
    ForgetPath,
    NextTask,
    Pick,
    Prioritise,
    ReversePath,
    ShapePath,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    StrokeUse,
    TakeUpPath,
)
from higvf_console.core.interface import PointerSink
from higvf_console.core.quantity import quantities
from higvf_console.core.state import NO_PATH, Path, PathEnding, PathKind
from higvf_console.operator.path_commands import FASTEST, SLOWEST, in_hand, path_words
from higvf_console.ui.panels.widgets.callbacks import mirror, number_in, one_of, reaction, truth
from higvf_console.ui.panels.widgets.html import TIMES, block
from higvf_console.ui.panels.widgets.picker import RobotPicker
from higvf_console.ui.scene.scene import View

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot
    from higvf_console.scenario.scenario import Scenario
    from higvf_console.scenario.sections import ShownStroke

LONGEST_DURATION = 3600.0  # [s]
_CLEAR, _REVERSE, _CLOSE, _OPEN, _NEXT = "Clear", "Reverse", "Close", "Open", "Finish"
_FOLLOW, _FORGET, _NO_PATHS = "Follow", "Forget", "none yet"
_ENDINGS = {"Go on by itself": "release", "Wait there": "hold", "Start again": "loop"}
_FEELS = "The robot that feels your path"


class SteerPanel:
    """Everything about the human intention.

    Attributes:
        smoothing: how far the next drawn path may leave its stroke [m].
        ending: of the next drawn path, see `ShapePath`.
        pace: likewise.
        duration: likewise [s].
    """

    def __init__(self, gui: viser.GuiApi, scenario: "Scenario", robots: int, sink: PointerSink, view: View) -> None:
        """Builds the widgets for a team and the strokes that its scenario ships."""
        self._gui, self._sink, self._view = gui, sink, view
        self._scenario = scenario
        self._path, self._paths = NO_PATH, tuple[Path, ...]()
        self.smoothing = scenario.params.path.stroke_smoothing
        self.ending, self.pace, self.duration = "release", 1.0, 0.0
        self._picker = RobotPicker(gui, "Influence", robots, self._pick, hint=_FEELS)
        self._actions = gui.add_button_group(
            "Path",
            (_CLEAR, _REVERSE, _CLOSE, _NEXT),
            hint="Remove it (C), turn it round (R), join its ends or part them, or let the team go on by itself",
        )
        self._actions.on_click(reaction(self._act))
        self._priority = gui.add_html("", visible=False)
        self._unprioritise = gui.add_button("Clear priority", color="gray", visible=False, hint="Of the chosen robot")
        self._unprioritise.on_click(reaction(lambda _: sink.push(Prioritise())))
        self._make_terms(gui, scenario)
        self._drawn = gui.add_dropdown("Drawn", self._names(), hint="Paths drawn so far")
        self._again = gui.add_button_group(" ", (_FOLLOW, _FORGET), hint="The path chosen above")
        self._again.on_click(reaction(self._take_up))
        self._shown = gui.add_folder(None)
        self._offer(scenario)

    def _make_terms(self, gui: viser.GuiApi, scenario: "Scenario") -> None:
        """How a path is followed, and how a stroke becomes one."""
        self._end = gui.add_dropdown("At its end", tuple(_ENDINGS), hint="What the team does when the path is finished")
        self._end.on_update(reaction(lambda value: self._shape(ending=one_of(value, _ENDINGS))))
        self._speed = gui.add_slider(
            "Pace", SLOWEST, FASTEST, 0.05, 1.0, hint="Share of their speed that those who are led along it take"
        )
        self._speed.on_update(reaction(lambda value: self._shape(pace=number_in(value, SLOWEST, FASTEST))))
        self._time = gui.add_number(
            "Lasts s", 0.0, min=0.0, max=LONGEST_DURATION, step=5.0, hint="The path ends after so long; 0 = no limit"
        )
        self._time.on_update(reaction(lambda value: self._shape(duration=number_in(value, 0.0, LONGEST_DURATION))))
        meaning = quantities(type(scenario.params.path))["stroke_smoothing"]
        self._smoothing = gui.add_number(
            "Smoothing m", self.smoothing, min=meaning.low, max=meaning.high, step=1.0, hint=meaning.text
        )
        self._time.precision = self._smoothing.precision = 2
        self._smoothing.on_update(
            reaction(lambda value: setattr(self, "smoothing", number_in(value, meaning.low, meaning.high)))
        )
        self._at_once = gui.add_checkbox(
            "Commit at once",
            self._view.commit_at_once,
            hint="On: a path, new or repaired, is followed at once. Off: it waits for Commit (Enter) or Discard (Esc)",
        )
        self._at_once.on_update(reaction(lambda value: setattr(self._view, "commit_at_once", truth(value))))
        self._horizon = gui.add_slider(
            "Look ahead s", SHORTEST, LONGEST, 5.0, self._view.horizon, hint="How far the team is run ahead as you draw"
        )
        self._horizon.on_update(
            reaction(lambda value: setattr(self._view, "horizon", number_in(value, SHORTEST, LONGEST)))
        )

    def _make_show_me(self, gui: viser.GuiApi, stroke: "ShownStroke") -> viser.GuiButtonHandle:
        who = "the chosen robot" if stroke.robot is None else f"robot {stroke.robot + 1}"
        button = gui.add_button(
            f"Show me: {stroke.name}", icon=viser.Icon.WAVE_SINE, color="gray", hint=f"Draws this stroke for {who}"
        )
        button.on_click(reaction(lambda _: self._show(stroke)))
        return button

    def stroke_end(self, use: StrokeUse = StrokeUse.PATH, robot: int | None = None) -> StrokeEnd:
        """The end of a stroke that is drawn now, for a robot (index from 0) or the one that is influenced."""
        waits = use in (StrokeUse.PATH, StrokeUse.REDRAW) and not self._view.commit_at_once
        return StrokeEnd(
            smoothing=self.smoothing, robot=robot, preview=waits, use=use.value, ending=self.ending, pace=self.pace,
            duration=self.duration,
        )  # fmt: skip

    def _pick(self, robot: int | None) -> None:
        if robot is not None:
            self._sink.push(Pick(robot))

    def _act(self, value: object) -> None:
        actions: dict[str, Any] = {
            _CLEAR: ClearPath(),
            _REVERSE: ReversePath(),
            _CLOSE: ShapePath(closed=True),
            _OPEN: ShapePath(closed=False),
            _NEXT: NextTask(),
        }
        self._sink.push(one_of(value, actions))

    def _shape(self, **terms: Any) -> None:
        """The next paths are followed so, and the one that waits, or is in force, from now on."""
        for name, value in terms.items():
            setattr(self, name, value)
        if self._path.kind != PathKind.NONE:
            self._sink.push(ShapePath(**terms))

    def _take_up(self, value: object) -> None:
        names = {name: number for number, name in enumerate(self._names())}
        number = one_of(self._drawn.value, names)
        if number < len(self._paths):
            self._sink.push(one_of(value, {_FOLLOW: TakeUpPath(number), _FORGET: ForgetPath(number)}))

    def _names(self) -> tuple[str, ...]:
        names = tuple(f"{number}: {path_words(path)}" for number, path in enumerate(self._paths, 1))
        return names or (_NO_PATHS,)

    def _show(self, stroke: "ShownStroke") -> None:
        end = self.stroke_end(robot=stroke.robot)
        for command in (StrokeBegin(), StrokePoints(points=floats(stroke.points)), end):
            self._sink.push(command)

    def update(self, snapshot: "Snapshot") -> None:
        """Shows who is influenced now, and the settings in force."""
        state = snapshot.state
        if snapshot.scenario is not self._scenario:
            self._take(snapshot.scenario)
        self._picker.show(state.intent.influenced, len(state.motion.position))
        self._show_path(in_hand(state))
        if state.pointer_state.paths is not self._paths:
            self._paths = state.pointer_state.paths
            self._drawn.options = self._names()
            self._drawn.value = self._names()[-1]
        for widget, value in (
            (self._end, next(word for word, ending in _ENDINGS.items() if ending == self.ending)),
            (self._speed, self.pace), (self._time, self.duration), (self._smoothing, self.smoothing),
            (self._at_once, self._view.commit_at_once), (self._horizon, self._view.horizon),
        ):  # fmt: skip
            mirror(widget, value)
        priority = state.intent.priority
        self._priority.visible = len(priority) > 0
        self._unprioritise.visible = bool((priority[:, 0] == state.intent.influenced).any())
        if len(priority):
            self._priority.content = block(priority_html(priority.tolist()))

    def _take(self, scenario: "Scenario") -> None:
        """Offers the strokes of a scenario that was loaded, and its smoothing."""
        self._scenario, self.smoothing = scenario, scenario.params.path.stroke_smoothing
        for button in self._strokes:
            button.remove()
        self._offer(scenario)

    def _offer(self, scenario: "Scenario") -> None:
        with self._shown:
            self._strokes = [self._make_show_me(self._gui, stroke) for stroke in scenario.strokes]

    def _show_path(self, path: Path) -> None:
        if path is self._path:
            return
        self._path = path
        self._actions.options = (_CLEAR, _REVERSE, _OPEN if path.closed else _CLOSE, _NEXT)
        if path.kind != PathKind.NONE:
            self.ending = PathEnding(path.ending).name.lower()
            self.pace, self.duration = path.pace, path.duration if math.isfinite(path.duration) else 0.0

    def cleanup(self) -> None:
        """Removes the widgets."""
        self._picker.remove()
        for widget in (
            self._actions, self._end, self._speed, self._time, self._smoothing, self._at_once, self._horizon,
            self._drawn, self._again, self._priority, self._unprioritise, self._shown,
        ):  # fmt: skip
            widget.remove()


def priority_html(rows: list[list[float]]) -> str:
    """Which robot values which fires more, from rows of robot, fire and factor."""
    by_robot: dict[int, list[str]] = {}
    for robot, fire, factor in rows:
        by_robot.setdefault(int(robot), []).append(f"{int(fire) + 1} ({TIMES}{factor:g})")
    lines = [f"robot {robot + 1}: fire {', '.join(fires)}" for robot, fires in sorted(by_robot.items())]
    return f'<dl><dt>Priority</dt><dd class="operator">{"<br>".join(lines)}</dd></dl>'
