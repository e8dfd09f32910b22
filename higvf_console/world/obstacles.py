"""The obstacles of a world, as people give them: circles, bars and polygons; circles and bars may move."""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from higvf_console.control.guidance.obstacles import LOOP, ONWARD, STOP, course_point
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.quantity import Quantity

SPEED = Quantity("m/s", 0.0, 100.0, "", "How fast it moves along its course.")


class Course(NamedTuple):
    """How an obstacle moves: along a polyline at a constant speed, without turning.

    Attributes:
        points: (C, 3) x, y relative to the first [m], and the arc length up to each [m].
        ending: `obstacles.STOP`, LOOP or ONWARD: what happens at the last point.
        speed: [m/s].
        start: arc length at time 0 [m]; not 0 once the speed has been changed in a run.
    """

    points: Floats
    ending: int
    speed: float
    start: float = 0.0

    def travelled(self, time: float) -> float:
        """Arc length at a time [s] of the session, were the course endless [m]."""
        return self.start + self.speed * time

    def offset(self, time: float) -> Floats:
        """(2,) where it is at a time [s], relative to the start of the course [m]."""
        return floats(course_point(self.points, 0, len(self.points), self.travelled(time), self.ending))

    def paced(self, speed: float, time: float) -> "Course":
        """The same course at another speed [m/s], with the same place at a time [s]."""
        travelled, length = self.travelled(time), float(self.points[-1, 2])
        if self.ending == STOP:
            travelled = min(max(travelled, 0.0), length)
        return self._replace(speed=speed, start=travelled - speed * time)


Courses: TypeAlias = tuple[Course | None, ...]


class Obstacles(NamedTuple):
    """What stands or moves in the way.

    Attributes:
        circles: (P, 3) as in `state.World`; of a moving one at the start of its course.
        bars: (Q, 5) as in `state.World`, without the edges of polygons; likewise.
        polygons: closed chains (n, 2) [m] as in `world.polygons`: those of the file, then those of its masks.
        circle_courses: of the first circles; None, and what is not listed, stands still.
        bar_courses: of the first bars, likewise.
    """

    circles: Floats
    bars: Floats
    polygons: tuple[Floats, ...]
    circle_courses: Courses = ()
    bar_courses: Courses = ()

    def still(self) -> "Obstacles":
        """Those that do not move."""
        moving = {row for row, _ in self.movers()}
        circles = [row for row in range(len(self.circles)) if row not in moving]
        bars = [row for row in range(len(self.bars)) if row + len(self.circles) not in moving]
        return Obstacles(floats(self.circles[circles]), floats(self.bars[bars]), self.polygons)

    def at(self, time: float) -> "Obstacles":
        """The obstacles with circles and bars where they are at a time [s]; courses are left as they are."""
        if not any(self.circle_courses) and not any(self.bar_courses):
            return self
        circles, bars = self.circles.copy(), self.bars.copy()
        for row, course in enumerate(self.circle_courses):
            circles[row, :2] += 0.0 if course is None else course.offset(time)
        for row, course in enumerate(self.bar_courses):
            bars[row, :4] += 0.0 if course is None else np.tile(course.offset(time), 2)
        return self._replace(circles=circles, bars=bars)

    def name(self, row: int) -> str:
        """What people call a row among circles and then bars: "circle 1", "bar 2"."""
        circles = len(self.circles)
        return f"circle {row + 1}" if row < circles else f"bar {row - circles + 1}"

    def movers(self) -> list[tuple[int, Course]]:
        """Row among circles and then bars, and course, of each moving obstacle."""
        found = [*enumerate(self.circle_courses), *enumerate(self.bar_courses, len(self.circles))]
        return [(row, course) for row, course in found if course is not None]


def course_of(courses: Courses, row: int) -> Course | None:
    """The course of an obstacle; None where it stands still."""
    return courses[row] if row < len(courses) else None


NO_OBSTACLES = Obstacles(floats([], 0, 3), floats([], 0, 5), ())


def course_along(points: Sequence[tuple[float, float]], speed: float, loop: bool) -> Course:
    """The course through points [m], the first of which is where the obstacle is at time 0.

    Points that repeat the one before are left out.

    Raises:
        ValueError: fewer than two points are left.
    """
    given = floats(points, -1, 2) - points[0]
    if loop:
        given = np.concatenate([given, np.zeros((1, 2))])
    given = given[np.concatenate([[True], np.hypot(*np.diff(given, axis=0).T) > 0.0])]
    if len(given) < 2:
        raise ValueError("all points of the path are in one place")
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(given, axis=0).T))])
    return Course(floats(np.column_stack([given, arc])), LOOP if loop else STOP, speed)


def course_straight(vx: float, vy: float) -> Course:
    """The course that goes on for ever at a velocity [m/s], which is not zero."""
    speed = float(np.hypot(vx, vy))
    return Course(floats([[0.0, 0.0, 0.0], [vx / speed, vy / speed, 1.0]]), ONWARD, speed)
