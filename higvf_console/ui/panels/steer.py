"""Whom the operator steers, along what and how: picker, path actions, paths drawn so far, priorities, shown strokes."""

from typing import TYPE_CHECKING, Any

import viser

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
    StrokePoints,
    TakeUpPath,
)
from higvf_console.core.interface import PointerSink
from higvf_console.core.state import NO_PATH, Path
from higvf_console.operator.path_commands import in_hand, path_words
from higvf_console.ui.ui_state import UiStore, end_of_stroke
from higvf_console.ui.widgets.callbacks import chosen, reaction
from higvf_console.ui.widgets.html import TIMES, block
from higvf_console.ui.widgets.picker import RobotPicker
from higvf_console.ui.widgets.terms import TermsWidgets

if TYPE_CHECKING:
    from higvf_console.runtime.snapshot import Snapshot
    from higvf_console.scenario.scenario import Scenario
    from higvf_console.scenario.sections import ShownStroke

_CLEAR, _REVERSE, _CLOSE, _OPEN, _NEXT = "Clear", "Reverse", "Close", "Open", "Finish"
_MOST_NAMED = 12  # robots of a group
_FOLLOW, _FORGET, _NO_PATHS = "Follow", "Forget", "none yet"
_FEELS = "The influenced robot: the one that follows your path"


class SteerPanel:
    """Everything about the human intention; the terms of the next path are in the `UiState`."""

    def __init__(self, gui: viser.GuiApi, scenario: "Scenario", robots: int, sink: PointerSink, ui: UiStore) -> None:
        """Builds the widgets for a team and the strokes that its scenario ships."""
        self._gui, self._sink, self._ui = gui, sink, ui
        self._scenario = scenario
        self._path, self._paths = NO_PATH, tuple[Path, ...]()
        self._picker = RobotPicker(gui, "Influence", robots, self._pick, hint=_FEELS)
        self._group = gui.add_html("", visible=False)
        self._actions = gui.add_button_group(
            "Path",
            (_CLEAR, _REVERSE, _CLOSE, _NEXT),
            hint="Clear it (C), reverse its direction (R), close or open it, or finish: the team goes on by itself",
        )
        self._actions.on_click(reaction(self._act))
        self._priority = gui.add_html("", visible=False)
        self._unprioritise = gui.add_button(
            "Clear priority", color="gray", visible=False, hint="The influenced robot values all fires alike again (H)"
        )
        self._unprioritise.on_click(reaction(lambda _: sink.push(Prioritise())))
        self._terms = TermsWidgets(gui, sink, ui)
        self._drawn = gui.add_dropdown("Drawn", self._names(), hint="Paths drawn so far")
        self._again = gui.add_button_group(
            " ", (_FOLLOW, _FORGET), hint="Follow the path selected above again, or remove it from the list"
        )
        self._again.on_click(reaction(self._take_up))
        self._shown = gui.add_folder(None)
        self._offer(scenario)

    def _make_show_me(self, gui: viser.GuiApi, stroke: "ShownStroke") -> viser.GuiButtonHandle:
        who = "the influenced robot" if stroke.robot is None else f"robot {stroke.robot + 1}"
        button = gui.add_button(
            f"Show me: {stroke.name}", icon=viser.Icon.WAVE_SINE, color="gray", hint=f"Draws this stroke for {who}"
        )
        button.on_click(reaction(lambda _: self._show(stroke)))
        return button

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
        self._sink.push(chosen(value, actions))

    def _take_up(self, value: object) -> None:
        names = {name: number for number, name in enumerate(self._names())}
        number = chosen(self._drawn.value, names)
        if number < len(self._paths):
            self._sink.push(chosen(value, {_FOLLOW: TakeUpPath(number), _FORGET: ForgetPath(number)}))

    def _names(self) -> tuple[str, ...]:
        names = tuple(f"{number}: {path_words(path)}" for number, path in enumerate(self._paths, 1))
        return names or (_NO_PATHS,)

    def _show(self, stroke: "ShownStroke") -> None:
        end = end_of_stroke(self._ui.state, robot=stroke.robot)
        for command in (StrokeBegin(), StrokePoints(points=floats(stroke.points)), end):
            self._sink.push(command)

    def update(self, snapshot: "Snapshot") -> None:
        """Shows who is influenced now, and the settings in force."""
        state = snapshot.state
        if snapshot.scenario is not self._scenario:
            self._take(snapshot.scenario)
        self._picker.show(state.intent.influenced, len(state.motion.position))
        group = self._ui.state.group
        self._group.visible = bool(group)
        if group:
            self._group.content = block(group_html(group))
        path = in_hand(state)
        self._show_path(path)
        self._terms.update(path, snapshot.setup.params.scale)
        if state.pointer_state.paths is not self._paths:
            self._paths = state.pointer_state.paths
            self._drawn.options = self._names()
            self._drawn.value = self._names()[-1]
        priority = state.intent.priority
        self._priority.visible = len(priority) > 0
        self._unprioritise.visible = bool((priority[:, 0] == state.intent.influenced).any())
        if len(priority):
            self._priority.content = block(priority_html(priority.tolist()))

    def _take(self, scenario: "Scenario") -> None:
        """Offers the strokes of a scenario that was loaded."""
        self._scenario = scenario
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


def group_html(group: frozenset[int]) -> str:
    """The robots (indices from 0) that the next path is for."""
    names = ", ".join(str(robot + 1) for robot in sorted(group)[:_MOST_NAMED])
    more = f" and {len(group) - _MOST_NAMED} more" if len(group) > _MOST_NAMED else ""
    return (
        f'<dl><dt>Group</dt><dd class="operator">{names}{more}</dd></dl>'
        '<span class="dim">The next path is for that of them which is nearest to its start (Esc: none).</span>'
    )


def priority_html(rows: list[list[float]]) -> str:
    """Which robot values which fires more, from rows of robot, fire and factor."""
    by_robot: dict[int, list[str]] = {}
    for robot, fire, factor in rows:
        by_robot.setdefault(int(robot), []).append(f"{int(fire) + 1} ({TIMES}{factor:g})")
    lines = [f"robot {robot + 1}: fire {', '.join(fires)}" for robot, fires in sorted(by_robot.items())]
    return f'<dl><dt>Priority</dt><dd class="operator">{"<br>".join(lines)}</dd></dl>'
