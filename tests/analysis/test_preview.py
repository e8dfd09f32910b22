"""What is foreseen is what happens, and it says what an operator asks."""

from collections.abc import Sequence

import numpy as np
import pytest

from higvf_console.analysis.preview import Preview, foresee, repulsive_pieces, surface_distance, wish
from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    Confirm,
    OperatorCommand,
    Pause,
    ProposePick,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.core.state import SimState
from higvf_console.operator.reducer import apply_command
from higvf_console.sim.simulation import advance
from higvf_console.world.setup import Setup
from tests.teams import stroke, team

LINE = [(100.0, 350.0), (300.0, 400.0), (500.0, 350.0)]
DRAWING: list[OperatorCommand] = [StrokeBegin(), StrokePoints(floats(LINE))]


@pytest.fixture
def setup() -> Setup:
    return team(fires=[(400.0, 420.0, 20.0), (700.0, 250.0, 20.0)], circles=[(300.0, 380.0, 15.0)])


def after(setup: Setup, commands: Sequence[OperatorCommand], state: SimState | None = None) -> SimState:
    state = state or setup.start
    for command in commands:
        state, _ = apply_command(state, command, setup)
    return state


def foreseen(setup: Setup, state: SimState, horizon: float = 5.0) -> Preview:
    wished = wish(state, setup)
    assert wished is not None
    preview = foresee(state, wished, setup, horizon)
    assert preview is not None
    return preview


def run_on(setup: Setup, state: SimState, ticks: int) -> list[SimState]:
    states = [state]
    for _ in range(ticks):
        states.append(advance(states[-1], setup.world, setup.params)[0])
    return states


def moved_on(setup: Setup) -> SimState:
    return run_on(setup, setup.start, 60)[-1]


def assert_happens(preview: Preview, states: Sequence[SimState]) -> None:
    """Every point of the tracks is, bit for bit, where the robots came to be."""
    ticks = np.linspace(0, len(states) - 1, preview.tracks.shape[1]).round().astype(int)
    went = np.stack([states[tick].motion.position for tick in ticks], axis=1)
    assert preview.tracks.tobytes() == went.tobytes()


def test_what_is_foreseen_of_a_repair_of_a_pending_path_is_bit_for_bit_what_its_confirmation_brings(
    setup: Setup,
) -> None:
    waits = after(setup, [*DRAWING, StrokeEnd(robot=1, preview=True)], moved_on(setup))
    pointer_state = after(
        setup, [StrokeBegin(), StrokePoints(floats([(300.0, 400.0), (400.0, 500.0), (500.0, 350.0)]))], waits
    )
    wished = wish(pointer_state, setup, StrokeEnd(use="redraw"))
    assert wished is not None
    preview = foresee(pointer_state, wished, setup, 5.0)
    assert preview is not None
    assert preview.start.intent.path.length > waits.pointer_state.pending.length
    states = run_on(setup, after(setup, [StrokeEnd(use="redraw", preview=True), Confirm()], pointer_state), 250)
    assert_happens(preview, states)


def test_what_is_foreseen_of_a_pending_path_is_bit_for_bit_what_its_confirmation_brings(setup: Setup) -> None:
    state = after(setup, [*DRAWING, StrokeEnd(robot=1, preview=True)], moved_on(setup))
    states = run_on(setup, after(setup, [Confirm()], state), 250)
    preview = foreseen(setup, state)
    assert_happens(preview, states)
    assert preview.future.loss_area == float((np.pi * states[-1].motion.fire_radius ** 2).sum())
    assert preview.clearance < np.inf


def test_what_is_foreseen_of_a_growing_stroke_is_what_its_end_brings(setup: Setup) -> None:
    state = after(setup, DRAWING, moved_on(setup))
    assert_happens(foreseen(setup, state), run_on(setup, after(setup, [StrokeEnd()], state), 250))


def test_what_is_foreseen_of_a_proposed_robot_is_what_its_pick_brings(setup: Setup) -> None:
    state = after(setup, [*stroke(LINE), ProposePick(2)])
    assert_happens(foreseen(setup, state), run_on(setup, after(setup, [Confirm()], state), 250))


def test_the_other_future_is_that_of_doing_nothing(setup: Setup) -> None:
    away = [StrokeBegin(), StrokePoints(floats([(100, 350), (100, 500), (300, 650)]))]
    preview = foreseen(setup, after(setup, away, moved_on(setup)), 20.0)
    nothing = run_on(setup, moved_on(setup), 1000)[-1].motion
    assert preview.otherwise.loss_area == float((np.pi * nothing.fire_radius**2).sum())
    assert preview.otherwise.loss_area != preview.future.loss_area


def test_a_paused_team_is_foreseen_as_it_would_go_on(setup: Setup) -> None:
    waits = after(setup, [*DRAWING, StrokeEnd(preview=True)])
    paused = foreseen(setup, after(setup, [Pause()], waits))
    assert paused.resumed
    assert paused.tracks.tobytes() == foreseen(setup, waits).tracks.tobytes()


def test_nothing_is_foreseen_without_a_wish_or_of_a_stroke_that_is_no_path(setup: Setup) -> None:
    assert wish(setup.start, setup) is None
    assert wish(after(setup, [StrokeBegin(), StrokePoints(floats(LINE[:2]))]), setup) is None


def test_fires_are_told_in_the_order_in_which_they_go_out() -> None:
    setup = team(fires=[(700.0, 350.0, 20.0), (250.0, 350.0, 20.0)])
    out = foreseen(setup, after(setup, DRAWING), 40.0).future.fires_out
    assert [fire for fire, _ in out] == [1, 0]
    assert 0.0 < out[0][1] < out[1][1] <= 40.0


def test_a_short_path_is_finished_within_the_horizon_and_a_long_one_is_not(setup: Setup) -> None:
    quick = after(setup, [StrokeBegin(), StrokePoints(floats([(100, 350), (110, 350), (120, 350)]))])
    assert foreseen(setup, quick).finish is not None
    assert foreseen(setup, after(setup, DRAWING), 1.0).finish is None


def test_work_that_is_no_longer_wanted_is_dropped(setup: Setup) -> None:
    state = after(setup, DRAWING)
    asked: list[int] = []

    def enough() -> bool:
        asked.append(1)
        return len(asked) > 2

    wished = wish(state, setup)
    assert wished is not None
    assert foresee(state, wished, setup, 60.0, enough) is None
    assert len(asked) == 3


def test_the_path_is_marked_where_it_enters_a_repulsive_area(setup: Setup) -> None:
    wished = wish(after(setup, DRAWING), setup)
    assert wished is not None
    pieces = repulsive_pieces(wished.intent.path, wished.motion, setup)
    margin = setup.params.boundaries.repulsive_margin
    gap = np.hypot(*(pieces.mean(axis=1) - [300.0, 380.0]).T) - 15.0
    near_fire = np.hypot(*(pieces.mean(axis=1) - [400.0, 420.0]).T) - 20.0
    assert len(pieces)
    assert (np.minimum(gap, near_fire) < margin).all()
    assert (gap < margin).any()


def test_inside_an_irregular_obstacle_the_distance_is_negative_and_an_extinguished_fire_is_none() -> None:
    corners = [(300.0, 300.0), (500.0, 300.0), (500.0, 500.0), (300.0, 500.0)]
    square = floats(corners)
    bars = [(*corners[i - 1], *corners[i], 0.0) for i in range(4)]
    setup = team(fires=[(800.0, 350.0, 20.0)], bars=bars, polygons=[square])
    points = floats([(400, 400), (800, 350), (280, 400)])
    assert surface_distance(points, setup.start.motion, setup).tolist() == [-100.0, -20.0, 20.0]
    out = setup.start.motion._replace(fire_burning=np.array([False]))
    assert surface_distance(points, out, setup)[1] > 100.0


ROUND_FIRE_2 = [(650.0, 200.0), (750.0, 200.0), (750.0, 300.0), (650.0, 300.0)]
OTHER_WAY = [(250.0, 400.0), (300.0, 470.0), (400.0, 480.0), (430.0, 370.0)]
ENDS = [
    (OTHER_WAY, StrokeEnd(use="redraw")),
    (ROUND_FIRE_2, StrokeEnd(use="priority")),
    (OTHER_WAY, StrokeEnd(ending="hold", pace=0.6, duration=3.0)),
    (OTHER_WAY, StrokeEnd(ending="loop", pace=1.4)),
]


@pytest.mark.parametrize(("points", "end"), ENDS, ids=["amend", "priority", "hold", "loop"])
def test_whatever_a_stroke_is_drawn_for_what_is_foreseen_is_bit_for_bit_what_its_end_brings(
    setup: Setup, points: list[tuple[float, float]], end: StrokeEnd
) -> None:
    state = run_on(setup, after(setup, [*DRAWING, StrokeEnd()]), 60)[-1]
    state = after(setup, [StrokeBegin(), StrokePoints(floats(points))], state)
    wished = wish(state, setup, end)
    assert wished is not None
    preview = foresee(state, wished, setup, 5.0)
    assert preview is not None
    assert_happens(preview, run_on(setup, after(setup, [end], state), 250))
    assert preview.tracks.tobytes() != foreseen(setup, state).tracks.tobytes()


def test_a_priority_changes_the_order_that_is_foreseen() -> None:
    setup = team([(300.0, 430.0)], [(300.0, 300.0, 30.0), (300.0, 600.0, 15.0)], growth=0.0, needs=1)
    state = after(setup, [StrokeBegin(), StrokePoints(floats([(250, 550), (350, 550), (350, 650), (250, 650)]))])
    wished = wish(state, setup, StrokeEnd(use="priority"))
    assert wished is not None
    preview = foresee(state, wished, setup, 40.0)
    assert preview is not None
    assert [fire for fire, _ in preview.future.fires_out] == [1, 0]
    assert [fire for fire, _ in preview.otherwise.fires_out] == [0, 1]


def test_nothing_is_foreseen_of_a_part_drawn_beside_the_path_nor_of_an_obstacle(setup: Setup) -> None:
    state = after(setup, [*DRAWING, StrokeEnd(), StrokeBegin(), StrokePoints(floats(ROUND_FIRE_2))])
    assert wish(state, setup, StrokeEnd(use="redraw")) is None
    assert wish(state, setup, StrokeEnd(use="obstacle")) is None
    elsewhere = after(setup, [StrokeBegin(), StrokePoints(floats(OTHER_WAY[:3]))])
    assert wish(elsewhere, setup, StrokeEnd(use="priority")) is None


def test_an_end_at_which_the_team_holds_is_foreseen_as_a_finish(setup: Setup) -> None:
    state = after(setup, DRAWING)
    wished = wish(state, setup, StrokeEnd(ending="hold"))
    released = wish(state, setup, StrokeEnd())
    assert wished is not None
    assert released is not None
    held, freed = foresee(state, wished, setup, 20.0), foresee(state, released, setup, 20.0)
    assert held is not None
    assert freed is not None
    assert held.finish == freed.finish is not None


def test_a_path_that_is_over_already_has_no_finish_to_foresee(setup: Setup) -> None:
    state = after(setup, [*DRAWING, StrokeEnd(duration=0.1)])
    state = run_on(setup, state, 20)[-1]
    state = after(setup, [StrokeBegin(), StrokePoints(floats(ROUND_FIRE_2))], state)
    wished = wish(state, setup, StrokeEnd(use="priority"))
    assert wished is not None
    preview = foresee(state, wished, setup, 2.0)
    assert preview is not None
    assert preview.finish is None
