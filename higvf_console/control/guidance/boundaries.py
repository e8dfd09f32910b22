"""Shapes round which the vector field circulates: obstacle group g, then fire G + j, then moving obstacle G + M + v.

    single circle or bar, fire, moving obstacle   its own capsule
    obstacles with impassable gaps                their convex hull, so that no robot enters a pocket without an exit
    shapes that a fire or a mover comes near to   one cluster, with one circulation direction and the convex hull of all

The reactive and the repulsive boundary lie at fixed margins outside these shapes. Hulls shape only the vector field;
safety constraints use the obstacles themselves. If a robot's goal lies inside a hull, such as a fire in a courtyard,
the field circulates round the single obstacles instead.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.guidance.obstacles import capsule_at, spine_point
from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Floats, Ints
from higvf_console.core.state import MOVER_PART, NOBODY, Motion, World

NO_BOUNDARY = -math.inf  # radius of an extinguished fire, which has no boundary
ALONE, TOGETHER = 0, 1  # a shape by itself, or merged with its cluster
_CORNERS = 16  # of the polygon that approximates a disc in a hull
_PROJECTIONS = 12  # alternating between a spine and another shape: the gap is then known to some centimetres


class Boundaries(NamedTuple):
    """The K = G + M + V shapes of one tick.

    Attributes:
        capsule: (K, 5) spine ax, ay, bx, by and radius [m]; for a hull, a circle that encloses it.
        corner_start: (2, K + 1) the hull of shape k is `corner[corner_start[row, k]:corner_start[row, k + 1]]`, where
            `row` is ALONE, or TOGETHER for the cluster named k; empty for a capsule.
        corner: (V, 2) corners of the hulls, counter-clockwise [m].
        cluster: (K,) name of each shape's cluster, its smallest index; gaps within a cluster are impassable.
    """

    capsule: Floats
    corner_start: Ints
    corner: Floats
    cluster: Ints


@kernel
def find_boundaries(motion: Motion, world: World, clearance: float) -> Boundaries:
    """Builds the shapes as they are now; a gap below 2 R_o is impassable.

    Args:
        motion: for the fires.
        world: at the same tick, see `obstacles.world_at`.
        clearance: R_o [m].

    Returns:
        One shape for each group of obstacles, fire and moving obstacle, and the hulls of clusters.
    """
    groups, fires, movers = world.boundary.shape[0], world.fire_position.shape[0], world.mover.shape[0]
    count = groups + fires + movers
    capsule = np.empty((count, 5))
    corner_start = np.zeros((2, count + 1), np.int64)
    for g in range(groups):
        for column in range(5):
            capsule[g, column] = world.boundary[g, column]
        corner_start[0, g + 1] = world.boundary_start[0, g + 1]
    for j in range(fires):
        k = groups + j
        capsule[k, 0] = capsule[k, 2] = world.fire_position[j, 0]
        capsule[k, 1] = capsule[k, 3] = world.fire_position[j, 1]
        capsule[k, 4] = motion.fire_radius[j] if motion.fire_burning[j] else NO_BOUNDARY
        corner_start[0, k + 1] = corner_start[0, k]
    for v in range(movers):
        k = groups + fires + v
        for column in range(5):
            capsule[k, column] = world.capsules[int(world.mover[v, MOVER_PART]), column]
        corner_start[0, k + 1] = corner_start[0, k]
    boundaries = Boundaries(capsule, corner_start, world.hull, np.arange(count))
    return _with_clusters(boundaries, groups, clearance)


@kernel
def _with_clusters(boundaries: Boundaries, groups: int, clearance: float) -> Boundaries:
    """Merges each fire and moving obstacle with the shapes near it, and adds the hull of each cluster."""
    cluster, joined = boundaries.cluster, False
    count = cluster.shape[0]
    for k in range(groups, count):
        radius = boundaries.capsule[k, 4]
        if radius == NO_BOUNDARY:
            continue
        for other in range(k):
            if boundaries.capsule[other, 4] == NO_BOUNDARY:
                continue
            gap = _spine_gap(boundaries, k, other)
            if gap - radius < 2.0 * clearance and cluster[other] != cluster[k]:
                joined = True
                old, new = max(cluster[k], cluster[other]), min(cluster[k], cluster[other])
                for member in range(count):
                    if cluster[member] == old:
                        cluster[member] = new
    if not joined:
        return boundaries
    corner, corner_start = boundaries.corner, boundaries.corner_start
    first = corner.shape[0]
    for name in range(count):
        corner_start[1, name] = first
        size = 0
        for member in range(count):
            size += cluster[member] == name
        if size > 1:
            hull = convex_hull(_corners_of(boundaries, name))
            corner = np.concatenate((corner, hull))
            first += hull.shape[0]
    corner_start[1, count] = first
    return Boundaries(boundaries.capsule, corner_start, corner, cluster)


@kernel
def _spine_gap(boundaries: Boundaries, k: int, other: int) -> float:
    """Gap between the spine of boundary k and the surface of another one [m]: alternating projections on the two."""
    capsule = boundaries.capsule
    x, y = capsule[k, 0], capsule[k, 1]
    gap, nx, ny = boundary_at(boundaries, ALONE, other, x, y)
    if x == capsule[k, 2] and y == capsule[k, 3]:
        return gap
    for _ in range(_PROJECTIONS):
        x, y = spine_point(
            x - gap * nx, y - gap * ny, capsule[k, 0], capsule[k, 1], capsule[k, 2], capsule[k, 3]
        )  # fmt: skip
        gap, nx, ny = boundary_at(boundaries, ALONE, other, x, y)
        if gap <= 0.0:
            break
    return gap


@kernel
def _corners_of(boundaries: Boundaries, name: int) -> Floats:
    """Points (n, 2) [m] whose convex hull contains every shape of a cluster."""
    points = np.empty((0, 2))
    for k in range(boundaries.cluster.shape[0]):
        if boundaries.cluster[k] == name:
            first, last = boundaries.corner_start[0, k], boundaries.corner_start[0, k + 1]
            own = boundaries.corner[first:last] if last > first else capsule_corners(boundaries.capsule[k])
            points = np.concatenate((points, own))
    return points


@kernel
def capsule_corners(capsule: Floats) -> Floats:
    """Corners (n, 2) [m] of the polygons circumscribed about both end discs of a capsule (5,).

    A capsule of zero radius gives the two ends of its spine.
    """
    radius = capsule[4]
    corners = _CORNERS if radius > 0.0 else 1
    points = np.empty((2 * corners, 2))
    reach = radius / math.cos(math.pi / _CORNERS)
    for c in range(corners):
        turn = 2.0 * math.pi * (c + 0.5) / _CORNERS
        points[c, 0], points[c, 1] = capsule[0] + reach * math.cos(turn), capsule[1] + reach * math.sin(turn)
        points[corners + c, 0] = capsule[2] + reach * math.cos(turn)
        points[corners + c, 1] = capsule[3] + reach * math.sin(turn)
    return points


@kernel
def convex_hull(points: Floats) -> Floats:
    """Corners (h, 2), counter-clockwise, of the convex hull of points (n, 2), by gift wrapping."""
    count = points.shape[0]
    start = 0
    for k in range(1, count):
        if points[k, 0] < points[start, 0] or (points[k, 0] == points[start, 0] and points[k, 1] < points[start, 1]):
            start = k
    chosen = np.empty(count, np.int64)
    used, at = 0, start
    while used < count:
        chosen[used] = at
        used += 1
        best = -1
        for k in range(count):
            bx, by = points[k, 0] - points[at, 0], points[k, 1] - points[at, 1]
            if bx * bx + by * by < 1e-18:
                continue
            if best < 0:
                best = k
                continue
            ax, ay = points[best, 0] - points[at, 0], points[best, 1] - points[at, 1]
            cross = ax * by - ay * bx
            if cross < 0.0 or (cross == 0.0 and bx * bx + by * by > ax * ax + ay * ay):
                best = k
        if best < 0:
            break
        at = best
        dx, dy = points[at, 0] - points[start, 0], points[at, 1] - points[start, 1]
        if dx * dx + dy * dy < 1e-18:
            break
    return points[chosen[:used]]


@kernel
def boundary_at(boundaries: Boundaries, row: int, k: int, x: float, y: float) -> tuple[float, float, float]:
    """Gap from (x, y) to the surface of shape k [m], negative inside, and the outward unit normal there.

    Far from a hull, the gap to the enclosing circle is returned, a lower bound.

    Args:
        boundaries: from `find_boundaries`.
        row: ALONE, or TOGETHER for the cluster named k.
        k: index of the shape.
        x: position [m].
        y: position [m].
    """
    first, last = boundaries.corner_start[row, k], boundaries.corner_start[row, k + 1]
    if first == last or row == ALONE:
        capsule = boundaries.capsule
        gap, nx, ny = capsule_at(
            x, y, capsule[k, 0], capsule[k, 1], capsule[k, 2], capsule[k, 3], float(capsule[k, 4])
        )  # fmt: skip
        if first == last or gap > capsule[k, 4]:
            return gap, nx, ny
    return _hull_at(boundaries.corner, first, last, x, y)


@kernel
def _hull_at(corner: Floats, first: int, last: int, x: float, y: float) -> tuple[float, float, float]:
    """Signed distance from (x, y) to a convex polygon [m], and its gradient."""
    inside, least, nx, ny = -math.inf, math.inf, 1.0, 0.0
    in_nx, in_ny = 1.0, 0.0
    for k in range(first, last):
        after = k + 1 if k + 1 < last else first
        ax, ay, bx, by = corner[k, 0], corner[k, 1], corner[after, 0], corner[after, 1]
        ex, ey = bx - ax, by - ay
        length = math.sqrt(ex * ex + ey * ey)
        out_x, out_y = ey / length, -ex / length
        depth = (x - ax) * out_x + (y - ay) * out_y
        if depth > inside:
            inside, in_nx, in_ny = depth, out_x, out_y
        ox, oy = spine_point(x, y, ax, ay, bx, by)
        distance = math.sqrt((x - ox) ** 2 + (y - oy) ** 2)
        if distance < least:
            least = distance
            if distance > 0.0:
                nx, ny = (x - ox) / distance, (y - oy) / distance
    return (inside, in_nx, in_ny) if inside <= 0.0 else (least, nx, ny)


@kernel
def has_hull(boundaries: Boundaries, row: int, k: int) -> bool:
    """Whether shape k (row ALONE), or the cluster named k (row TOGETHER), is a hull."""
    return boundaries.corner_start[row, k + 1] > boundaries.corner_start[row, k]


@kernel
def opened(boundaries: Boundaries, row: int, k: int, goal_x: float, goal_y: float) -> bool:
    """Whether the hull contains the goal, so that a robot must be able to enter; False for a goal of NaN."""
    return (
        math.isfinite(goal_x)
        and has_hull(boundaries, row, k)
        and boundary_at(boundaries, row, k, goal_x, goal_y)[0] < 0.0
    )


@kernel
def row_of(boundaries: Boundaries, k: int, own_boundary: int, goal_x: float, goal_y: float) -> int:
    """Which shape a robot circulates round at index k: ALONE for shape k, TOGETHER for the cluster named k.

    NOBODY if shape k is the robot's own target, is extinguished, or is represented by its cluster at another index.

    Args:
        boundaries: from `find_boundaries`.
        k: index of the shape.
        own_boundary: index of the shape of the robot's target, or NOBODY.
        goal_x: goal of the robot [m]; NaN for none.
        goal_y: goal of the robot [m].
    """
    name = boundaries.cluster[k]
    if k == own_boundary or boundaries.capsule[k, 4] == NO_BOUNDARY:
        return NOBODY
    if not has_hull(boundaries, TOGETHER, name):
        return ALONE
    if (own_boundary != NOBODY and boundaries.cluster[own_boundary] == name) or opened(
        boundaries, TOGETHER, name, goal_x, goal_y
    ):
        return ALONE
    return TOGETHER if k == name else NOBODY


@kernel
def fire_boundary(fire: int, world: World) -> int:
    """Index of the shape of a fire; NOBODY for no fire."""
    return NOBODY if fire == NOBODY else world.boundary.shape[0] + fire
