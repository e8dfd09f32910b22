"""Distances to obstacle parts. Each part is a capsule, a disc swept along a spine; the spine of a circle is a point.

A moving obstacle travels a course, a polyline, at a constant speed and without turning. Its place is a function of
session time alone, so that a live run, a replay and a preview agree bit for bit.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import (
    MOVER_AX,
    MOVER_AY,
    MOVER_BX,
    MOVER_BY,
    MOVER_ENDING,
    MOVER_PART,
    MOVER_SPEED,
    MOVER_START,
    World,
)

STOP, LOOP, ONWARD = 0, 1, 2  # at the end of a course: stay there, go on from its start, or straight on for ever


def capsule_table(circles: ArrayLike, bars: ArrayLike) -> Floats:
    """Circles (P, 3) and bars (Q, 5), see `state.World`, as capsules (P + Q, 5) [m]."""
    return floats(np.concatenate([floats(circles, -1, 3)[:, [0, 1, 0, 1, 2]], floats(bars, -1, 5)]))


@kernel
def spine_point(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> tuple[float, float]:
    """The point of the segment a-b [m] nearest to (x, y)."""
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    if square == 0.0:
        return ax, ay
    share = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
    return ax + share * dx, ay + share * dy


@kernel
def capsule_at(
    x: float, y: float, ax: float, ay: float, bx: float, by: float, radius: float
) -> tuple[float, float, float]:
    """Gap from (x, y) to the surface of a capsule [m], and the outward unit normal; +x on the spine itself."""
    ox, oy = spine_point(x, y, ax, ay, bx, by)
    dx, dy = x - ox, y - oy
    distance = math.sqrt(dx * dx + dy * dy)
    if distance == 0.0:
        return -radius, 1.0, 0.0
    return distance - radius, dx / distance, dy / distance


@kernel
def part_at(k: int, x: float, y: float, world: World) -> tuple[float, float, float]:
    """Gap and outward unit normal of part k of a world, as in `capsule_at`."""
    capsules = world.capsules
    return capsule_at(
        x, y, capsules[k, 0], capsules[k, 1], capsules[k, 2], capsules[k, 3], float(capsules[k, 4])
    )  # fmt: skip


@kernel
def world_at(world: World, tick: int, period: float) -> World:
    """The world with its moving obstacles where they are at a tick, and with their velocities.

    Args:
        world: from `world.build`, or of another tick.
        tick: control periods since the start.
        period: dt [s].
    """
    if world.mover.shape[0] == 0:
        return world
    capsules, velocity = world.capsules.copy(), world.capsule_velocity.copy()
    for v in range(world.mover.shape[0]):
        first, last = world.course_start[v], world.course_start[v + 1]
        speed, start = world.mover[v, MOVER_SPEED], world.mover[v, MOVER_START]
        ending = int(world.mover[v, MOVER_ENDING])
        x, y = course_point(world.course, first, last, start + speed * (tick * period), ending)
        next_x, next_y = course_point(world.course, first, last, start + speed * ((tick + 1) * period), ending)
        part = int(world.mover[v, MOVER_PART])
        capsules[part, 0], capsules[part, 1] = world.mover[v, MOVER_AX] + x, world.mover[v, MOVER_AY] + y
        capsules[part, 2], capsules[part, 3] = world.mover[v, MOVER_BX] + x, world.mover[v, MOVER_BY] + y
        velocity[part, 0], velocity[part, 1] = (next_x - x) / period, (next_y - y) / period
    return World(
        capsules=capsules,
        circle_count=world.circle_count,
        capsule_velocity=velocity,
        mover=world.mover,
        course=world.course,
        course_start=world.course_start,
        walls=world.walls,
        fire_position=world.fire_position,
        fire_growth=world.fire_growth,
        fire_needs=world.fire_needs,
        formation=world.formation,
        link_start=world.link_start,
        link_to=world.link_to,
        boundary=world.boundary,
        boundary_start=world.boundary_start,
        hull=world.hull,
        part=world.part,
        pocket=world.pocket,
    )


@kernel
def course_point(course: Floats, first: int, last: int, travelled: float, ending: int) -> tuple[float, float]:
    """The point of a course, relative to its start [m], at an arc length `travelled` [m].

    Args:
        course: (C, 3) x, y and arc length [m].
        first: row of its start.
        last: row after its end; a course has at least two points, no two of them in one place.
        travelled: may be negative, or longer than the course.
        ending: STOP, LOOP or ONWARD.
    """
    length = float(course[last - 1, 2])
    if ending == LOOP:
        travelled = travelled % length
    elif ending == STOP:
        travelled = min(max(travelled, 0.0), length)
    k = first + 1
    while k < last - 1 and course[k, 2] < travelled:
        k += 1
    share = (travelled - course[k - 1, 2]) / (course[k, 2] - course[k - 1, 2])
    x = course[k - 1, 0] + share * (course[k, 0] - course[k - 1, 0])
    y = course[k - 1, 1] + share * (course[k, 1] - course[k - 1, 1])
    return x, y
