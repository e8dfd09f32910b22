"""Safe positions: an edit that would put an entity too near to another holds it at the nearest safe position."""

import math
from collections.abc import Callable
from itertools import chain
from typing import TypeAlias

import numpy as np

from higvf_console.control.parameters import controlled
from higvf_console.core.arrays import Bools, Floats, Ints, floats
from higvf_console.core.numbers import metres
from higvf_console.core.state import Motion
from higvf_console.world.editing.room import obstacle_room
from higvf_console.world.layout import Layout
from higvf_console.world.neighbour_search import kd_tree
from higvf_console.world.placement import wall_gaps

Fits: TypeAlias = Callable[[Floats], Bools]  # which of the points (K, 2) [m] would do

_ANGLES = 64
_RINGS = 600
_BISECTIONS = 24
_HAIR = 1e-6  # [m] to spare, so that rounding never makes a violation
_HELD = 0.001  # distance from the wanted position above which the report says that an entity was held [m]


def nearest_fit(point: Floats, fits: Fits, reach: float) -> Floats | None:
    """The place (2,) nearest to `point` (2,) that fits, within some `reach` [m]; None = there is none.

    Sought on rings round the point, then by bisection on the ways back to the point.
    """
    if fits(floats(point, 1, 2))[0]:
        return floats(point)
    angle = np.linspace(0.0, 2.0 * math.pi, _ANGLES, endpoint=False)
    round_ = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for radius in np.linspace(0.0, reach, _RINGS + 1)[1:]:
        ring = floats(point + radius * round_)
        found = ring[fits(ring)]
        if len(found):
            return _closest(point, found, fits, 1.0 - reach / (_RINGS * radius))
    return None


def _closest(point: Floats, places: Floats, fits: Fits, least: float) -> Floats:
    """The nearest place on the ways from `places` (K, 2), which fit, to the point; at a share of `least` none fits."""
    low, high = np.full((len(places), 1), least), np.ones((len(places), 1))  # shares of the way back from the point
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        good = fits(floats(point + middle * (places - point)))[:, None]
        low, high = np.where(good, low, middle), np.where(good, middle, high)
    ways = high * (places - point)
    return floats(point + ways[np.argmin(np.hypot(ways[:, 0], ways[:, 1]))])


def robot_fits(robot: int, layout: Layout, motion: Motion) -> Fits:
    """Where the controlled point of a robot may be, the others staying where they are."""
    others = np.delete(motion.position, robot, axis=0)
    least = controlled(layout.params).safety.robot_clearance + _HAIR
    tree = kd_tree(others) if len(others) else None
    clear = clear_of(layout, motion, _HAIR)

    def fits(points: Floats) -> Bools:
        alone = np.ones(len(points), np.bool_) if tree is None else tree.query(points)[0] >= least
        return np.asarray(alone & clear(points), np.bool_)

    return fits


def clear_of(layout: Layout, motion: Motion, spare: float) -> Fits:
    """Which points keep clear of obstacles, burning fires and walls, with so much to spare [m]."""
    gap = _gap(layout, motion)
    least = controlled(layout.params).safety.obstacle_clearance + spare
    return lambda points: np.asarray(gap(points) >= least, np.bool_)


def _gap(layout: Layout, motion: Motion) -> Callable[[Floats], Floats]:
    """Distance (K,) of points (K, 2) from the nearest obstacle, burning fire or wall [m], negative inside."""
    burning = np.column_stack([layout.fire_position, motion.fire_radius])[motion.fire_burning]
    obstacles = layout.obstacles_at(motion.tick)
    room = obstacle_room(obstacles._replace(circles=np.vstack([obstacles.circles, burning])))

    def gap(points: Floats) -> Floats:
        return np.min((room(points), *(wall_gaps(points, layout.arena) if layout.walls else ())), axis=0)

    return gap


def body_fits(middle: Floats, gap: Callable[[Floats], Floats], extent: float, layout: Layout, motion: Motion) -> Fits:
    """Where the middle of an obstacle or a fire may be, so that no robot is too near to it.

    Args:
        middle: (2,) where it is [m].
        gap: distance (N,) of points (N, 2) from its surface as it stands there [m], negative inside.
        extent: how far its surface is from its middle at most [m]; robots farther away are not looked at.
        layout: for the clearance.
        motion: where the robots are.
    """
    least = controlled(layout.params).safety.obstacle_clearance + _HAIR
    tree = kd_tree(motion.position)

    def fits(points: Floats) -> Bools:
        near = tree.query_ball_point(points, extent + least)
        place = np.repeat(np.arange(len(points)), [len(robots) for robots in near])
        robots = np.fromiter(chain.from_iterable(near), np.int64, len(place))
        seen = motion.position[robots] - (points[place] - middle)
        crowded_places = place[gap(floats(seen)) < least] if len(place) else place
        return np.bincount(crowded_places, minlength=len(points)) == 0

    return fits


def resettled(layout: Layout, motion: Motion) -> Motion | None:
    """The motion with every robot that stands too near to something at its nearest safe place; None without room."""
    for robot in crowded(layout, motion):
        place = nearest_fit(motion.position[robot], robot_fits(robot, layout, motion), diagonal(layout))
        if place is None:
            return None
        motion = placed(motion, robot, place)
    return motion


def crowded(layout: Layout, motion: Motion) -> list[int]:
    """Robots that stand too near to an obstacle, a burning fire, a wall or a robot."""
    least = controlled(layout.params).safety.robot_clearance
    pairs = kd_tree(motion.position).query_pairs(least - _HAIR, output_type="ndarray")
    near = ~clear_of(layout, motion, -_HAIR)(motion.position)
    near[pairs.ravel()] = True
    return np.flatnonzero(near).tolist()


def newly_crowded(before: tuple[Layout, Motion], after: tuple[Layout, Motion], robots: Ints) -> list[int]:
    """Robots that stand too near to something and did not before, or are now nearer than they may be.

    With measurement errors a robot keeps its clearance, but not always the larger one that counts here. That, and a
    clearance that was missed before, is no licence to put something nearer.

    Args:
        before: layout and motion.
        after: likewise.
        robots: (N,) row that each robot after had before, or a number below 0.
    """
    found = crowded(*after)
    if not found:
        return found
    already = set(crowded(*before))
    known = [robot for robot in found if int(robots[robot]) in already]
    if not known:
        return found
    was, now = _missing(*before), _missing(*after)
    excused = {robot for robot in known if now[robot] <= max(float(was[robots[robot]]), 0.0) + _HAIR}
    return [robot for robot in found if robot not in excused]


def _missing(layout: Layout, motion: Motion) -> Floats:
    """(N,) by how much each robot misses a clearance, were positions measured exactly [m]; up to 0: it does not."""
    params = layout.params
    safety = controlled(params._replace(robots=params.robots._replace(position_noise=0.0))).safety
    missing = safety.obstacle_clearance - _gap(layout, motion)(motion.position)
    if len(motion.position) > 1:
        nearest = kd_tree(motion.position).query(motion.position, k=2)[0][:, 1]
        missing = np.maximum(missing, safety.robot_clearance - nearest)
    return floats(missing)


def held_words(place: Floats, wanted: Floats) -> str:
    """Text that reports an entity held at another position (2,) than the wanted one [m]; else empty."""
    gap = math.hypot(place[0] - wanted[0], place[1] - wanted[1])
    return f"; it is held at the nearest safe place, {metres(gap)} from there" if gap > _HELD else ""


def placed(motion: Motion, robot: int, place: Floats) -> Motion:
    """The motion with a robot's controlled point at `place` (2,) [m], at rest."""
    position, velocity, stalled, recovery_stage = (
        array.copy() for array in (motion.position, motion.velocity, motion.stalled, motion.recovery_stage)
    )
    position[robot], velocity[robot], stalled[robot], recovery_stage[robot] = place, 0.0, 0.0, 0
    return motion._replace(position=position, velocity=velocity, stalled=stalled, recovery_stage=recovery_stage)


def diagonal(layout: Layout) -> float:
    """Of the arena [m]: nothing is held farther away than this."""
    return math.hypot(layout.arena.width, layout.arena.height)
