"""What the panel *Steer* shows of the run, and the commands that its widgets give; without a browser."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from higvf_console.control.guidance.paths import sketch_path
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
    TakeUpPath,
)
from higvf_console.core.interface import PointerSink
from higvf_console.scenario.sections import ShownStroke
from higvf_console.ui.panels.steer import SteerPanel, group_html, priority_html
from higvf_console.ui.ui_state import UiStore, toggle_in_group
from tests.fake_gui import Gui
from tests.teams import team

SETUP = team()
PATH = sketch_path(floats([[100, 100], [200, 100], [300, 100]]), 0.0)
LINE = ((10.0, 10.0), (50.0, 10.0))


def scenario(*strokes: ShownStroke) -> Any:
    return SimpleNamespace(strokes=strokes)


EMPTY = scenario()


def snapshot(given: Any = EMPTY, *, paths: tuple[Any, ...] = (), **intent: Any) -> Any:
    state = SETUP.start._replace(
        intent=SETUP.start.intent._replace(**intent),
        pointer_state=SETUP.start.pointer_state._replace(paths=paths),
    )
    return SimpleNamespace(state=state, scenario=given, setup=SETUP)


class Shown:
    """The panel of a team of three, its widgets and what it has commanded."""

    def __init__(self) -> None:
        self.gui, self.ui, self.given = Gui(), UiStore(), list[Any]()
        sink = cast(PointerSink, SimpleNamespace(push=self.given.append))
        self.panel = SteerPanel(self.gui.as_viser, EMPTY, 3, sink, self.ui)


@pytest.fixture
def shown() -> Shown:
    return Shown()


def test_the_picker_shows_who_is_influenced_and_picks_another(shown: Shown) -> None:
    shown.panel.update(snapshot(influenced=2))
    assert shown.gui["Influence"].value == "Robot 3"
    shown.gui["Influence"].touch("Robot 2")
    assert shown.given == [Pick(1)]


def test_each_button_of_the_path_gives_its_command(shown: Shown) -> None:
    buttons = shown.gui["Path"]
    for name in ("Clear", "Reverse", "Close", "Finish"):
        buttons.touch(name)
    assert shown.given == [ClearPath(), ReversePath(), ShapePath(closed=True), NextTask()]


def test_a_closed_path_can_be_opened(shown: Shown) -> None:
    shown.panel.update(snapshot(path=PATH))
    assert "Close" in shown.gui["Path"].options
    shown.panel.update(snapshot(path=PATH._replace(closed=True)))
    assert "Open" in shown.gui["Path"].options
    assert "Close" not in shown.gui["Path"].options
    shown.gui["Path"].touch("Open")
    assert shown.given == [ShapePath(closed=False)]


def test_what_no_button_says_is_refused_with_the_choices(shown: Shown) -> None:
    shown.gui["Path"].touch("Delete")
    assert shown.given == []
    assert "Clear" in shown.gui["Path"].told[0]


def test_paths_drawn_so_far_can_be_followed_again_or_forgotten(shown: Shown) -> None:
    assert shown.gui["Drawn"].options == ("none yet",)
    shown.gui[" "].touch("Follow")
    assert shown.given == [], "there is none"
    shown.panel.update(snapshot(paths=(PATH, PATH)))
    assert len(shown.gui["Drawn"].options) == 2
    shown.gui[" "].touch("Follow")
    shown.gui["Drawn"].value = shown.gui["Drawn"].options[0]
    shown.gui[" "].touch("Forget")
    assert shown.given == [TakeUpPath(1), ForgetPath(0)], "the latest is chosen at first"


def test_a_shown_stroke_is_drawn_for_its_robot_and_goes_with_its_scenario(shown: Shown) -> None:
    shown.panel.update(snapshot(scenario(ShownStroke(name="the gap", robot=1, points=floats(LINE)))))
    button = shown.gui["Show me: the gap"]
    button.touch()
    begin, points, end = shown.given
    assert isinstance(begin, StrokeBegin)
    assert isinstance(points, StrokePoints)
    assert points.points.tolist() == [list(point) for point in LINE]
    assert isinstance(end, StrokeEnd)
    assert end.robot == 1
    shown.panel.update(snapshot(EMPTY))
    assert button.removed


def test_priorities_are_listed_and_those_of_the_influenced_robot_can_be_cleared(shown: Shown) -> None:
    shown.panel.update(snapshot())
    assert not shown.gui["Clear priority"].visible
    shown.panel.update(snapshot(priority=floats([[1, 2, 4]])))
    assert not shown.gui["Clear priority"].visible, "they are another robot's"
    shown.panel.update(snapshot(influenced=1, priority=floats([[1, 2, 4]])))
    assert shown.gui["Clear priority"].visible
    shown.gui["Clear priority"].touch()
    assert shown.given == [Prioritise()]
    assert "robot 2: fire 3 (\u00d74)" in priority_html([[1.0, 2.0, 4.0]])


def test_the_group_is_named_while_there_is_one(shown: Shown) -> None:
    shown.ui.change(toggle_in_group(2))
    shown.panel.update(snapshot())
    group = next(html for html in shown.gui.html if "Group" in str(html.content))
    assert group.visible
    shown.ui.change(toggle_in_group(2))
    shown.panel.update(snapshot())
    assert not group.visible
    assert "and 3 more" in group_html(frozenset(range(15)))
