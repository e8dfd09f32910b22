"""A repaired path keeps its other parts and is followed as before."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from higvf_console.control.guidance.paths import EVERYWHERE, circle_path, line_path, nearest, path_points, sketch_path
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    ClearPath,
    Confirm,
    ForgetPath,
    MovePathPoint,
    OperatorCommand,
    ReversePath,
    ShapePath,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    TakeUpPath,
)
from higvf_console.core.errors import PathError
from higvf_console.core.state import NO_PATH, Path, PathEnding, PathStatus, SimState
from higvf_console.operator.path_edits import bent, reclosed, redrawn
from higvf_console.operator.reducer import apply_command
from higvf_console.sim.simulation import advance
from higvf_console.world.setup import Setup
from tests.teams import stroke, team

WAY = floats([[100.0, 350.0], [300.0, 360.0], [500.0, 340.0], [700.0, 360.0], [900.0, 350.0]])
OPEN = sketch_path(WAY, 0.0, closed=False)
CLOSED = sketch_path(
    floats([[500.0 + 200.0 * math.cos(a), 350.0 + 200.0 * math.sin(a)] for a in np.linspace(0.0, 2.0 * math.pi, 60)]),
    0.0, closed=True,
)  # fmt: skip


def distances(path: Path, points: Floats) -> Floats:
    return floats([math.dist(point, nearest(path, 0.0, EVERYWHERE, *point)[1:3]) for point in points.tolist()])


def along(path: Path, count: int = 80) -> Floats:
    return path_points(path, floats(np.linspace(0.0, path.length, count)))


def test_redrawing_a_part_replaces_only_the_part_between_the_ends_of_the_stroke() -> None:
    detour = floats([[400.0, 352.0], [450.0, 500.0], [550.0, 500.0], [600.0, 350.0]])
    new = redrawn(OPEN, detour, 0.0)
    assert distances(new, detour[1:-1]).max() < 5.0
    kept = along(OPEN)
    kept = kept[(kept[:, 0] < 340.0) | (kept[:, 0] > 660.0)]
    assert distances(new, kept).max() < 2.0
    assert distances(new, floats([[500.0, 340.0]])).min() > 90.0
    assert not new.closed


def test_a_part_may_be_redrawn_against_the_direction_of_the_path() -> None:
    detour = floats([[600.0, 350.0], [550.0, 500.0], [450.0, 500.0], [400.0, 352.0]])
    new = redrawn(OPEN, detour, 0.0)
    np.testing.assert_allclose(along(new)[[0, -1]], along(OPEN)[[0, -1]], atol=1e-6)
    assert distances(new, detour[1:-1]).max() < 5.0


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_stroke_that_leaves_an_open_path_becomes_its_new_end(direction: float) -> None:
    path = OPEN._replace(direction=direction)
    new = redrawn(path, floats([[500.0, 345.0], [520.0, 450.0], [520.0, 600.0]]), 0.0)
    points = along(new) if direction > 0.0 else along(new)[::-1]
    start = WAY[0] if direction > 0.0 else WAY[-1]
    np.testing.assert_allclose(points[0], start, atol=1e-6)
    np.testing.assert_allclose(points[-1], [520.0, 600.0], atol=1e-6)


@pytest.mark.parametrize("turn", [1, -1])
def test_on_a_closed_path_the_stroke_replaces_the_shorter_arc(turn: int) -> None:
    bulge = floats([[684.0, 430.0], [800.0, 350.0], [684.0, 270.0]])[::turn]
    new = redrawn(CLOSED, bulge, 0.0)
    assert new.closed
    assert distances(new, bulge).max() < 6.0
    kept = along(CLOSED)
    assert distances(new, kept[kept[:, 0] < 600.0]).max() < 3.0
    assert distances(new, floats([[700.0, 350.0]])).min() > 30.0


@pytest.mark.parametrize(
    ("path", "points", "message"),
    [
        (NO_PATH, [[0, 0], [1, 1]], "there is no path"),
        (line_path(0.0, 0.0, 0.0), [[0, 0], [1, 1]], "endless line"),
        (OPEN, [[500, 345]], "at least 2 points"),
        (OPEN, [[500, 600], [600, 350]], "the stroke starts 2.. m from the path; start it within 80 m"),
        (CLOSED, [[684, 430], [900, 350]], "the stroke ends 200 m from the closed path; end it within 80 m"),
    ],
)
def test_a_part_that_cannot_be_redrawn_is_refused(path: Path, points: list[list[float]], message: str) -> None:
    with pytest.raises(PathError, match=message):
        redrawn(path, floats(points), 0.0)


@pytest.mark.parametrize("path", [OPEN, CLOSED], ids=["open", "closed"])
@settings(max_examples=30)
@given(share=st.floats(0.0, 1.0), x=st.floats(-100.0, 100.0), y=st.floats(-100.0, 100.0))
def test_a_moved_point_deforms_the_path_near_it_and_leaves_the_rest_unchanged(
    path: Path, share: float, x: float, y: float
) -> None:
    foot = path_points(path, floats([share * path.length]))[0]
    point = foot + floats([x, y])
    new = bent(path, foot, point)
    assert distances(new, point[None]).max() < 3.0
    far = along(path)
    far = far[np.hypot(*(far - foot).T) > max(path.length / 6.0, 1.5 * math.hypot(x, y)) + 20.0]
    assert distances(new, far).max(initial=0.0) < 3.0
    assert new.closed == path.closed


def test_a_path_may_be_closed_and_opened_again() -> None:
    arc = sketch_path(along(CLOSED)[:60], 0.0, closed=False)
    joined = reclosed(arc, closed=True)
    assert joined.closed
    assert joined.length > arc.length
    np.testing.assert_allclose(along(joined)[0], along(joined)[-1], atol=1e-6)
    assert not reclosed(joined, closed=False).closed
    assert reclosed(arc, closed=False) is arc
    opened = reclosed(circle_path(500.0, 350.0, 100.0), closed=False)
    assert opened.length == pytest.approx(200.0 * math.pi, rel=1e-3)


def test_a_repaired_path_is_followed_as_before() -> None:
    path = OPEN._replace(direction=-1.0, ending=int(PathEnding.HOLD), pace=0.5, duration=40.0)
    for new in (redrawn(path, WAY[1:4] + 5.0, 0.0), bent(path, WAY[2], WAY[2] + 30.0)):
        assert (new.direction, new.ending, new.pace, new.duration) == (-1.0, PathEnding.HOLD, 0.5, 40.0)


def following(ticks: int = 100) -> tuple[Setup, SimState]:
    setup = team()
    return setup, gone_on(setup, commanded(setup, setup.start, stroke(WAY)), ticks)


def commanded(setup: Setup, state: SimState, commands: Sequence[OperatorCommand]) -> SimState:
    for command in commands:
        state, _ = apply_command(state, command, setup)
    return state


def gone_on(setup: Setup, state: SimState, ticks: int) -> SimState:
    for _ in range(ticks):
        state, _ = advance(state, setup.world, setup.params)
    return state


def test_a_robot_continues_from_its_place_when_its_path_is_repaired() -> None:
    setup, state = following()
    done = state.motion.path_parameter
    assert 50.0 < done < 400.0
    drawn: list[OperatorCommand] = [
        StrokeBegin(),
        StrokePoints(floats([[600, 350], [650, 450], [700, 360]])),
        StrokeEnd(use="redraw"),
    ]
    for commands in (drawn, [MovePathPoint(floats([700.0, 350.0]), floats([700.0, 420.0]))]):
        new = commanded(setup, state, commands)
        assert new.intent.path.length > state.intent.path.length
        assert new.motion.path_parameter == pytest.approx(done, abs=10.0)
        assert new.pointer_state.paths == (new.intent.path,)


DETOUR = floats([[600.0, 350.0], [650.0, 450.0], [700.0, 360.0]])
GRIP, POINT = floats([700.0, 350.0]), floats([700.0, 420.0])


def repairs(preview: bool) -> dict[str, list[OperatorCommand]]:
    return {
        "redraw": [StrokeBegin(), StrokePoints(DETOUR), StrokeEnd(use="redraw", preview=preview)],
        "move_point": [MovePathPoint(GRIP, POINT, preview=preview)],
    }


@pytest.mark.parametrize("repair", ["redraw", "move_point"])
def test_a_pending_repair_moves_nothing_and_equals_an_immediate_repair_once_confirmed(repair: str) -> None:
    setup, state = following()
    pending = commanded(setup, state, repairs(True)[repair])
    assert (pending.motion, pending.intent) == (state.motion, state.intent)
    confirmed, at_once = commanded(setup, pending, [Confirm()]), commanded(setup, state, repairs(False)[repair])
    assert confirmed.intent.path.length == at_once.intent.path.length > state.intent.path.length
    assert confirmed.motion.path_parameter == at_once.motion.path_parameter > 50.0, "it goes on where it was"
    assert confirmed.pointer_state.paths == (confirmed.intent.path,), "in the list it takes the place of the old one"
    assert (confirmed.pointer_state.pending, confirmed.pointer_state.pending_repairs) == (NO_PATH, False)


@pytest.mark.parametrize(
    ("commands", "longer"),
    [
        *((commands, True) for commands in repairs(False).values()),
        ([ReversePath()], False),
        ([ShapePath(pace=0.5, ending="hold")], False),
    ],
)
def test_repairs_change_the_pending_path_if_there_is_one(commands: list[OperatorCommand], longer: bool) -> None:
    setup, state = following()
    drawn = stroke(WAY.tolist())
    pending = commanded(setup, state, [*drawn[:2], StrokeEnd(smoothing=0.0, preview=True)])
    new = commanded(setup, pending, commands)
    assert (new.motion, new.intent) == (state.motion, state.intent)
    path, old = new.pointer_state.pending, pending.pointer_state.pending
    assert path is not old
    assert (path.length > old.length) is longer
    confirmed = commanded(setup, new, [Confirm()])
    assert confirmed.intent.path is path
    assert len(confirmed.pointer_state.paths) == 2, "it is a path of its own"


def test_a_pending_repair_of_a_path_cleared_meanwhile_becomes_a_new_path() -> None:
    setup, state = following()
    state = commanded(setup, state, [*repairs(True)["move_point"], ClearPath(), Confirm()])
    assert state.motion.path_status == PathStatus.FOLLOWING
    assert state.pointer_state.paths[-1] is state.intent.path


def test_a_moved_point_stays_within_the_arena() -> None:
    setup, state = following()
    new = commanded(setup, state, [MovePathPoint(floats([500.0, 340.0]), floats([500.0, 5000.0]))])
    assert along(new.intent.path)[:, 1].max() < 720.0


def test_without_a_path_every_repair_is_refused_and_changes_nothing() -> None:
    setup = team()
    grip = floats([1.0, 1.0])
    for command in (MovePathPoint(grip, grip), ShapePath(pace=0.5), ReversePath(), TakeUpPath(0), ForgetPath(2)):
        state, events = apply_command(setup.start, command, setup)
        assert state is setup.start
        assert [event.kind for event in events] == ["refused"]


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (ShapePath(pace=3.0), "pace 3 is outside 0.2 to 1.5"),
        (ShapePath(duration=-1.0), "duration -1 s is not at least 0 s"),
        (ShapePath(duration=math.nan), "duration nan s is not at least 0 s"),
        (MovePathPoint(floats([500.0, 350.0]), floats([math.nan, 0.0])), "not finite"),
    ],
)
def test_an_invalid_property_of_a_path_is_refused_with_the_choices(command: OperatorCommand, message: str) -> None:
    setup, state = following(10)
    after, events = apply_command(state, command, setup)
    assert after is state
    assert message in events[0].text


def test_listed_paths_are_followed_again_and_removed_by_number() -> None:
    setup, state = following(20)
    first = state.intent.path
    state = commanded(setup, state, stroke([(100.0, 300.0), (300.0, 100.0), (600.0, 100.0)]))
    second = state.intent.path
    assert state.pointer_state.paths == (first, second)
    state = commanded(setup, state, [TakeUpPath(0)])
    assert state.intent.path is first
    assert state.motion.path_status == PathStatus.FOLLOWING
    state = commanded(setup, state, [ForgetPath(0)])
    assert state.pointer_state.paths == (second,)
    assert state.intent.path is first
