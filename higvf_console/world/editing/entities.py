"""The entities in the arena: how many there are, where they stand, and the numbers that describe each.

robot     x, y; heading of a unicycle
fire      x, y, radius, growth, needs (robots)
circle    x, y, radius
bar       x, y of its middle, length of its spine, half width, angle
polygon   x, y of its middle, size (its farthest corner), angle (that of its first corner)
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.edits import EntityKind
from higvf_console.core.quantity import Quantity
from higvf_console.core.state import Motion
from higvf_console.sim.unicycle import body_centres
from higvf_console.world.layout import Layout
from higvf_console.world.polygons import obstacles_of, segment_distance, signed_distance

_PLACE = {
    "x": Quantity("m", -1e6, 1e6, "", "Where its middle is, to the right."),
    "y": Quantity("m", -1e6, 1e6, "", "Where its middle is, upwards."),
}
_ANGLE = Quantity("deg", -360.0, 360.0, "", "Counter-clockwise from the x axis.")
_LENGTH = Quantity("m", 0.1, 1e5, "", "A length.")

# Names of the numbers of each kind of entity, and what they mean.
NUMBERS: dict[EntityKind, dict[str, Quantity]] = {
    EntityKind.ROBOT: {**_PLACE, "heading": _ANGLE},
    EntityKind.FIRE: {
        **_PLACE,
        "radius": _LENGTH,
        "growth": Quantity("m/s", 0.0, 100.0, "", "How fast its radius grows."),
        "needs": Quantity("", 1.0, 1e5, "", "Robots that it takes to put it out."),
    },
    EntityKind.CIRCLE: {**_PLACE, "radius": _LENGTH},
    EntityKind.BAR: {**_PLACE, "length": _LENGTH, "half width": _LENGTH, "angle": _ANGLE},
    EntityKind.POLYGON: {**_PLACE, "size": _LENGTH, "angle": _ANGLE},
}


class EntityRef(NamedTuple):
    """An entity: its kind, and its row (from 0) among those of its kind."""

    kind: EntityKind
    row: int


def name_of(entity: EntityRef) -> str:
    """What people call it; numbers count from 1."""
    return f"{entity.kind.value} {entity.row + 1}"


def how_many(kind: EntityKind, layout: Layout) -> int:
    """Entities of a kind."""
    match kind:
        case EntityKind.ROBOT:
            return len(layout.formation)
        case EntityKind.FIRE:
            return len(layout.fires)
        case EntityKind.CIRCLE:
            return len(layout.obstacles.circles)
        case EntityKind.BAR:
            return len(layout.obstacles.bars)
        case EntityKind.POLYGON:
            return len(obstacles_of(layout.obstacles.polygons))


def exists(entity: EntityRef, layout: Layout) -> bool:
    """Whether there still is such an entity."""
    return entity.row < how_many(entity.kind, layout)


def numbers_of(entity: EntityRef, layout: Layout, motion: Motion) -> dict[str, float]:
    """The numbers that describe an entity now, by the names in `NUMBERS`."""
    row, obstacles = entity.row, layout.obstacles
    match entity.kind:
        case EntityKind.ROBOT:
            x, y = centres(layout, motion)[row].tolist()
            return {"x": x, "y": y, "heading": math.degrees(math.remainder(motion.heading[row], 2.0 * math.pi))}
        case EntityKind.FIRE:
            fire, radius = layout.fires[row], float(motion.fire_radius[row])
            x, y = fire.position
            return {"x": x, "y": y, "radius": radius, "growth": fire.growth, "needs": float(fire.needs)}
        case EntityKind.CIRCLE:
            x, y, radius = obstacles.circles[row].tolist()
            return {"x": x, "y": y, "radius": radius}
        case EntityKind.BAR:
            ax, ay, bx, by, half_width = obstacles.bars[row].tolist()
            angle = math.degrees(math.atan2(by - ay, bx - ax))
            middle = {"x": (ax + bx) / 2, "y": (ay + by) / 2}
            return {**middle, "length": math.hypot(bx - ax, by - ay), "half width": half_width, "angle": angle}
        case EntityKind.POLYGON:
            chain = obstacles_of(obstacles.polygons)[row][0]
            x, y = chain.mean(axis=0).tolist()
            reach = np.hypot(*(chain - (x, y)).T)
            angle = math.degrees(math.atan2(chain[0, 1] - y, chain[0, 0] - x))
            return {"x": x, "y": y, "size": float(reach.max()), "angle": angle}


def centres(layout: Layout, motion: Motion) -> Floats:
    """(N, 2) centres of the robots' bodies [m]."""
    return body_centres(motion.position, motion.heading, layout.params.robots.look_ahead)


def entity_at(point: Floats, layout: Layout, motion: Motion, reach: float) -> EntityRef | None:
    """What lies under a point (2,) or within `reach` [m] of it: robots before fires, fires before obstacles."""
    gaps: list[tuple[EntityKind, Floats]] = [
        (EntityKind.ROBOT, np.hypot(*(centres(layout, motion) - point).T)),
        (EntityKind.FIRE, np.hypot(*(layout.fire_position - point).T) - motion.fire_radius),
        *(
            (kind, obstacle_gaps(kind, layout, point))
            for kind in (EntityKind.CIRCLE, EntityKind.BAR, EntityKind.POLYGON)
        ),
    ]
    for kind, gap in gaps:
        if len(gap) and gap.min() <= reach:
            return EntityRef(kind, int(np.argmin(gap)))
    return None


def obstacle_gaps(kind: EntityKind, layout: Layout, point: Floats) -> Floats:
    """(K,) distance of a point (2,) from the surface of every obstacle of a kind [m], negative inside."""
    obstacles, points = layout.obstacles, floats(point, 1, 2)
    if kind is EntityKind.CIRCLE:
        return np.hypot(*(obstacles.circles[:, :2] - point).T) - obstacles.circles[:, 2]
    if kind is EntityKind.BAR:
        return floats([segment_distance(points, bar[:2], bar[2:4])[0] - bar[4] for bar in obstacles.bars], -1)
    return floats([signed_distance(chains, points)[0] for chains in obstacles_of(obstacles.polygons)], -1)
