"""How far the influenced robot has come along its path, and what ends the human intention."""

import math
from typing import Any

import pytest

from higvf_console.control.guidance.following import (
    VAIN_TIMEOUTS,
    beyond_reach,
    broken_away,
    destination,
    following,
    progress,
)
from higvf_console.control.guidance.paths import circle_path, line_path, sketch_path
from higvf_console.control.guidance.recovery import EN_ROUTE_TIMEOUTS, GIVE_UP
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import floats, ints
from higvf_console.core.state import NO_PATH, NOBODY, Intent, Motion, Path, PathEnding, PathStatus
from higvf_console.world.setup import Setup
from tests.teams import team

PARAMS = Parameters()
PERIOD = PARAMS.safety.control_period
FOLLOWING, FINISHED, HOLDING = int(PathStatus.FOLLOWING), int(PathStatus.FINISHED), int(PathStatus.HOLDING)
BLOCKED, AWAY = int(PathStatus.BLOCKED), int(PathStatus.BREAK_AWAY)
STRAIGHT = [(100.0, 100.0), (200.0, 100.0), (300.0, 100.0)]

pytestmark = pytest.mark.usefixtures("plain_kernels")


def straight() -> Path:
    return sketch_path(floats(STRAIGHT), 0.0)


def at(x: float, y: float, path: Path, setup: Setup | None = None, **changes: Any) -> tuple[Motion, Intent]:
    """Robot 1 of a team stands at (x, y) [m] and follows a path."""
    start = (setup or team()).start
    position = start.motion.position.copy()
    position[0] = (x, y)
    given = {"path_status": FOLLOWING, "path_left": path.duration, **changes}
    return start.motion._replace(position=position, **given), start.intent._replace(path=path, influenced=0)


def moved_on(motion: Motion, intent: Intent, *, stage: int = 0, setup: Setup | None = None) -> Any:
    return progress(motion, intent, FOLLOWING, stage, (setup or team()).world, PARAMS)


def test_the_human_intention_acts_only_while_a_path_is_followed() -> None:
    motion, intent = at(100.0, 100.0, straight())
    assert following(motion, intent)
    assert not following(motion._replace(path_status=BLOCKED), intent)
    assert not following(motion, intent._replace(path=NO_PATH))


def test_progress_is_the_nearest_point_of_the_path() -> None:
    w, status, idle, gap, _ = moved_on(*at(150.0, 130.0, straight()))
    assert w == pytest.approx(50.0, abs=1e-6)
    assert (status, idle) == (FOLLOWING, 0.0)
    assert gap >= 150.0


@pytest.mark.parametrize(
    ("ending", "status"), [(PathEnding.RELEASE, FINISHED), (PathEnding.HOLD, HOLDING), (PathEnding.LOOP, FOLLOWING)]
)
def test_an_open_path_ends_as_it_says_at_its_end_and_not_before(ending: PathEnding, status: int) -> None:
    path = straight()._replace(ending=int(ending))
    near = moved_on(*at(290.0, 100.0, path, path_parameter=190.0))
    assert near[1] == FOLLOWING, "within the end radius, but not at the end"
    done = moved_on(*at(301.0, 100.0, path, path_parameter=195.0))
    assert done[1] == status
    assert done[0] == pytest.approx(0.0 if ending == PathEnding.LOOP else 200.0, abs=1e-6)


def test_a_path_against_its_points_ends_at_their_first() -> None:
    path = straight()._replace(direction=-1.0)
    assert moved_on(*at(99.0, 100.0, path, path_parameter=5.0))[1] == FINISHED
    assert moved_on(*at(301.0, 100.0, path, path_parameter=195.0))[1] == FOLLOWING


def test_every_path_ends_when_its_time_is_over() -> None:
    motion, intent = at(150.0, 100.0, straight(), path_left=1.5 * PERIOD)
    _, status, _, _, left = moved_on(motion, intent)
    assert (status, left) == (FOLLOWING, pytest.approx(0.5 * PERIOD))
    assert moved_on(motion._replace(path_left=left), intent)[1] == FINISHED


def test_a_team_that_is_paused_or_stopped_loses_no_time() -> None:
    motion, intent = at(150.0, 100.0, straight(), path_idle=1.0, path_gap=1.0, path_left=3.0)
    for still in (intent._replace(paused=True), intent._replace(stopped=True)):
        assert moved_on(motion, still)[1:] == (FOLLOWING, 1.0, 1.0, 3.0)


@pytest.mark.parametrize(
    ("speed", "stage", "timeouts"),
    [(0.0, 0, 1.0), (60.0, 0, EN_ROUTE_TIMEOUTS), (0.0, 1, EN_ROUTE_TIMEOUTS), (0.0, GIVE_UP, 1.0)],
    ids=["at rest", "moving", "recovering", "given up"],
)
def test_a_robot_without_progress_is_given_up_after_its_timeout(speed: float, stage: int, timeouts: float) -> None:
    motion, intent = at(150.0, 100.0, straight(), path_gap=1.0)
    motion.velocity[0] = (speed, 0.0)
    idle = moved_on(motion, intent, stage=stage)[2]
    assert idle == pytest.approx(PERIOD / timeouts)
    late = motion._replace(path_idle=PARAMS.path.progress_timeout)
    assert moved_on(late, intent, stage=stage)[1] == BLOCKED


def test_a_robot_that_moves_to_an_end_that_nobody_can_reach_has_less_time() -> None:
    setup = team(circles=[(300.0, 100.0, 40.0)])
    motion, intent = at(150.0, 100.0, straight(), setup, path_gap=1.0, path_idle=0.5 * PARAMS.path.progress_timeout)
    motion.velocity[0] = (60.0, 0.0)
    idle = moved_on(motion, intent, setup=setup)[2]
    assert idle - motion.path_idle == pytest.approx(PERIOD / VAIN_TIMEOUTS)


def test_an_end_is_beyond_reach_where_one_obstacle_or_burning_fire_covers_the_end_radius() -> None:
    path, clear = straight(), team()
    motion, _ = at(150.0, 100.0, path, clear)
    assert not beyond_reach(path, motion, clear.world, PARAMS)
    behind = team(circles=[(300.0, 100.0, 40.0)])
    assert beyond_reach(path, motion, behind.world, PARAMS)
    assert not beyond_reach(path._replace(closed=True), motion, behind.world, PARAMS)
    burning = team(fires=[(300.0, 100.0, 40.0)])
    motion, _ = at(150.0, 100.0, path, burning)
    assert beyond_reach(path, motion, burning.world, PARAMS)
    motion.fire_burning[0] = False
    assert not beyond_reach(path, motion, burning.world, PARAMS)


def test_where_a_path_leads() -> None:
    assert destination(straight(), 0.0) == pytest.approx((300.0, 100.0))
    assert destination(straight()._replace(direction=-1.0), 0.0) == pytest.approx((100.0, 100.0))
    circle = circle_path(0.0, 0.0, 50.0)
    assert destination(circle, 0.25 * circle.length) == pytest.approx((0.0, -50.0)), "half a lap ahead"
    for endless in (line_path(0.0, 0.0, 0.0), NO_PATH):
        assert all(math.isnan(one) for one in destination(endless, 0.0))


def away(value: float, status: int = FOLLOWING, target: int = 0, component: tuple[int, ...] = (0, 0, 0)) -> int:
    """The status after robot 2 has seen a fire of a value [rad]; the threshold is 0.5 rad."""
    setup = team(fires=[(900.0, 350.0, 20.0)])
    motion, intent = at(150.0, 100.0, straight(), setup, path_status=status)
    values = floats([[0.0], [value], [0.0]])
    params = PARAMS._replace(perception=PARAMS.perception._replace(break_away=0.5))
    return broken_away(motion, intent, values, ints([NOBODY, target, NOBODY]), ints(component), params)


def test_a_team_leaves_its_path_for_a_fire_that_one_of_its_robots_values_enough() -> None:
    assert away(0.5) == AWAY
    assert away(0.49) == FOLLOWING
    assert away(0.5, component=(0, 1, 0)) == FOLLOWING, "a robot of another component does not count"


def test_a_team_returns_to_its_path_when_nobody_has_a_target_any_more() -> None:
    assert away(0.1, AWAY) == AWAY
    assert away(0.1, AWAY, target=NOBODY) == FOLLOWING
    assert away(9.0, FINISHED) == FINISHED
