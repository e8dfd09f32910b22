"""Recovery from deadlock: pockets, recovery stages, fires that grow to obstacles, the break-away and the return."""

import math

import numpy as np
import pytest

from higvf_console.control.guidance.paths import WINDOW, sketch_path
from higvf_console.control.guidance.recovery import ASK, OTHER_DIRECTION, passes
from higvf_console.control.parameters import Parameters, PerceptionParameters
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.scale import BODY_RADIUS
from higvf_console.core.state import PathStatus, SimState, Trace
from higvf_console.operator.path_commands import follow
from higvf_console.sim.simulation import advance
from higvf_console.world.setup import Setup, with_params
from tests.teams import team

U = floats([(500, 250), (640, 250), (640, 450), (500, 450), (500, 430), (620, 430), (620, 270), (500, 270)])
BEFORE_IT = ((300.0, 350.0), (260.0, 320.0), (260.0, 380.0))
IN_IT = ((590.0, 350.0), (540.0, 320.0), (540.0, 380.0))


def led(setup: Setup, points: Floats, seconds: float) -> tuple[SimState, list[Trace]]:
    """Follows a stroke until it is finished or given up."""
    state, traces = follow(setup.start, sketch_path(points, 4.0)), list[Trace]()
    for _ in range(round(seconds / 0.02)):
        state, trace = advance(state, setup.world, setup.params)
        traces.append(trace)
        if state.motion.path_status in (PathStatus.FINISHED, PathStatus.BLOCKED):
            break
    return state, traces


@pytest.mark.parametrize("start", [BEFORE_IT, IN_IT])
def test_a_team_before_or_in_a_u_whose_floor_cuts_its_path_arrives(start: tuple[tuple[float, float], ...]) -> None:
    setup = team(robots=start, polygons=[U])
    way = floats([start[0], (650.0, 350.0), (800.0, 350.0)])
    state, traces = led(setup, way, 60.0)
    assert state.motion.path_status == PathStatus.FINISHED
    assert min(trace.clearance.min() for trace in traces) >= 0.0


def test_a_path_that_ends_in_a_pocket_is_followed_into_it() -> None:
    setup = team(robots=BEFORE_IT, polygons=[U])
    state, _ = led(setup, floats([(300, 350), (450, 350), (590, 350)]), 60.0)
    assert state.motion.path_status == PathStatus.FINISHED
    assert state.motion.position[0, 0] > 540.0


def test_a_stall_reaches_another_stage_once_each_stall_time() -> None:
    times = [0.02 * tick for tick in range(1, 200)]
    assert [time for time in times if passes(time, 1.0, 0.02)] == pytest.approx([1.0, 2.0, 3.0], abs=0.021)


def test_a_held_team_tries_the_other_direction_then_asks_and_forgets_when_it_is_free() -> None:
    walls = [(400, 300, 400, 400, 5), (430, 270, 500, 270, 5), (430, 430, 500, 430, 5)]
    setup = team(robots=[(374.0, 350.0)], bars=walls)
    state = follow(setup.start, sketch_path(floats([(370, 350), (500, 350), (700, 350)]), 4.0))
    held = state.motion._replace(stalled=np.array([0.99]), circulation=np.ones_like(state.motion.circulation))
    state, _ = advance(state._replace(motion=held), setup.world, setup.params)
    stalled = state.motion._replace(stalled=np.array([1.0]))
    state, _ = advance(state._replace(motion=stalled), setup.world, setup.params)
    assert state.motion.recovery_stage.tolist() == [OTHER_DIRECTION]
    assert state.motion.circulation[0, 0] == -3
    for _ in range(1500):
        state, _ = advance(state, setup.world, setup.params)
    assert state.motion.path_status == PathStatus.FINISHED
    assert state.motion.recovery_stage.tolist() == [0]


def test_the_operator_is_asked_when_nothing_else_has_helped() -> None:
    box = floats([(560, 310), (640, 310), (640, 390), (560, 390)])
    setup = team(robots=[(600.0, 350.0)], polygons=[box])
    state, _ = led(setup, floats([(600, 350), (700, 350), (800, 350)]), 30.0)
    assert state.motion.path_status == PathStatus.BLOCKED
    assert state.motion.recovery_stage[0] >= ASK


def test_fires_that_grow_to_obstacles_are_passed_without_violation() -> None:
    setup = team(circles=[(500, 300, 25), (500, 420, 25)], fires=[(560, 360, 20)], growth=2.0, needs=3)
    params = setup.params._replace(perception=PerceptionParameters(perception_range=0.0))
    state, traces = led(with_params(setup, params), floats([(100, 350), (400, 350), (900, 350)]), 60.0)
    assert state.motion.path_status == PathStatus.FINISHED
    assert min(trace.clearance.min() for trace in traces) >= 0.0


def test_a_team_leaves_its_path_for_a_great_fire_and_returns_where_it_was() -> None:
    perception = PerceptionParameters(perception_range=120.0, break_away=0.2)
    setup = team(fires=[(400, 450, 20)], params=Parameters(perception=perception))
    state = follow(setup.start, sketch_path(floats([(100, 350), (500, 350), (900, 350)]), 4.0))
    seen: list[int] = []
    kept: list[float] = []
    for _ in range(4000):
        state, _ = advance(state, setup.world, setup.params)
        if not seen or state.motion.path_status != seen[-1]:
            seen.append(state.motion.path_status)
            kept.append(state.motion.path_parameter)
        if seen[-1] == PathStatus.FINISHED:
            break
    assert seen == [PathStatus.FOLLOWING, PathStatus.BREAK_AWAY, PathStatus.FOLLOWING, PathStatus.FINISHED]
    assert not state.motion.fire_burning.any()
    assert abs(kept[2] - kept[1]) <= WINDOW * BODY_RADIUS + 2 * state.intent.path.spacing


def test_without_a_threshold_nobody_breaks_away() -> None:
    assert Parameters().perception.break_away == math.inf
