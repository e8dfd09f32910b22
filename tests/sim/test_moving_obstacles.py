"""Runs among moving obstacles: clearances are kept, and every way of computing a run gives the same bytes."""

import numpy as np
import pytest

from higvf_console.analysis.active_constraints import active_constraints
from higvf_console.analysis.explain import Moved
from higvf_console.analysis.preview import foresee, surface_distance
from higvf_console.control.guidance.field import FieldKind, field_at
from higvf_console.control.guidance.paths import line_path
from higvf_console.control.parameters import Parameters
from higvf_console.control.safety.coupled_filter import CoupledFilter
from higvf_console.core.arrays import floats
from higvf_console.core.state import SimState, Trace
from higvf_console.operator.path_commands import follow
from higvf_console.sim.simulation import advance, advance_coupled, roll
from higvf_console.world.obstacles import course_along, course_straight
from higvf_console.world.setup import Setup
from tests.moving import mover_at, moving_circle
from tests.teams import team

BESIDE = (330.0, 350.0)  # the way of the obstacle below


def crossing(speed: float = 45.0, *, bar: bool = False) -> Setup:
    """A team at rest whose middle an obstacle crosses."""
    return mover_at((100.0, 600.0), (80.0, 40.0), speed=speed, bar=bar)


def bytes_of(state: SimState) -> list[bytes]:
    return [np.asarray(part).tobytes() for part in state.motion]


@pytest.mark.parametrize("bar", [False, True])
@pytest.mark.parametrize("coupled", [False, True])
def test_a_team_at_rest_yields_to_what_crosses_it(coupled: bool, bar: bool) -> None:
    setup, safety = crossing(bar=bar), CoupledFilter()
    state = setup.start
    for _ in range(700):
        state, trace = (
            advance_coupled(state, setup.world, setup.params, safety)
            if coupled
            else advance(state, setup.world, setup.params)
        )
        assert trace.clearance.min() >= -1e-9
        assert trace.barrier.min() >= -1e-9
        assert not trace.infeasible.any()
    assert np.hypot(*(state.motion.position - setup.start.motion.position).T).max() > 5.0


def test_a_roll_gives_the_states_of_repeated_advances_bit_for_bit_however_it_is_cut() -> None:
    setup = moving_circle(
        course_along([(300.0, 300.0), (120.0, 350.0), (300.0, 420.0)], 35.0, True), fires=[(600.0, 350.0, 30.0)]
    )
    state = setup.start
    for _ in range(400):
        state, _ = advance(state, setup.world, setup.params)
    whole, _ = roll(setup.start, setup.world, setup.params, 400)
    half, _ = roll(setup.start, setup.world, setup.params, 163)
    rest, _ = roll(half, setup.world, setup.params, 237)
    assert bytes_of(whole) == bytes_of(state) == bytes_of(rest)


def test_what_a_preview_foresees_among_moving_obstacles_is_what_happens() -> None:
    setup = crossing(speed=30.0)
    state, _ = roll(setup.start, setup.world, setup.params, 150)
    preview = foresee(state, state, setup, 6.0)
    assert preview is not None
    after, history = roll(state, setup.world, setup.params, 300)
    assert preview.tracks[:, -1].tobytes() == after.motion.position.tobytes()
    assert preview.clearance == history.clearance.min()


def test_a_path_is_judged_by_where_obstacles_are_now() -> None:
    setup = crossing()
    state, _ = roll(setup.start, setup.world, setup.params, 200)
    centre = setup.layout.obstacles_at(200).circles[0, :2]
    gap = surface_distance(floats([centre + floats([50.0, 0.0])]), state.motion, setup)
    assert gap[0] == pytest.approx(30.0)


def test_a_moving_obstacle_hides_a_fire_only_while_it_stands_before_it() -> None:
    setup = moving_circle(
        course_along([(350.0, 600.0), (350.0, 100.0)], 50.0, loop=False),
        (350.0, 600.0),
        [(100.0, 350.0)],
        [(600.0, 350.0, 5.0)],
    )
    state, hidden = setup.start, list[bool]()
    for _ in range(500):
        state, trace = advance(state, setup.world, setup.params)
        hidden.append(bool(trace.fire_value[0, 0] == 0.0))
    assert not hidden[0]
    assert any(hidden)
    assert not hidden[-1]


def why(robot: int, setup: Setup, ticks: int) -> tuple[list[str], Trace]:
    before, _ = roll(setup.start, setup.world, setup.params, ticks)
    after, trace = advance(before, setup.world, setup.params)
    return [found.name for found in active_constraints(robot, Moved(before, after.motion, trace), setup)], trace


@pytest.mark.parametrize(("bar", "name"), [(False, "circle 1"), (True, "bar 1")])
def test_what_holds_a_robot_is_named_while_a_moving_obstacle_pushes_it(bar: bool, name: str) -> None:
    setup = crossing(bar=bar)
    names = {found for ticks in range(100, 420, 10) for robot in range(3) for found in why(robot, setup, ticks)[0]}
    assert name in names


def test_the_drawn_field_goes_round_obstacles_where_they_are() -> None:
    setup = moving_circle(course_straight(50.0, 0.0), at=BESIDE)
    state = follow(setup.start, line_path(0.0, 352.0, 0.0, 1.0))
    later = state._replace(motion=state.motion._replace(tick=400))
    points = floats([[BESIDE[0] - 28.0, 352.0]])
    near, gone = (field_at(FieldKind.COMPOSITE, points, s, setup.world, setup.params)[0] for s in (state, later))
    assert abs(near[1]) > 1.0
    assert gone[1] == pytest.approx(0.0, abs=1e-9)


def slow_team(growth: float) -> Setup:
    params = Parameters()
    params = params._replace(
        safety=params.safety._replace(speed_limit=5.0), blending=params.blending._replace(cruise_speed=4.0)
    )
    return team(robots=[(100.0, 350.0)], fires=[(160.0, 350.0, 20.0)], params=params, growth=growth)


def test_a_run_says_so_before_a_fire_that_outruns_the_robots_violates_their_clearance() -> None:
    setup = slow_team(growth=6.0)
    state, flagged, violated = setup.start, list[int](), list[int]()
    for tick in range(1500):
        state, trace = advance(state, setup.world, setup.params)
        if trace.infeasible.any():
            flagged.append(tick)
        if trace.clearance.min() < 0.0:
            violated.append(tick)
    assert violated
    assert flagged[0] < violated[0]
    assert set(violated) <= set(flagged)


def test_a_fire_that_robots_can_yield_to_flags_nobody() -> None:
    setup = slow_team(growth=4.0)
    _, history = roll(setup.start, setup.world, setup.params, 1500)
    assert not history.infeasible.any()
    assert history.clearance.min() >= -1e-9
