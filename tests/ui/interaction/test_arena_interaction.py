"""What a hand does in the arena becomes commands: by the tool that it has, and by what it holds."""

from types import SimpleNamespace
from typing import NamedTuple, cast

import numpy as np
import pytest

from higvf_console.control.guidance.paths import line_path
from higvf_console.control.parameters import Parameters, RobotParameters
from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    Discard,
    MovePathPoint,
    OperatorCommand,
    Pick,
    Redo,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    StrokeUse,
    Undo,
)
from higvf_console.core.edits import AddEntity, ChangeEntity, DeleteEntity, EntityKind, MoveEntity, ToggleLink
from higvf_console.core.viewport import Viewport
from higvf_console.runtime.session import Session
from higvf_console.ui.interaction.arena import ArenaInteraction
from higvf_console.ui.interaction.grips import Drag, gripped, handles_of, nearest_of, result_of, robot_near, wished
from higvf_console.ui.interaction.tools import ADDS, USES, Tool
from higvf_console.ui.page.roles import Roles
from higvf_console.ui.ui_state import UiState, UiStore, keep_choice
from higvf_console.world.editing.entities import EntityRef
from higvf_console.world.setup import Setup
from tests.page_actions import no_page
from tests.teams import team

TRIANGLE = floats([[100, 350], [60, 320], [60, 380]])
PAGE = 7


class Held(NamedTuple):
    """A hand over a team, and what it has given."""

    hand: ArenaInteraction
    ui: UiStore
    given: list[OperatorCommand]
    shown: list[Tool]
    noted: list[str]

    @property
    def view(self) -> UiState:
        return self.ui.state

    def drag(self, *points: list[float], group: bool = False) -> None:
        self.hand.stroke(PAGE, "start", floats(points[:1]), group=group)
        self.hand.stroke(PAGE, "update", floats(points[1:]), group=group)
        self.hand.stroke(PAGE, "end", floats([], 0, 2), group=group)


def held(setup: Setup, tool: Tool = Tool.PATH) -> Held:
    given, shown, noted = list[OperatorCommand](), list[Tool](), list[str]()
    snapshot = SimpleNamespace(setup=setup, state=setup.start, frozen=False, time=0.0)
    session = SimpleNamespace(setup=setup, snapshot=snapshot, viewport=None)
    roles = cast(Roles, SimpleNamespace(push=given.append, steers={PAGE}.__contains__))
    ui = UiStore()
    hand = ArenaInteraction(cast(Session, session), ui, roles, no_page(shown, noted=noted))
    hand.viewport(PAGE, Viewport(1200.0, 700.0, 600.0, 350.0, 1.0))
    hand.tool(PAGE, tool)
    return Held(hand, ui, given, shown, noted)


def burning() -> Setup:
    return team(robots=[(100.0, 100.0), (300.0, 100.0)], fires=[(600.0, 350.0, 30.0)])


def on_its_way() -> Setup:
    """A team that follows a path."""
    setup = burning()
    path = line_path(100.0, 100.0, 0.4)
    return setup._replace(start=setup.start._replace(intent=setup.start.intent._replace(path=path)))


def test_a_click_picks_the_nearest_robot_within_reach_and_nobody_beyond() -> None:
    assert robot_near(TRIANGLE, floats([64, 325]), 26.0) == 1
    assert robot_near(TRIANGLE, floats([300, 300]), 26.0) is None
    assert robot_near(floats([], 0, 2), floats([0, 0]), 26.0) is None


def test_a_click_picks_a_unicycle_by_its_body_not_by_its_look_ahead_point() -> None:
    params = Parameters(robots=RobotParameters(look_ahead=30.0, turn_rate_limit=3.0))
    setup = team(robots=[(100.0, 100.0), (100.0, 200.0)], params=params)
    motion = setup.start.motion._replace(heading=floats([np.pi / 2, -np.pi / 2]))  # bodies at y = 70 and y = 230
    hand = held(setup._replace(start=setup.start._replace(motion=motion)))
    for y in (60.0, 100.0, 240.0):
        hand.hand.click(PAGE, floats([100.0, y]))
    assert hand.given == [Pick(0), Pick(1)]


@pytest.mark.parametrize("tool", USES)
def test_a_stroke_is_for_what_the_tool_says(tool: Tool) -> None:
    hand = held(on_its_way(), tool)
    hand.drag([100.0, 100.0], [200.0, 150.0])
    assert [type(command) for command in hand.given] == [StrokeBegin, StrokePoints, StrokePoints, StrokeEnd]
    assert cast(StrokeEnd, hand.given[-1]).use == USES[tool]


def test_a_stroke_that_would_redraw_a_part_of_no_path_draws_one() -> None:
    hand = held(burning(), Tool.REDRAW)
    hand.drag([100.0, 100.0], [200.0, 150.0])
    assert cast(StrokeEnd, hand.given[-1]).use == StrokeUse.PATH


def test_what_is_dragged_moves_by_as_much_as_the_hand() -> None:
    hand = held(burning(), Tool.EDIT)
    hand.drag([610.0, 340.0], [700.0, 400.0], [650.0, 300.0])
    (moved,) = hand.given
    assert isinstance(moved, MoveEntity)
    assert (moved.kind, moved.index, moved.point.tolist()) == (EntityKind.FIRE, 0, [640.0, 310.0])
    assert hand.view.selected == EntityRef(EntityKind.FIRE, 0)
    assert hand.view.drag is None


def test_a_drag_that_is_cancelled_or_holds_nothing_does_nothing() -> None:
    hand = held(burning(), Tool.EDIT)
    hand.hand.stroke(PAGE, "start", floats([[600.0, 350.0]]))
    assert hand.view.drag is not None
    hand.hand.stroke(PAGE, "cancel", floats([], 0, 2))
    hand.drag([1000.0, 600.0], [1100.0, 600.0])
    assert hand.given == []
    assert hand.view.drag is None


def test_escape_lets_go_of_what_is_chosen_then_of_the_tool_but_first_discards_what_waits() -> None:
    hand = held(burning(), Tool.EDIT)
    hand.hand.click(PAGE, floats([600.0, 350.0]))
    hand.hand.key(PAGE, "discard")
    assert hand.view.selected is None
    assert hand.shown == [Tool.EDIT]
    hand.hand.key(PAGE, "discard")
    assert hand.shown == [Tool.EDIT, Tool.PATH]
    assert hand.given == [Discard(), Discard()], "what began to wait since the snapshot is discarded all the same"
    setup = burning()
    pointer_state = setup.start.pointer_state._replace(proposed=1)
    waits = held(setup._replace(start=setup.start._replace(pointer_state=pointer_state)), Tool.EDIT)
    waits.hand.key(PAGE, "discard")
    assert waits.given == [Discard()]
    assert waits.shown == [Tool.EDIT]


def test_the_square_of_what_is_chosen_resizes_it() -> None:
    hand = held(burning(), Tool.EDIT)
    hand.hand.click(PAGE, floats([600.0, 350.0]))
    hand.drag([630.0, 350.0], [655.0, 350.0])
    assert hand.given == [ChangeEntity(EntityKind.FIRE, 0, "radius", 55.0)]


@pytest.mark.parametrize("tool", ADDS)
def test_a_new_thing_stands_where_it_is_put_and_its_tool_stays_until_it_is_put_away(tool: Tool) -> None:
    hand = held(burning(), tool)
    for x in (400.0, 500.0):
        hand.hand.click(PAGE, floats([x, 500.0]))
    hand.hand.stroke(PAGE, "start", floats([[600.0, 500.0]]))
    hand.hand.stroke(PAGE, "update", floats([[620.0, 510.0]]))
    hand.hand.stroke(PAGE, "end", floats([], 0, 2))  # a press that moved
    added = [command for command in hand.given if isinstance(command, AddEntity)]
    assert [add.kind for add in added] == [ADDS[tool]] * 3
    assert [add.point[0] for add in added] == [400.0, 500.0, 620.0]
    assert hand.shown == [tool]
    assert not hand.view.editing, "its handles cannot be held"
    for _ in range(2):  # lets go of what was added last, then of the tool
        hand.hand.key(PAGE, "discard")
    assert hand.shown == [tool, Tool.PATH]


def test_a_link_goes_from_robot_to_robot_and_a_path_is_bent_from_where_it_is_held() -> None:
    hand = held(burning(), Tool.LINK)
    hand.drag([100.0, 100.0], [290.0, 110.0])
    hand.hand.tool(PAGE, Tool.MOVE_POINT)
    hand.drag([500.0, 500.0], [520.0, 560.0])
    link, bend = hand.given
    assert link == ToggleLink(0, 1)
    assert isinstance(bend, MovePathPoint)
    assert (bend.grip.tolist(), bend.point.tolist()) == ([500.0, 500.0], [520.0, 560.0])


def test_what_is_held_is_let_go_where_it_was_when_nobody_steers_any_more() -> None:
    hand = held(burning(), Tool.EDIT)
    hand.hand.stroke(PAGE, "start", floats([[600.0, 350.0]]))
    hand.hand.stroke(PAGE, "update", floats([[640.0, 400.0]]))
    assert hand.view.drag is not None
    hand.hand.hand_over(None)
    hand.hand.stroke(PAGE, "end", floats([], 0, 2))
    assert hand.view.drag is None
    assert not [command for command in hand.given if isinstance(command, MoveEntity)]


@pytest.mark.parametrize("at_once", [True, False])
def test_a_bent_path_waits_unless_it_is_committed_at_once(at_once: bool) -> None:
    hand = held(burning(), Tool.MOVE_POINT)
    hand.ui.update(commit_at_once=at_once)
    hand.drag([500.0, 500.0], [520.0, 560.0])
    (bend,) = hand.given
    assert isinstance(bend, MovePathPoint)
    assert bend.preview is not at_once


def test_keys_undo_redo_delete_and_take_up_tools() -> None:
    hand = held(burning(), Tool.EDIT)
    hand.hand.key(PAGE, "delete")  # nothing is chosen
    hand.hand.click(PAGE, floats([600.0, 350.0]))
    for key in ("undo", "redo", "delete", "tool_move_point"):
        hand.hand.key(PAGE, key)
    assert hand.given == [Undo(), Redo(), DeleteEntity(EntityKind.FIRE, 0)]
    assert hand.shown[-1] is Tool.MOVE_POINT
    assert hand.view.selected is None


def bar_and_polygon() -> Setup:
    square = floats([[800.0, 100.0], [900.0, 100.0], [900.0, 200.0], [800.0, 200.0]])
    return team(robots=[(100.0, 100.0)], bars=[(400.0, 300.0, 500.0, 300.0, 6.0)], polygons=[square])


@pytest.mark.parametrize(
    ("place", "handle", "to", "value"),
    [
        (EntityRef(EntityKind.BAR, 0), "length", [550.0, 300.0], 200.0),
        (EntityRef(EntityKind.BAR, 0), "angle", [450.0, 400.0], 90.0),
        (EntityRef(EntityKind.POLYGON, 0), "size", [850.0, 250.0], 100.0),
        (EntityRef(EntityKind.POLYGON, 0), "angle", [950.0, 150.0], 0.0),
    ],
)
def test_a_handle_changes_its_number(place: EntityRef, handle: str, to: list[float], value: float) -> None:
    setup = bar_and_polygon()
    layout, motion = setup.layout, setup.start.motion
    (grip,) = [found for found in handles_of(place, layout, motion, 1.0) if found.name == handle]
    drag = Drag(grip.point, floats(to), place, handle)
    assert wished(drag, layout, motion)[handle] == pytest.approx(value)
    (changed,) = result_of(drag, layout, motion)
    assert isinstance(changed, ChangeEntity)
    assert (changed.kind, changed.index, changed.name) == (place.kind, 0, handle)
    assert changed.value == pytest.approx(value)


def test_what_is_gone_when_the_hand_lets_go_is_left_alone() -> None:
    setup = burning()
    drag = Drag(floats([0.0, 0.0]), floats([9.0, 9.0]), EntityRef(EntityKind.FIRE, 5))
    assert result_of(drag, setup.layout, setup.start.motion) == []


def test_a_drag_ends_with_the_tool_with_which_it_began() -> None:
    hand = held(burning())
    hand.hand.stroke(PAGE, "start", floats([[350.0, 350.0]]))
    hand.hand.tool(PAGE, Tool.EDIT)
    hand.hand.stroke(PAGE, "end", floats([[600.0, 350.0]]))
    assert [type(command) for command in hand.given] == [StrokeBegin, StrokePoints, StrokePoints, StrokeEnd]
    hand.given.clear()
    hand.hand.stroke(PAGE, "start", floats([[600.0, 350.0]]))
    hand.hand.tool(PAGE, Tool.PATH)
    hand.hand.stroke(PAGE, "end", floats([[640.0, 350.0]]))
    assert [type(command) for command in hand.given] == [MoveEntity]
    assert hand.view.drag is None


def test_nothing_that_is_not_seen_to_be_chosen_is_deleted() -> None:
    fire = floats([600.0, 350.0])
    other_tool = held(burning(), Tool.EDIT)
    other_tool.hand.click(PAGE, fire)
    other_tool.hand.tool(PAGE, Tool.PATH)
    other_page = held(burning(), Tool.EDIT)
    other_page.hand.tool(8, Tool.EDIT)
    other_page.hand.click(PAGE, fire)
    other_page.hand.hand_over(8)
    for hand, page in ((other_tool, PAGE), (other_page, 8)):
        hand.hand.key(page, "delete")
        assert hand.given == []


def test_what_is_added_is_chosen_as_soon_as_it_is_there() -> None:
    hand = held(burning(), Tool.EDIT)
    hand.hand.click(PAGE, floats([600.0, 350.0]))
    hand.hand.tool(PAGE, Tool.CIRCLE)
    hand.hand.click(PAGE, floats([400.0, 500.0]))
    assert hand.view.selected == EntityRef(EntityKind.CIRCLE, 0)
    hand.hand.key(PAGE, "delete")
    assert [type(command) for command in hand.given] == [AddEntity], "it is not there yet"
    hand.ui.change(keep_choice(burning().layout))
    added = team(robots=[(100.0, 100.0), (300.0, 100.0)], circles=[(400.0, 500.0, 20.0)])
    hand.ui.change(keep_choice(added.layout))
    assert hand.view.selected == EntityRef(EntityKind.CIRCLE, 0)


def test_a_choice_ends_when_things_of_its_kind_come_or_go() -> None:
    two = team(fires=[(600.0, 350.0, 30.0), (900.0, 350.0, 30.0)])
    hand = held(two, Tool.EDIT)
    hand.hand.click(PAGE, floats([900.0, 350.0]))
    hand.ui.change(keep_choice(two.layout))
    assert hand.view.selected == EntityRef(EntityKind.FIRE, 1)
    three = team(fires=[(100.0, 350.0, 30.0), (600.0, 350.0, 30.0), (900.0, 350.0, 30.0)])
    hand.ui.change(keep_choice(three.layout))
    assert hand.view.selected is None


def test_a_link_that_ends_at_no_robot_is_none() -> None:
    hand = held(burning(), Tool.LINK)
    hand.drag([100.0, 100.0], [300.0, 400.0])
    assert hand.given == []


def test_the_middle_of_a_small_thing_moves_it_though_its_square_is_within_reach() -> None:
    setup = team(fires=[(600.0, 350.0, 8.0)])
    layout, motion = setup.layout, setup.start.motion
    chosen = EntityRef(EntityKind.FIRE, 0)
    for x, handle in ((600.0, ""), (603.0, ""), (606.0, "radius"), (608.0, "radius")):
        drag = gripped(floats([x, 350.0]), chosen, layout, motion, 10.0, 1.0)
        assert drag is not None
        assert (drag.place, drag.handle) == (chosen, handle)


def row_of_robots() -> Setup:
    return team(robots=[(100.0 * number, 100.0) for number in range(1, 7)])


def test_shift_clicks_and_a_lasso_choose_a_group_and_a_plain_click_or_escape_lets_it_go() -> None:
    hand = held(row_of_robots())
    for x in (200.0, 300.0, 300.0, 500.0):
        hand.hand.click(PAGE, floats([x, 100.0]), group=True)
    assert hand.view.group == {1, 4}
    hand.drag([150.0, 50.0], [450.0, 50.0], [450.0, 150.0], [150.0, 150.0], group=True)
    assert hand.view.group == {1, 2, 3}
    assert hand.given == []
    hand.hand.click(PAGE, floats([600.0, 100.0]))
    assert hand.view.group == frozenset()
    hand.hand.click(PAGE, floats([200.0, 100.0]), group=True)
    hand.hand.key(PAGE, "discard")
    assert hand.view.group == frozenset()


def test_the_next_path_of_a_group_is_for_its_robot_that_is_nearest_to_its_start() -> None:
    hand = held(row_of_robots())
    hand.drag([150.0, 50.0], [450.0, 50.0], [450.0, 150.0], [150.0, 150.0], group=True)
    hand.hand.stroke(PAGE, "start", floats([[1000.0, 100.0]]))
    assert hand.view.drawn_robot == 3, "the preview is of that robot"
    hand.hand.stroke(PAGE, "end", floats([[1100.0, 200.0]]))
    hand.drag([1000.0, 100.0], [1100.0, 200.0])
    ends = [command for command in hand.given if isinstance(command, StrokeEnd)]
    assert [end.robot for end in ends] == [3, None], "the group was for one path"
    assert hand.view.drawn_robot is None
    assert nearest_of(frozenset({7}), floats([[0.0, 0.0]]), floats([0.0, 0.0])) is None


def test_v_names_the_field_that_it_shows() -> None:
    hand = held(burning())
    for _ in range(4):
        hand.hand.key(PAGE, "field_arrows")
    assert hand.noted == ["Field: path", "Field: composite", "Field: blended", "Field: off"]
