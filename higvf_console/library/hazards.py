"""What robots keep clear of, built in Python: circles, capsules, polygons, fires, walls, with velocity and growth.

    hazards = Hazards().circle((300, 200), 20).capsule((900, 230), (900, 400), 6).fire((500, 250), 20)

Each method returns a new `Hazards`; none changes the one that it is called on.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.safety.hazards import COLUMNS, OBSTACLE, WALL
from higvf_console.control.safety.hazards import FIRE as BURNING
from higvf_console.core.arguments import instance, number, positive, whole
from higvf_console.core.arrays import FARTHEST, Floats, floats, given_floats
from higvf_console.core.errors import ArgumentError, ScenarioError
from higvf_console.core.viewport import Arena
from higvf_console.world.build import edge_bars
from higvf_console.world.polygons import closed_outline

Point = tuple[float, float]
CIRCLE, CAPSULE, FIRE = "circle", "capsule", "fire"
_FASTEST = 1000.0  # [m/s] that a hazard may move or grow


class Hazard(NamedTuple):
    """One round hazard: all points within `radius` of the segment from `start` to `end`.

    Attributes:
        kind: "circle", "capsule" or "fire".
        start: one end of the spine [m].
        end: the other end [m]; the same for what is round.
        radius: at the start of a run [m].
        velocity: of both ends [m/s].
        growth: of the radius [m/s].
        robots_needed: of a fire, robots that it takes to extinguish it; 0 = two, or one in a team of one.
    """

    kind: str
    start: Point
    end: Point
    radius: float
    velocity: Point = (0.0, 0.0)
    growth: float = 0.0
    robots_needed: int = 0


@dataclass(frozen=True, eq=False)
class Hazards:
    """What robots keep clear of.

    Attributes:
        items: circles, capsules and fires, in the order in which they were given.
        polygons: irregular obstacles, counter-clockwise chains (n, 2) [m].
        walls: (nx, ny, w) unit inward normal and offset [m]; inside means n.p >= w.
        arena: whose four sides are among the walls; None = of none.
    """

    items: tuple[Hazard, ...] = ()
    polygons: tuple[Floats, ...] = ()
    walls: tuple[tuple[float, float, float], ...] = ()
    arena: Arena | None = None

    def circle(
        self, at: ArrayLike, radius: float, *, velocity: ArrayLike = (0.0, 0.0), growth: float = 0.0
    ) -> "Hazards":
        """With a circle.

        Args:
            at: (2,) centre [m].
            radius: [m], above 0.
            velocity: (2,) of the centre [m/s].
            growth: of the radius [m/s].

        Raises:
            ArgumentError: not of these shapes and ranges.
        """
        centre = _point("at", at)
        return self._with(Hazard(CIRCLE, centre, centre, _radius("radius", radius), *_motion(velocity, growth)))

    def capsule(
        self, start: ArrayLike, end: ArrayLike, half_width: float, *, velocity: ArrayLike = (0.0, 0.0),
        growth: float = 0.0,
    ) -> "Hazards":  # fmt: skip
        """With a capsule (a bar with round ends): all points within `half_width` of a segment.

        Args:
            start: (2,) one end of the segment [m].
            end: (2,) the other end [m].
            half_width: [m], above 0.
            velocity: (2,) of both ends [m/s].
            growth: of the half width [m/s].

        Raises:
            ArgumentError: not of these shapes and ranges.
        """
        ends = _point("start", start), _point("end", end)
        return self._with(Hazard(CAPSULE, *ends, _radius("half_width", half_width), *_motion(velocity, growth)))

    def polygon(self, corners: ArrayLike) -> "Hazards":
        """With an obstacle of any shape that does not cross itself; it stands still.

        Args:
            corners: (n, 2) either way round [m]; the last is joined to the first.

        Raises:
            ArgumentError: fewer than three distinct corners, hardly an area, or edges that cross or touch.
        """
        try:
            outline = closed_outline(given_floats("corners", corners, ("N", 2), most=FARTHEST))
        except ScenarioError as problem:
            raise ArgumentError(f"corners: {problem}") from problem
        return replace(self, polygons=(*self.polygons, outline))

    def fire(self, at: ArrayLike, radius: float, *, growth: float = 1.0, robots_needed: int = 0) -> "Hazards":
        """With a burning fire, which robots extinguish in a run; to the safety filter alone it is a growing circle.

        Args:
            at: (2,) centre [m].
            radius: at the start [m], above 0.
            growth: of the radius [m/s], from 0.
            robots_needed: to extinguish it; 0 = two, or one in a team of one.

        Raises:
            ArgumentError: not of these shapes and ranges.
        """
        centre, needs = _point("at", at), whole("robots_needed", robots_needed, 0)
        rate = number("growth", growth, 0.0, 100.0)
        return self._with(Hazard(FIRE, centre, centre, _radius("radius", radius), (0.0, 0.0), rate, needs))

    def wall(self, normal: ArrayLike, offset: float) -> "Hazards":
        """With a wall; robots stay where n.p >= w.

        Args:
            normal: (2,) inward normal n, of any length.
            offset: w [m], for the unit normal.

        Raises:
            ArgumentError: not of these shapes, or a normal of length 0.
        """
        given = given_floats("normal", normal, (2,), most=FARTHEST)
        length = float(np.hypot(*given))
        if not length > 0.0:
            raise ArgumentError("normal is (0, 0); expected a direction")
        wall = (float(given[0]) / length, float(given[1]) / length, number("offset", offset, -FARTHEST, FARTHEST))
        return replace(self, walls=(*self.walls, wall))

    def inside(self, arena: Arena | ArrayLike) -> "Hazards":
        """With the four sides of a rectangle as walls.

        Args:
            arena: an `Arena`, or (x_min, y_min, x_max, y_max) [m].

        Raises:
            ArgumentError: no such rectangle, or one without an inside.
        """
        sides = given_arena(arena)
        walls = ((1.0, 0.0, sides.x_min), (-1.0, 0.0, -sides.x_max), (0.0, 1.0, sides.y_min), (0.0, -1.0, -sides.y_max))
        return replace(self, walls=(*self.walls, *walls), arena=sides)

    def _with(self, item: Hazard) -> "Hazards":
        return replace(self, items=(*self.items, item))

    @cached_property
    def circles(self) -> Floats:
        """(P, 3) x, y, radius [m] of the circles."""
        return floats([(*i.start, i.radius) for i in self.items if i.kind == CIRCLE], -1, 3)

    @cached_property
    def bars(self) -> Floats:
        """(B, 5) ax, ay, bx, by, half width [m] of the capsules."""
        return floats([(*i.start, *i.end, i.radius) for i in self.items if i.kind == CAPSULE], -1, 5)

    @cached_property
    def table(self) -> Floats:
        """(H, 9) all of them as `control.safety.hazards` defines them: obstacles, edges of polygons, walls, fires."""
        obstacles = [_row(OBSTACLE, item) for item in self.items if item.kind != FIRE]
        edges = [(OBSTACLE, *edge, 0.0, 0.0, 0.0) for edge in edge_bars(self.polygons).tolist()]
        walls = [(WALL, nx, ny, 0.0, 0.0, offset, 0.0, 0.0, 0.0) for nx, ny, offset in self.walls]
        fires = [_row(BURNING, item) for item in self.items if item.kind == FIRE]
        return floats([*obstacles, *edges, *walls, *fires], -1, COLUMNS)


def _row(kind: int, item: Hazard) -> tuple[float, ...]:
    return (kind, *item.start, *item.end, item.radius, *item.velocity, item.growth)


def given_hazards(hazards: object) -> Hazards:
    """`hazards`, or none where it is None.

    Raises:
        ArgumentTypeError: it is neither.
    """
    return Hazards() if hazards is None else instance("hazards", hazards, Hazards)


def given_arena(arena: object) -> Arena:
    """A rectangle of `Arena`'s four numbers.

    Raises:
        ArgumentError: no such rectangle, or one without an inside.
    """
    sides = Arena(*given_floats("arena", arena, (4,), most=FARTHEST).tolist())
    if sides.width <= 0.0 or sides.height <= 0.0:
        raise ArgumentError(
            f"arena is {sides.width:g} m x {sides.height:g} m; expected x_min < x_max and y_min < y_max"
        )
    return sides


def _point(name: str, value: object) -> Point:
    return cast(Point, tuple(given_floats(name, value, (2,), most=FARTHEST).tolist()))


def _radius(name: str, value: object) -> float:
    return positive(name, value, FARTHEST)


def _motion(velocity: object, growth: object) -> tuple[Point, float]:
    moving = cast(Point, tuple(given_floats("velocity", velocity, (2,), most=_FASTEST).tolist()))
    return moving, number("growth", growth, -_FASTEST, _FASTEST)
