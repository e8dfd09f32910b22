"""Teams among moving obstacles, for the tests."""

from collections.abc import Sequence

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import floats
from higvf_console.world.obstacles import Course, Obstacles, course_along
from higvf_console.world.setup import Setup, make_setup
from tests.teams import TRIANGLE, team

RADIUS = 20.0  # of a moving circle [m]


def with_obstacles(setup: Setup, obstacles: Obstacles) -> Setup:
    """The same team among other obstacles."""
    layout = setup.layout._replace(obstacles=obstacles)
    return make_setup(layout, layout.formation)


def moving_circle(
    course: Course,
    at: tuple[float, float] = (300.0, 300.0),
    robots: Sequence[tuple[float, float]] = TRIANGLE,
    fires: Sequence[tuple[float, float, float]] = (),
    still: Sequence[tuple[float, float, float]] = (),
    params: Parameters | None = None,
) -> Setup:
    """A team, circles that stand still, and one that starts `at` a place and follows a course."""
    circles = floats([*still, (*at, RADIUS)])
    obstacles = Obstacles(circles, floats([], 0, 5), (), (*([None] * len(still)), course))
    return with_obstacles(team(robots, fires, params=params), obstacles)


def mover_at(
    start: tuple[float, float],
    end: tuple[float, float],
    *,
    speed: float = 30.0,
    bar: bool = False,
    robots: Sequence[tuple[float, float]] = TRIANGLE,
    still: Sequence[tuple[float, float, float]] = (),
) -> Setup:
    """A team, circles that stand still, and a circle or an upright bar that goes from one place to another."""
    course = course_along([start, end], speed, loop=False)
    if not bar:
        return moving_circle(course, start, robots, still=still)
    x, y = start
    bars = floats([[x, y - 60.0, x, y + 60.0, 6.0]])
    return with_obstacles(team(robots), Obstacles(floats(still, -1, 3), bars, (), (), (course,)))
