"""The sections of a scenario file, each read into the part of a run that it describes."""

import math
from collections.abc import Sequence
from enum import StrEnum
from itertools import chain
from pathlib import Path as FilePath
from typing import Any, NamedTuple

import numpy as np

from higvf_console.control.forms import FORMS, WORDS, Forms
from higvf_console.control.parameters import GROUPS, RENAMED, Parameters, defaults_at
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.quantity import COORDINATE, Quantity, quantities, with_values
from higvf_console.core.reading.node import Node
from higvf_console.core.scale import USUAL_SCALE, Scale
from higvf_console.core.viewport import Arena
from higvf_console.scenario.courses import COURSE_KEYS, read_course
from higvf_console.scenario.irregular import check_edges, read_masks, read_polygons
from higvf_console.world.layout import Fire, Links
from higvf_console.world.obstacles import Course, Obstacles

MOST_ROBOTS = 100_000
MOST_OBSTACLES = 20_000  # circles, and bars
MOST_FIRES = 1000
RENAMED_FORMS = {"fire_row": "fire_constraint"}  # of version 0.1, which are still read
SPEED_LIMIT_FACTOR = 1.5  # v_max of a scenario that names only the cruise speed C

LENGTH = Quantity("m", 0.001, 1e6, "", "A length.")
_JITTER = Quantity("m", 0.0, 1000.0, "", "Largest shift of a robot along x and along y.")
_GROWTH = Quantity("m/s", 0.0, 100.0, "", "How fast a fire's radius grows.")
ANGLE = Quantity("deg", -360.0, 360.0, "", "An angle.")
_BODY = Quantity("m", 0.001, 1000.0, "", "Radius of the circle round a robot's body.")
_SPEED_LIMIT = Quantity("m/s", 0.001, 1000.0, "", "Speed limit of a robot.")


class FilterKind(StrEnum):
    """Which safety filter a run uses."""

    DISTRIBUTED = "distributed"
    CENTRALISED = "centralised"


class Robots(NamedTuple):
    """Where the team starts.

    Attributes:
        points: (N, 2) centres [m].
        jitter: by how much each is shifted at most along x and along y, as the seed decides [m].
        heading: (N,) of unicycles [rad].
        scale: their body and speed limit.
    """

    points: Floats
    jitter: float
    heading: Floats
    scale: Scale = USUAL_SCALE

    def positions(self, seed: int) -> Floats:
        """Centres (N, 2) [m] at the start; the same seed gives the same bytes."""
        if self.jitter == 0.0:
            return floats(self.points)
        return self.points + np.random.default_rng(seed).uniform(-self.jitter, self.jitter, self.points.shape)

    def controlled(self, seed: int, look_ahead: float) -> Floats:
        """Controlled points (N, 2) [m] at the start: the centres, or points so far [m] ahead of them."""
        if look_ahead == 0.0:
            return self.positions(seed)
        ahead = [(math.cos(angle), math.sin(angle)) for angle in self.heading.tolist()]
        return floats(self.positions(seed) + look_ahead * np.array(ahead))

    def written(self) -> dict[str, Any]:
        """The section that `read_robots` reads as these robots."""
        section: dict[str, Any] = {"start_m": self.points.tolist()}
        if self.scale != USUAL_SCALE:
            section |= {"radius_m": self.scale.body_radius, "speed_limit_m_per_s": self.scale.speed_limit}
        if self.jitter > 0.0:
            section["jitter_m"] = self.jitter
        degrees = np.degrees(self.heading)
        if degrees.any():
            section["heading_deg"] = float(degrees[0]) if (degrees == degrees[0]).all() else degrees.tolist()
        return section


class ShownStroke(NamedTuple):
    """A stroke that the scenario ships for a "show me" button.

    Attributes:
        name: what the button says.
        robot: index of the robot that is to feel it; None = the influenced one.
        points: (n, 2) [m].
    """

    name: str
    robot: int | None
    points: Floats


def read_arena(node: Node) -> tuple[Arena, bool]:
    """The arena, and whether its sides are walls.

    Raises:
        ScenarioError: `size_m` is given together with the sides, or the arena has no area.
    """
    entries = node.section(("size_m", "x_min", "y_min", "x_max", "y_max", "walls"))
    walls = entries["walls"].flag() if "walls" in entries else True
    if "size_m" in entries:
        if len(entries) > 1 + ("walls" in entries):
            raise node.error("give size_m, or x_min, y_min, x_max and y_max, not both")
        width, height = entries["size_m"].point()
        arena = Arena(0.0, 0.0, width, height)
    else:
        entries = node.section(tuple(entries), ("x_min", "y_min", "x_max", "y_max"))
        arena = Arena(*(entries[name].number(COORDINATE) for name in Arena._fields))
    if arena.width <= 0.0 or arena.height <= 0.0:
        raise node.error(f"an arena of {arena.width:g} m x {arena.height:g} m has no area")
    return arena, walls


def read_robots(node: Node, arena: Arena) -> Robots:
    """Given start points, or a square grid round a centre; one heading for all unicycles, or one for each.

    The body and the speed limit set the scale; without them it is the usual one.

    Raises:
        ScenarioError: points are given together with a grid, or headings or the scale do not fit the team.
    """
    body = ("radius_m", "speed_limit_m_per_s")
    entries = node.section(("start_m", "count", "spacing_m", "centre_m", "jitter_m", "heading_deg", *body))
    scale = _scale(node, entries)
    jitter = entries["jitter_m"].number(_JITTER) if "jitter_m" in entries else 0.0
    if "start_m" in entries:
        if {"count", "spacing_m", "centre_m"} & set(entries):
            raise node.error("give start_m, or count and spacing_m, not both")
        points = entries["start_m"].points(least=1)
        return Robots(points, jitter, _headings(entries, len(points)), scale)
    entries = node.section(tuple(entries), ("count", "spacing_m"))
    count = entries["count"].integer(1, MOST_ROBOTS, "a number of robots")
    centre = ((arena.x_min + arena.x_max) / 2, (arena.y_min + arena.y_max) / 2)
    centre = entries["centre_m"].point() if "centre_m" in entries else centre
    grid = _grid(count, entries["spacing_m"].number(LENGTH), centre)
    return Robots(grid, jitter, _headings(entries, count), scale)


def _scale(node: Node, entries: dict[str, Node]) -> Scale:
    radius, speed_limit = entries.get("radius_m"), entries.get("speed_limit_m_per_s")
    if radius is None and speed_limit is None:
        return USUAL_SCALE
    if radius is None or speed_limit is None:
        missing = "speed_limit_m_per_s" if speed_limit is None else "radius_m"
        raise node.error(f"give {missing} too: the defaults follow from radius_m and speed_limit_m_per_s together")
    return Scale(radius.number(_BODY), speed_limit.number(_SPEED_LIMIT))


def _headings(entries: dict[str, Node], robots: int) -> Floats:
    """Headings (N,) [rad]."""
    node = entries.get("heading_deg")
    if node is None:
        return np.zeros(robots)
    if not isinstance(node.value, list):
        return np.full(robots, math.radians(node.number(ANGLE)))
    given = [math.radians(item.number(ANGLE)) for item in node.items()]
    if len(given) != robots:
        raise node.error(f"{len(given)} headings for {robots} robots; give one for all robots, or one for each")
    return floats(given)


def _grid(count: int, spacing: float, centre: tuple[float, float]) -> Floats:
    columns = math.ceil(math.sqrt(count))
    rows = math.ceil(count / columns)
    index = np.arange(count)
    cells = np.stack([index % columns - (columns - 1) / 2, index // columns - (rows - 1) / 2], axis=1)
    return floats(cells * spacing + np.array(centre))


def read_links(node: Node, robots: int) -> Links:
    """Communication links as pairs of robot indices, each once, the smaller index first.

    Raises:
        ScenarioError: a link is no pair of different robots of the team.
    """
    links: set[tuple[int, int]] = set()
    for item in node.items():
        ends = [end.integer(1, robots, "a robot's number") - 1 for end in item.items()]
        if len(ends) != 2 or ends[0] == ends[1]:
            raise item.wrong("a link between two robots, such as [1, 2]")
        links.add((min(ends), max(ends)))
    return tuple(sorted(links))


def read_formation(node: Node, robots: int) -> Floats:
    """A shape (N, 2) [m] whose pairwise distances the team keeps.

    Raises:
        ScenarioError: there is not one point for each robot.
    """
    shape = node.points()
    if len(shape) != robots:
        raise node.error(f"{len(shape)} points for {robots} robots; give one for each")
    return shape


def read_fires(node: Node, robots: int, scale: Scale) -> tuple[Fire, ...]:
    """The fires, in the order of their numbers; the usual growth is that of the scale.

    Raises:
        ScenarioError: a fire without place or radius, out of range, or that needs more robots than there are.
    """
    fires: list[Fire] = []
    for item in node.items(MOST_FIRES):
        entries = item.section(("at_m", "radius_m", "growth_m_per_s", "robots_needed"), ("at_m", "radius_m"))
        growth = entries["growth_m_per_s"].number(_GROWTH) if "growth_m_per_s" in entries else scale.speed
        needs = min(2, robots)
        if "robots_needed" in entries:
            needs = entries["robots_needed"].integer(1, robots, f"within the team of {robots}")
        fires.append(Fire(entries["at_m"].point(), entries["radius_m"].number(LENGTH), growth, needs))
    return tuple(fires)


def read_obstacles(node: Node, folders: Sequence[FilePath], polygons: tuple[Floats, ...] | None = None) -> Obstacles:
    """Circles, bars, polygons and masks.

    Args:
        node: the section `obstacles`.
        folders: where the images of masks are looked for.
        polygons: what its polygons and masks came to when they were read before; None = read them.

    Raises:
        ScenarioError: an obstacle is out of range, a course leads nowhere, or polygons have too many edges.
    """
    entries = node.section(("circles", "bars", "capsules", "polygons", "masks"))
    circles: list[tuple[float, ...]] = []
    circle_courses: list[Course | None] = []
    for item in entries["circles"].items(MOST_OBSTACLES) if "circles" in entries else ():
        part = item.section(("at_m", "radius_m", *COURSE_KEYS), ("at_m", "radius_m"))
        x, y = part["at_m"].point()
        circles.append((x, y, part["radius_m"].number(LENGTH)))
        circle_courses.append(read_course(item, part, (x, y)))
    bars: list[tuple[float, ...]] = []
    bar_courses: list[Course | None] = []
    for item in chain.from_iterable(
        entries[key].items(MOST_OBSTACLES) for key in ("bars", "capsules") if key in entries
    ):
        part = item.section(("from_m", "to_m", "half_width_m", *COURSE_KEYS), ("from_m", "to_m", "half_width_m"))
        (ax, ay), (bx, by) = part["from_m"].point(), part["to_m"].point()
        bars.append((ax, ay, bx, by, part["half_width_m"].number(LENGTH)))
        bar_courses.append(read_course(item, part, ((ax + bx) / 2, (ay + by) / 2)))
    if polygons is None:
        polygons = read_polygons(entries["polygons"]) if "polygons" in entries else ()
        polygons += read_masks(entries["masks"], folders) if "masks" in entries else ()
        check_edges(node, polygons)
    return Obstacles(
        circles=floats(circles, -1, 3),
        bars=floats(bars, -1, 5),
        polygons=polygons,
        circle_courses=tuple(circle_courses),
        bar_courses=tuple(bar_courses),
    )


def read_strokes(node: Node, robots: int) -> tuple[ShownStroke, ...]:
    """The "show me" strokes.

    Raises:
        ScenarioError: a stroke without a name or with fewer than three points, or for no robot of the team.
    """
    strokes: list[ShownStroke] = []
    for item in node.items():
        entries = item.section(("name", "robot", "points_m"), ("name", "points_m"))
        robot = entries["robot"].integer(1, robots, "a robot's number") - 1 if "robot" in entries else None
        strokes.append(ShownStroke(entries["name"].text(), robot, entries["points_m"].points(least=3)))
    return tuple(strokes)


def read_parameters(node: Node, scale: Scale) -> Parameters:
    """All parameters: the defaults at the scale and what the file says otherwise.

    Raises:
        ScenarioError: a parameter is unknown or out of range, or the boundaries are in the wrong order.
    """
    params, given = defaults_at(scale), dict[str, dict[str, Node]]()
    for group, section in node.section(GROUPS, renamed=RENAMED).items():
        part, former = getattr(params, group), f"{group}."
        renamed = {old.removeprefix(former): new.removeprefix(former) for old, new in RENAMED.items()}
        given[group] = section.section(tuple(quantities(type(part))), renamed=renamed)  # pyright: ignore[reportUnknownArgumentType]
        values = {name: entry.value for name, entry in given[group].items()}
        params = params._replace(**{group: with_values(part, values, section.where, scale)})
    if "cruise_speed" in given.get("blending", ()) and "speed_limit" not in given.get("safety", ()):
        limit = SPEED_LIMIT_FACTOR * params.blending.cruise_speed
        params = params._replace(safety=params.safety._replace(speed_limit=limit))
    reactive, repulsive = params.boundaries.reactive_margin, params.boundaries.repulsive_margin
    if reactive <= repulsive:
        raise node.entry("boundaries", None).error(
            f"reactive_margin is {reactive:g} m and must be above repulsive_margin, {repulsive:g} m"
        )
    return params


def read_forms(node: Node) -> Forms:
    """The forms of the equations: the name of a set, or a section with a word for each equation.

    Raises:
        ScenarioError: an equation or a form is unknown.
    """
    if isinstance(node.value, str):
        return FORMS[node.choice(tuple(FORMS))]
    entries = node.section(Forms._fields, renamed=RENAMED_FORMS)
    return Forms(**{name: WORDS[entry.choice(tuple(WORDS))] for name, entry in entries.items()})
