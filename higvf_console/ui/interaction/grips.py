"""What can be dragged in the arena: entities, their handles, the path, the end of a link; and what comes of letting go.

square    resizes: radius, length, size
disc      turns: angle, heading
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import MovePathPoint, OperatorCommand
from higvf_console.core.edits import ChangeEntity, EntityKind, MoveEntity, ToggleLink
from higvf_console.core.state import NOBODY, Motion
from higvf_console.ui.scene import shapes
from higvf_console.world.editing.bodies import shaped
from higvf_console.world.editing.entities import NUMBERS, EntityRef, centres, entity_at, exists, numbers_of
from higvf_console.world.layout import Layout
from higvf_console.world.polygons import obstacles_of

_BEYOND = 26.0  # from the edge to the disc that turns [px]
_ROBOT = 16.0  # radius of a robot's outline [px]


class Handle(NamedTuple):
    """A point by which an entity is resized or turned.

    Attributes:
        name: the number that it changes, of `NUMBERS`.
        point: (2,) where it is [m].
        turns: whether it is a disc that turns; else a square that resizes.
    """

    name: str
    point: Floats
    turns: bool


class Drag(NamedTuple):
    """Something is held.

    Attributes:
        start: (2,) where it was gripped [m].
        now: (2,) where the hand is [m].
        place: the entity that is held.
        handle: the number that its handle changes; empty = the entity itself moves.
        moves_path: whether it is the path that is held.
        link: the robot that a link is drawn from.
    """

    start: Floats
    now: Floats
    place: EntityRef | None = None
    handle: str = ""
    moves_path: bool = False
    link: int = NOBODY


def handles_of(place: EntityRef, layout: Layout, motion: Motion, px: float) -> list[Handle]:
    """The handles of an entity; `px` is the length of a pixel [m]."""
    numbers = numbers_of(place, layout, motion)
    middle = floats([numbers["x"], numbers["y"]])
    match place.kind:
        case EntityKind.ROBOT:
            ahead = layout.params.robots.look_ahead
            return (
                []
                if ahead == 0.0
                else [Handle("heading", middle + (_ROBOT + _BEYOND) * px * _along(numbers["heading"]), True)]
            )
        case EntityKind.FIRE | EntityKind.CIRCLE:
            return [Handle("radius", middle + floats([numbers["radius"], 0.0]), False)]
        case EntityKind.BAR:
            along = _along(numbers["angle"])
            tip = middle + 0.5 * numbers["length"] * along
            return [Handle("length", tip, False), Handle("angle", tip + _BEYOND * px * along, True)]
        case EntityKind.POLYGON:
            chain = obstacles_of(layout.obstacles.polygons)[place.row][0]
            reach = np.hypot(*(chain - middle).T)
            first = (chain[0] - middle) / max(float(reach[0]), 1e-9)
            turn = Handle("angle", chain[0] + _BEYOND * px * first, True)
            return [Handle("size", chain[int(np.argmax(reach))], False), turn]


def gripped(
    point: Floats, selected: EntityRef | None, layout: Layout, motion: Motion, reach: float, px: float
) -> Drag | None:
    """What a hand at a point (2,) holds: a handle of what is selected, or whatever lies there."""
    if selected is not None and exists(selected, layout):
        numbers = numbers_of(selected, layout, motion)
        near = min(reach, math.dist((numbers["x"], numbers["y"]), point))  # the middle of a small entity moves it
        for handle in handles_of(selected, layout, motion, px):
            if math.dist(handle.point, point) <= near:
                return Drag(point, point, selected, handle.name)
    place = entity_at(point, layout, motion, reach)
    return None if place is None else Drag(point, point, place)


def wished(drag: Drag, layout: Layout, motion: Motion) -> dict[str, float]:
    """The numbers that the held entity would have on release."""
    if drag.place is None:
        return {}
    numbers = numbers_of(drag.place, layout, motion)
    if not drag.handle:
        dx, dy = (drag.now - drag.start).tolist()
        return {**numbers, "x": numbers["x"] + dx, "y": numbers["y"] + dy}
    dx, dy = drag.now[0] - numbers["x"], drag.now[1] - numbers["y"]
    value = math.hypot(dx, dy)
    if drag.handle in ("angle", "heading"):
        value = math.degrees(math.atan2(dy, dx))
    elif drag.handle == "length":
        value = 2.0 * abs(float(np.dot([dx, dy], _along(numbers["angle"]))))
    quantity = NUMBERS[drag.place.kind][drag.handle]
    return {**numbers, drag.handle: min(max(value, quantity.low), quantity.high)}


def result_of(
    drag: Drag, layout: Layout, motion: Motion, *, reach: float = math.inf, waits: bool = False
) -> list[OperatorCommand]:
    """The commands that letting go amounts to.

    Args:
        drag: what is held.
        layout: as it is now.
        motion: likewise.
        reach: how far from a robot a link may end that is meant for it [m].
        waits: whether a bent path waits.
    """
    if drag.moves_path:
        return [MovePathPoint(grip=drag.start, point=drag.now, preview=waits)]
    if drag.link != NOBODY:
        other = robot_near(centres(layout, motion), drag.now, reach)
        return [] if other in (None, drag.link) else [ToggleLink(drag.link, other)]
    if drag.place is None or not exists(drag.place, layout):
        return []
    numbers = wished(drag, layout, motion)
    (kind, row), decimals = drag.place, layout.params.scale.decimals
    if drag.handle:
        return [ChangeEntity(kind, row, drag.handle, round(numbers[drag.handle], decimals))]
    return [MoveEntity(kind, row, floats([round(numbers["x"], decimals), round(numbers["y"], decimals)]))]


def robot_near(position: Floats, point: Floats, reach: float) -> int | None:
    """Index of the robot, among (N, 2) [m], that is nearest to a point (2,) and within `reach` [m] of it."""
    if not len(position):
        return None
    gap = np.hypot(position[:, 0] - point[0], position[:, 1] - point[1])
    nearest = int(np.argmin(gap))
    return nearest if gap[nearest] <= reach else None


def nearest_of(group: frozenset[int], position: Floats, point: Floats) -> int | None:
    """Index of the robot of a group, of those at (N, 2) [m], that is nearest to a point (2,); None = there is none."""
    there = sorted(robot for robot in group if robot < len(position))
    return min(there, key=lambda robot: math.dist(position[robot], point)) if there else None


def outlines(place: EntityRef, numbers: dict[str, float], layout: Layout, motion: Motion, px: float) -> list[Floats]:
    """Closed outlines (n, 2) [m] of an entity with these numbers."""
    x, y, row = numbers["x"], numbers["y"], place.row
    match place.kind:
        case EntityKind.ROBOT:
            return [shapes.circle(x, y, _ROBOT * px)]
        case EntityKind.FIRE | EntityKind.CIRCLE:
            return [shapes.circle(x, y, numbers["radius"])]
        case EntityKind.BAR:
            bar = shaped(layout, place, numbers, numbers_of(place, layout, motion)).obstacles.bars[row]
            return [shapes.capsule(bar[:2], bar[2:4], bar[4])]
        case EntityKind.POLYGON:
            new = shaped(layout, place, numbers, numbers_of(place, layout, motion))
            return [shapes.closed(chain) for chain in obstacles_of(new.obstacles.polygons)[row]]


def _along(degrees: float) -> Floats:
    return floats([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
