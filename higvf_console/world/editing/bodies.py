"""Edits of fires and obstacles: where they may go and how large they may be, with robots standing around."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from higvf_console.control.parameters import controlled
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.edits import EntityKind
from higvf_console.core.errors import ScenarioError
from higvf_console.core.numbers import metres
from higvf_console.core.state import Motion
from higvf_console.world.editing.entities import EntityRef, how_many, name_of, numbers_of
from higvf_console.world.editing.safe_places import body_fits, diagonal, held_words, nearest_fit
from higvf_console.world.layout import Fire, Layout, Links
from higvf_console.world.neighbour_search import kd_tree
from higvf_console.world.obstacles import Course, Courses, Obstacles
from higvf_console.world.polygons import (
    MOST_EDGES,
    closed_outline,
    crossing,
    obstacles_of,
    segment_distance,
    signed_distance,
)

CIRCLE_RADIUS = 25.0  # of a new circle at the usual scale [m]
BAR_LENGTH, BAR_HALF_WIDTH = 120.0, 6.0  # of a new bar, likewise
Gap = Callable[[Floats], Floats]


def fire_place(layout: Layout, motion: Motion, point: Floats, radius: float) -> tuple[Floats, str]:
    """Where a fire goes that is wanted at a point (2,), and what to say if that is somewhere else."""
    return _held_place(layout, motion, point, _disc(point, radius), radius, "the fire")


def fire_changed(
    layout: Layout, motion: Motion, entity: EntityRef, name: str, value: float, text: str
) -> tuple[Layout, str]:
    """The layout after a fire's growth or need has changed; its radius is the motion's, and is checked here."""
    row = entity.row
    if name == "growth":
        return with_fire(layout, row, layout.fires[row]._replace(growth=value)), text
    if name == "needs":
        robots = len(layout.formation)
        if value != round(value) or value > robots:
            raise ScenarioError(
                f"needs of {name_of(entity)}: {value:g} is not a whole number within the team of {robots}"
            )
        return with_fire(layout, row, layout.fires[row]._replace(needs=round(value))), text
    _check_room(layout, motion, _disc(layout.fire_position[row], value), name_of(entity))
    return layout, text


def with_fire(layout: Layout, row: int, fire: Fire) -> Layout:
    """The layout with another fire in that row."""
    return layout._replace(fires=(*layout.fires[:row], fire, *layout.fires[row + 1 :]))


def fire_sized(row: int, radius: float) -> Callable[[Motion], Motion]:
    """Gives a fire its radius [m]."""

    def finish(motion: Motion) -> Motion:
        sizes = motion.fire_radius.copy()
        sizes[row] = radius
        return motion._replace(fire_radius=sizes)

    return finish


def with_body(layout: Layout, motion: Motion, kind: EntityKind, point: Floats) -> tuple[Layout, str]:
    """The layout with a new circle or level bar of ordinary size at a point (2,), or as near as is safe."""
    (x, y), scale = point.tolist(), layout.params.scale.length
    if kind is EntityKind.CIRCLE:
        body = floats([[x, y, CIRCLE_RADIUS * scale]])
        grown = _with(layout, circles=np.vstack([layout.obstacles.circles, body]))
    elif kind is EntityKind.BAR:
        half_length = scale * BAR_LENGTH / 2
        body = floats([[x - half_length, y, x + half_length, y, scale * BAR_HALF_WIDTH]])
        grown = _with(layout, bars=np.vstack([layout.obstacles.bars, body]))
    else:
        raise ScenarioError("a polygon needs an outline: draw one")
    entity = EntityRef(kind, how_many(kind, layout))
    return _put(grown, motion, entity, point, f"{name_of(entity).capitalize()} is added")


def with_outlines(layout: Layout, motion: Motion, outlines: Sequence[Floats]) -> tuple[Layout, str]:
    """The layout with new obstacles of any shape.

    Raises:
        ScenarioError: an outline cannot be one, crosses something, or leaves a robot without its clearance.
    """
    chains = tuple(closed_outline(outline) for outline in outlines)
    if not chains:
        raise ScenarioError("there is no outline to make an obstacle of")
    for chain in chains:
        _check_room(layout, motion, lambda points, chain=chain: signed_distance((chain,), points), "the obstacle")
    first = how_many(EntityKind.POLYGON, layout) + 1
    names = f"Polygon {first} is" if len(chains) == 1 else f"Polygons {first} to {first + len(chains) - 1} are"
    return _checked(_with(layout, polygons=layout.obstacles.polygons + chains), layout), f"{names} added."


def moved(layout: Layout, motion: Motion, entity: EntityRef, point: Floats) -> tuple[Layout, str]:
    """The layout with an obstacle's middle at a point (2,), or as near as is safe."""
    return _put(layout, motion, entity, point, f"{name_of(entity).capitalize()} is moved")


def reshaped(layout: Layout, motion: Motion, entity: EntityRef, numbers: dict[str, float]) -> Layout:
    """The layout with an obstacle that has these numbers.

    Raises:
        ScenarioError: a robot would be too near to it.
    """
    was = numbers_of(entity, layout, motion)
    new = _checked(shaped(layout, entity, numbers, was), layout)
    if numbers.get("speed") != was.get("speed"):
        new = _paced(new, entity, numbers["speed"], motion.tick * layout.params.safety.control_period)
    _check_room(new, motion, _gap(new, motion, entity), name_of(entity))
    return new


def without(layout: Layout, entity: EntityRef) -> Layout:
    """The layout without an obstacle."""
    obstacles = layout.obstacles
    match entity.kind:
        case EntityKind.CIRCLE:
            courses = _dropped(obstacles.circle_courses, entity.row)
            circles = floats(np.delete(obstacles.circles, entity.row, axis=0))
            return _with(layout, circles=circles, circle_courses=courses)
        case EntityKind.BAR:
            courses = _dropped(obstacles.bar_courses, entity.row)
            return _with(layout, bars=floats(np.delete(obstacles.bars, entity.row, axis=0)), bar_courses=courses)
        case _:
            shapes = obstacles_of(obstacles.polygons)
            return _with(layout, polygons=tuple(chain for shape in _others(shapes, entity.row) for chain in shape))


def links_now(layout: Layout, motion: Motion) -> Links:
    """The communication links in force, as index pairs i < j."""
    if layout.links is not None:
        return layout.links
    reach = min(layout.params.formation.communication_range, 1e9)
    pairs = kd_tree(motion.position).query_pairs(reach, output_type="ndarray")
    return tuple((int(i), int(j)) for i, j in np.sort(pairs, axis=1))


def _dropped(courses: Courses, row: int) -> Courses:
    return courses[:row] + courses[row + 1 :]


def _paced(layout: Layout, entity: EntityRef, speed: float, time: float) -> Layout:
    """The layout with a moving obstacle at another speed [m/s], where it is at a time [s]."""
    kind = "circle_courses" if entity.kind is EntityKind.CIRCLE else "bar_courses"
    courses: list[Course | None] = list(getattr(layout.obstacles, kind))
    course = courses[entity.row]
    assert course is not None
    courses[entity.row] = course.paced(speed, time)
    return _with(layout, **{kind: tuple(courses)})


def _others(shapes: list[tuple[Floats, ...]], row: int) -> list[tuple[Floats, ...]]:
    return shapes[:row] + shapes[row + 1 :]


def _with(layout: Layout, **parts: object) -> Layout:
    obstacles: Obstacles = layout.obstacles._replace(**parts)  # pyright: ignore[reportArgumentType]
    return layout._replace(obstacles=obstacles)


def _put(layout: Layout, motion: Motion, entity: EntityRef, point: Floats, what: str) -> tuple[Layout, str]:
    was = numbers_of(entity, layout, motion)
    middle = floats([was["x"], was["y"]])
    gap = _gap(layout, motion, entity)
    at, held = _held_place(
        layout, motion, point, lambda points: gap(points - point + middle), _extent(entity, was), name_of(entity)
    )
    numbers = {**was, "x": float(at[0]), "y": float(at[1])}
    return _checked(shaped(layout, entity, numbers, was), layout), f"{what}{held}."


def shaped(layout: Layout, entity: EntityRef, new: dict[str, float], was: dict[str, float]) -> Layout:
    """The layout with an obstacle that has other numbers, whatever it then touches; a course moves along with it.

    Args:
        layout: with the obstacle.
        entity: the obstacle.
        new: its numbers from now on.
        was: its numbers now, see `entities.numbers_of`.
    """
    row, obstacles = entity.row, layout.obstacles
    middle = floats([new["x"], new["y"]])
    if entity.kind is EntityKind.CIRCLE:
        circles = obstacles.circles.copy()
        travelled = (was["x"], was["y"]) - circles[row, :2]
        circles[row] = (*(middle - travelled), new["radius"])
        return _with(layout, circles=circles)
    angle = math.radians(new["angle"])
    if entity.kind is EntityKind.BAR:
        bars = obstacles.bars.copy()
        spine = 0.5 * new["length"] * np.array([math.cos(angle), math.sin(angle)])
        middle -= (was["x"], was["y"]) - (bars[row, :2] + bars[row, 2:4]) / 2  # that it has travelled
        bars[row] = (*(middle - spine), *(middle + spine), new["half width"])
        return _with(layout, bars=bars)
    turn, scale = angle - math.radians(was["angle"]), new["size"] / was["size"]
    rotation = scale * np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    shapes = obstacles_of(obstacles.polygons)
    shapes[row] = tuple(floats((chain - (was["x"], was["y"])) @ rotation + middle) for chain in shapes[row])
    return _with(layout, polygons=tuple(chain for shape in shapes for chain in shape))


def _checked(layout: Layout, before: Layout) -> Layout:
    """The layout, if its polygons can be.

    Raises:
        ScenarioError: two of them cross or touch, and none did before; or they have too many edges.
    """
    chains, old = layout.obstacles.polygons, before.obstacles.polygons
    if chains is old:
        return layout
    edges = sum(len(chain) for chain in chains)
    if edges > MOST_EDGES:
        raise ScenarioError(f"the polygons would have {edges} edges; at most {MOST_EDGES} are possible")
    if crossing(chains) is not None and (not old or crossing(old) is None):
        raise ScenarioError("the polygon would cross or touch itself or another one")
    return layout


def _gap(layout: Layout, motion: Motion, entity: EntityRef) -> Gap:
    """Distance of points from the surface of an obstacle."""
    obstacles, row = layout.obstacles_at(motion.tick), entity.row
    match entity.kind:
        case EntityKind.CIRCLE:
            x, y, radius = obstacles.circles[row].tolist()
            return _disc(floats([x, y]), radius)
        case EntityKind.BAR:
            bar = obstacles.bars[row]
            return lambda points: segment_distance(points, bar[:2], bar[2:4]) - bar[4]
        case _:
            chains = obstacles_of(obstacles.polygons)[row]
            return lambda points: signed_distance(chains, points)


def _disc(middle: Floats, radius: float) -> Gap:
    return lambda points: np.hypot(points[:, 0] - middle[0], points[:, 1] - middle[1]) - radius


def _extent(entity: EntityRef, numbers: dict[str, float]) -> float:
    """How far the surface of an obstacle is from its middle at most [m]."""
    match entity.kind:
        case EntityKind.CIRCLE:
            return numbers["radius"]
        case EntityKind.BAR:
            return 0.5 * numbers["length"] + numbers["half width"]
        case _:
            return numbers["size"]


def _held_place(
    layout: Layout, motion: Motion, point: Floats, gap: Gap, extent: float, what: str
) -> tuple[Floats, str]:
    place = nearest_fit(point, body_fits(point, gap, extent, layout, motion), diagonal(layout))
    if place is None:
        raise ScenarioError(f"{what} fits nowhere without violating a robot's clearance")
    return place, held_words(place, point)


def _check_room(layout: Layout, motion: Motion, gap: Gap, what: str) -> None:
    least = controlled(layout.params).safety.obstacle_clearance
    room = gap(motion.position)
    robot = int(np.argmin(room))
    if room[robot] < 0.0:
        raise ScenarioError(f"robot {robot + 1} would be inside {what}; {least:g} m is the least clearance")
    if room[robot] < least:
        raise ScenarioError(
            f"{what} would be too near to robot {robot + 1}: {metres(room[robot])} from it, {least:g} m is the least"
        )
