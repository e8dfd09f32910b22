"""Seeded random scenes for the study of deadlocks: a team, obstacles of all kinds, growing fires, a sketched path.

Every scene has a free way: the gaps between obstacles, and to the walls, are at least `GAPS[kind]` for the whole
`TIME_LIMIT`, because each fire counts with its radius at that time. The end of the path is free and lies outside the
convex hull of every obstacle. The same seed gives the same scene, bit for bit.
"""

import math
from collections.abc import Callable
from enum import StrEnum
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from higvf_console.control.parameters import SafetyParameters
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.scale import BODY_RADIUS, SPEED_LIMIT, USUAL_SCALE, Scale
from higvf_console.core.viewport import Arena
from higvf_console.lab.bench.geometry import Shape, capsule, clear_of, disc, distances, hull, polygon

TIME_LIMIT = 180.0  # [s]
END_CLEARANCE = 40.0  # from the path's end to any surface, and to the walls [m]
START_CLEARANCE = SafetyParameters().obstacle_clearance + 8.0  # from each robot to any surface [m]
SPACING = (40.05, 55.0)  # range of the spacing of the team [m]
_GROWTH = 1.1  # factor by which the arena grows
_TRIES = 400  # attempts to place one object before the arena grows
_LEAST_TRAVEL = 500.0  # from the team to the end of its path [m]
_SAMPLES = 60  # points of a stroke


class Kind(StrEnum):
    """The kind of difficulty of a scene."""

    SPACED = "spaced"
    CROWDED = "crowded"
    POCKETS = "pockets"


GAPS = {Kind.SPACED: 45.0, Kind.CROWDED: 28.0, Kind.POCKETS: 45.0}  # minimum gap between two obstacles [m]
_ARENA = {Kind.SPACED: (1200.0, 700.0), Kind.CROWDED: (1000.0, 600.0)}  # [m]; it grows until everything fits


class Scene(NamedTuple):
    """One scene: N robots, P circles, Q bars, M fires. All lengths are multiples of 1 cm at the usual scale.

    Attributes:
        kind: kind of difficulty.
        seed: seed of the random numbers.
        arena: arena with walls on its four sides.
        robots: (N, 2) start positions, the formation that they keep [m].
        influenced: index of the robot that follows the path.
        circles: (P, 3) x, y, radius [m].
        bars: (Q, 5) ax, ay, bx, by, half width [m].
        polygons: corners (n, 2) of each [m].
        fires: (M, 4) x, y, radius at the start [m], growth [m/s].
        stroke: (n, 2) the operator's stroke [m].
        scale: of the robots.
    """

    kind: Kind
    seed: int
    arena: Arena
    robots: Floats
    influenced: int
    circles: Floats
    bars: Floats
    polygons: tuple[Floats, ...]
    fires: Floats
    stroke: Floats
    scale: Scale = USUAL_SCALE


def scaled(scene: Scene, factor: float) -> Scene:
    """The same scene with all lengths and speeds multiplied, those of the robots included."""
    return scene._replace(
        arena=Arena(*(factor * side for side in scene.arena)),
        robots=factor * scene.robots,
        circles=factor * scene.circles,
        bars=factor * scene.bars,
        polygons=tuple(factor * corners for corners in scene.polygons),
        fires=factor * scene.fires,
        stroke=factor * scene.stroke,
        scale=Scale(factor * BODY_RADIUS, factor * SPEED_LIMIT),
    )


_Sampler = Callable[[np.random.Generator, Arena], Floats]


class Obstacles(NamedTuple):
    """The objects placed so far; arrays as in `Scene`, and all shapes, with fires at their final radius."""

    circles: list[Floats]
    bars: list[Floats]
    polygons: list[Floats]
    fires: list[Floats]
    shapes: list[Shape]


def open_scene(kind: Kind, seed: int) -> Scene:
    """A scene of 5 to 25 scattered obstacles: `Kind.SPACED` or `Kind.CROWDED`."""
    rng = np.random.default_rng([list(Kind).index(kind), seed])
    count, fires = int(rng.integers(5, 26)), int(rng.integers(1, 5))
    robots = compact_team(rng, int(rng.integers(3, 11)))
    influenced = int(rng.integers(len(robots)))
    scale = 1.0
    while True:
        arena = Arena(0.0, 0.0, *(round(side * scale) for side in _ARENA[kind]))
        placed = centimetres(robots + free_point(rng, arena, float(np.hypot(*robots.T).max()) + END_CLEARANCE))
        found = Obstacles([], [], [], [], [])
        if place_all(rng, arena, found, placed, GAPS[kind], fires, count):
            stroke = _crossing_stroke(rng, arena, found, placed[influenced])
            if stroke is not None:
                return packed_scene(kind, seed, arena, placed, influenced, found, stroke)
        scale *= _GROWTH


def packed_scene(
    kind: Kind, seed: int, arena: Arena, robots: Floats, influenced: int, found: Obstacles, stroke: Floats
) -> Scene:
    """Packs the placed objects into a scene."""
    return Scene(
        kind=kind,
        seed=seed,
        arena=arena,
        robots=robots,
        influenced=influenced,
        circles=floats(found.circles, -1, 3),
        bars=floats(found.bars, -1, 5),
        polygons=tuple(found.polygons),
        fires=floats(found.fires, -1, 4),
        stroke=stroke,
    )


def compact_team(rng: np.random.Generator, count: int, columns: int | None = None) -> Floats:
    """A grid of robots (N, 2) about the origin [m], rotated at random unless `columns` is given."""
    turn = rng.uniform(0.0, 2.0 * math.pi) if columns is None else 0.0
    columns = columns or math.ceil(math.sqrt(count))
    row, column = np.divmod(np.arange(count), columns)
    grid = np.stack([row, column], axis=1) * rng.uniform(*SPACING)
    return rotated(grid - (grid.min(axis=0) + grid.max(axis=0)) / 2.0, turn)


def place_all(
    rng: np.random.Generator, arena: Arena, found: Obstacles, robots: Floats, least: float, fires: int, count: int
) -> bool:
    """Places fires and obstacles at random, with all four kinds among the first four; False if one does not fit.

    Args:
        rng: source of the random numbers.
        arena: arena to place them in.
        found: receives the placed objects.
        robots: (N, 2) start positions to keep clear of [m].
        least: minimum gap between any two and to the walls [m].
        fires: number of fires.
        count: number of obstacles.
    """
    kinds = [*rng.permutation(len(_SAMPLERS)), *rng.integers(len(_SAMPLERS), size=max(count - len(_SAMPLERS), 0))]
    samplers = [_fire] * fires + [_SAMPLERS[kind] for kind in kinds[:count]]
    return all(_placed(rng, arena, found, robots, least, sampler) for sampler in samplers)


def wavy_stroke(rng: np.random.Generator, start: Floats, end: Floats, waypoints: int, sway: float) -> Floats:
    """A smooth stroke (n, 2) [m] through waypoints with a lateral standard deviation of `sway` [m]."""
    share = np.linspace(0.0, 1.0, waypoints)
    share[1:-1] += rng.uniform(-0.3, 0.3, waypoints - 2) / (waypoints - 1)
    off = np.concatenate([[0.0], rng.normal(0.0, sway, waypoints - 2), [0.0]])
    ahead = end - start
    across = np.array([-ahead[1], ahead[0]]) / np.hypot(*ahead)
    through = start + share[:, None] * ahead + off[:, None] * across
    return centimetres(CubicSpline(share, through)(np.linspace(0.0, 1.0, _SAMPLES)))


def finely(stroke: Floats) -> Floats:
    """The stroke (n, 2) with 5 points per segment, so that no thin wall lies between two points."""
    return np.concatenate([np.linspace(a, b, 5) for a, b in pairwise(stroke)])


def surface_distance(points: Floats, shapes: list[Shape]) -> Floats:
    """Distances (n,) of points (n, 2) to the nearest surface [m], negative inside; inf without shapes."""
    return np.min([np.full(len(points), np.inf), *(distances(points, shape) for shape in shapes)], axis=0)


def free_point(rng: np.random.Generator, arena: Arena, margin: float) -> Floats:
    """A random point (2,) of the arena at least `margin` [m] from its edges."""
    return rng.uniform([arena.x_min + margin, arena.y_min + margin], [arena.x_max - margin, arena.y_max - margin])


def rotated(points: Floats, angle: float) -> Floats:
    """Points (n, 2) rotated about the origin by `angle` [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)
    return points @ np.array([[cos, sin], [-sin, cos]])


def centimetres(values: Floats) -> Floats:
    """Rounds lengths to 1 cm, so that a scenario file represents them exactly."""
    return floats(np.round(values, 2))


def _crossing_stroke(rng: np.random.Generator, arena: Arena, found: Obstacles, start: Floats) -> Floats | None:
    """A smooth stroke (n, 2) [m] of 3 to 6 waypoints from `start` to a free end that crosses a static obstacle."""
    hulls = [hull(shape) for shape in found.shapes]
    still = [final_shape(item) for item in (*found.circles, *found.bars, *found.polygons)]
    least, most = START_CLEARANCE + np.array(arena[:2]), np.array(arena[2:]) - START_CLEARANCE
    for _ in range(_TRIES):
        end = free_point(rng, arena, END_CLEARANCE)
        if np.hypot(*(end - start)) < _LEAST_TRAVEL or surface_distance(end[None], hulls).min() < END_CLEARANCE:
            continue
        stroke = wavy_stroke(rng, start, end, int(rng.integers(3, 7)), 120.0)
        if (stroke >= least).all() and (stroke <= most).all() and surface_distance(finely(stroke), still).min() < 0.0:
            return stroke
    return None


def _placed(
    rng: np.random.Generator, arena: Arena, found: Obstacles, robots: Floats, least: float, sampler: _Sampler
) -> bool:
    """Places one object at random until it is clear of all others; False after `_TRIES` attempts."""
    for _ in range(_TRIES):
        item = centimetres(sampler(rng, arena))
        shape = final_shape(item)
        ends = shape.edges.reshape(-1, 2)
        inside = (ends - arena[:2] >= shape.radius + least).all() and (arena[2:] - ends >= shape.radius + least).all()
        if inside and distances(robots, shape).min() >= START_CLEARANCE and clear_of(shape, found.shapes, least):
            _list_for(item, found).append(item)
            found.shapes.append(shape)
            return True
    return False


def final_shape(item: Floats) -> Shape:
    """The shape of a circle (3,), a fire (4,) at `TIME_LIMIT`, a bar (5,) or a polygon (n, 2)."""
    if item.ndim == 2:
        return polygon(item)
    if len(item) == 4:
        return disc(item[0], item[1], item[2] + TIME_LIMIT * item[3])
    return disc(*item) if len(item) == 3 else capsule(*item)


def _list_for(item: Floats, found: Obstacles) -> list[Floats]:
    if item.ndim == 2:
        return found.polygons
    return {3: found.circles, 4: found.fires, 5: found.bars}[len(item)]


def _fire(rng: np.random.Generator, arena: Arena) -> Floats:
    """x, y, radius [m] and growth [m/s] of a fire, whose final radius is 33 to 84 m."""
    return np.array([*free_point(rng, arena, 0.0), rng.uniform(15.0, 30.0), rng.uniform(0.1, 0.3)])


def _circle(rng: np.random.Generator, arena: Arena) -> Floats:
    return np.array([*free_point(rng, arena, 0.0), rng.uniform(10.0, 45.0)])


def _bar(rng: np.random.Generator, arena: Arena) -> Floats:
    half, angle = rng.uniform(40.0, 160.0) / 2.0, rng.uniform(0.0, math.pi)
    centre, along = free_point(rng, arena, 0.0), half * np.array([math.cos(angle), math.sin(angle)])
    return np.array([*(centre - along), *(centre + along), rng.uniform(3.0, 10.0)])


def _convex(rng: np.random.Generator, arena: Arena) -> Floats:
    """A convex polygon of 4 to 8 corners on a circle of radius 15 to 45 m."""
    angle = _bearings(rng, int(rng.integers(4, 9)))
    corners = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return free_point(rng, arena, 0.0) + rng.uniform(15.0, 45.0) * corners


def _star(rng: np.random.Generator, arena: Arena) -> Floats:
    """A star of 3 to 5 arms: outer corners near a circle of radius 15 to 45 m, inner ones at 0.3 to 0.5 of it."""
    arms = int(rng.integers(3, 6))
    angle = _bearings(rng, 2 * arms)
    radius = rng.uniform(0.8, 1.0, 2 * arms)
    radius[1::2] = rng.uniform(0.3, 0.5, arms)
    corners = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return free_point(rng, arena, 0.0) + rng.uniform(15.0, 45.0) * corners


def _bearings(rng: np.random.Generator, count: int) -> Floats:
    """Angles (n,) over the full circle [rad], increasing with random gaps."""
    return (np.arange(count) + rng.uniform(-0.3, 0.3, count)) * 2.0 * math.pi / count + rng.uniform(0.0, 2.0 * math.pi)


_SAMPLERS: tuple[_Sampler, ...] = (_circle, _bar, _convex, _star)
