"""Guiding vector field of the desired path, [2], and the composite field round obstacles, [7], [8].

The composite step acts once, on the blended velocity. Inside the reactive boundary, the velocity of a robot that heads
inward turns towards circulation, and circulates fully at the repulsive boundary. Each connected component agrees on one
circulation direction per boundary and keeps it until none of its robots is inside. Robots that chose their directions
independently would split round a bar and block each other.
"""

import math

import numpy as np

from higvf_console.control.forms import Forms
from higvf_console.control.guidance.boundaries import ALONE, TOGETHER, Boundaries, boundary_at, has_hull, opened, row_of
from higvf_console.control.guidance.bump import zero_in
from higvf_console.control.guidance.obstacles import part_at
from higvf_console.control.guidance.paths import nearest
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import BoundaryParameters, PathParameters
from higvf_console.core.arrays import Bools, Floats, Ints
from higvf_console.core.state import GRID_CELL, GRID_COLUMNS, GRID_X, GRID_Y, NOBODY, Motion, Path, World


@kernel
def guiding_vector(
    path: Path, w: float, window: float, x: float, y: float, params: PathParameters
) -> tuple[float, float]:
    """Unit guiding vector at (x, y), [2], with the signed distance e in units of the capture distance 1/k.

    X_hat = (gamma t - k e n) / sqrt(1 + (k e)^2). Beyond the end of an open path it points back to the end.

    Args:
        path: desired path.
        w: last arc length of the nearest point [m].
        window: half width of the search for the nearest point [m].
        x: position [m].
        y: position [m].
        params: holds the capture distance [m].
    """
    w, fx, fy, tx, ty = nearest(path, w, window, x, y)
    gamma = path.direction
    if not path.closed and (
        (gamma > 0.0 and w >= path.length) or (gamma < 0.0 and w <= 0.0 and path.length < math.inf)
    ):
        gamma = 0.0
    vx = gamma * tx - (x - fx) / params.capture_distance
    vy = gamma * ty - (y - fy) / params.capture_distance
    norm = math.sqrt(vx * vx + vy * vy)
    if norm == 0.0:
        return path.direction * tx, path.direction * ty
    return vx / norm, vy / norm


@kernel
def composite_velocity(
    vx: float, vy: float, x: float, y: float, i: int, circulation: Ints, own_boundary: int, goal_x: float,
    goal_y: float, boundaries: Boundaries, world: World, margins: BoundaryParameters, forms: Forms,
) -> tuple[float, float]:  # fmt: skip
    """Turns the velocity of robot i towards circulation inside the reactive boundaries that it heads into, [8].

    v <- w_P v + |v| sum_k w_k tau_k,  w_P = prod S_k,  w_k = (1 - w_P) Z_k / sum Z,  tau_k = c_k E n_k,

    with the circulation direction c_k of shape k. Inside a hull that does not contain its goal, the robot leaves along
    the shortest way.

    Args:
        vx: velocity [m/s].
        vy: velocity [m/s].
        x: position [m].
        y: position [m].
        i: robot index.
        circulation: (N, K) circulation directions, positive counter-clockwise.
        own_boundary: index of the shape of the robot's target, which is no obstacle to it, or NOBODY.
        goal_x: goal of the robot [m]; NaN for none.
        goal_y: goal of the robot [m].
        boundaries: from `boundaries.find_boundaries`.
        world: the obstacles of each group.
        margins: margins of the boundaries [m] and rates of the bump.
        forms: form of the bump.
    """
    speed = math.sqrt(vx * vx + vy * vy)
    total = (1.0, 0.0, 0.0, 0.0)  # path weight w_P, sum of Z_k, sum of Z_k tau_k
    for k in range(boundaries.capsule.shape[0]):
        row = row_of(boundaries, k, own_boundary, goal_x, goal_y)
        if row == NOBODY:
            continue
        gap, nx, ny = boundary_at(boundaries, row, k, x, y)
        if gap >= margins.reactive_margin:
            continue
        around = 1.0 if circulation[i, k] >= 0 else -1.0
        hull = has_hull(boundaries, row, k)
        if hull and row == ALONE and opened(boundaries, ALONE, k, goal_x, goal_y):
            total = _with_parts(total, vx, vy, x, y, k, gap, around, world, margins, forms)
            continue
        if hull and gap < 0.0:
            out_x, out_y = way_out(boundaries, row, k, x, y, world)
            if out_x != 0.0 or out_y != 0.0:
                return speed * out_x, speed * out_y
        radius = 0.0 if hull else float(boundaries.capsule[k, 4])
        total = _with_turn(total, _turn(vx, vy, gap, nx, ny, radius, around, hull, margins, forms))
    path_weight, bump_sum, turn_x, turn_y = total
    if bump_sum == 0.0:
        return vx, vy
    share = speed * (1.0 - path_weight) / bump_sum
    return path_weight * vx + share * turn_x, path_weight * vy + share * turn_y


@kernel
def _with_parts(
    total: tuple[float, float, float, float], vx: float, vy: float, x: float, y: float, k: int, gap: float,
    around: float, world: World, margins: BoundaryParameters, forms: Forms,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Adds group k whose hull contains the robot's goal: its parts one by one, or their smoothed gap in its pocket."""
    if gap < 0.0 and world.boundary[k, GRID_COLUMNS] > 0.0:
        room, nx, ny = smoothed_gap(k, x, y, world)
        return _with_turn(total, _turn(vx, vy, room, nx, ny, 0.0, around, False, margins, forms))
    for p in range(world.boundary_start[1, k], world.boundary_start[1, k + 1]):
        part = world.part[p]
        room, nx, ny = part_at(part, x, y, world)
        radius = float(world.capsules[part, 4])
        total = _with_turn(total, _turn(vx, vy, room, nx, ny, radius, around, False, margins, forms))
    return total


@kernel
def _with_turn(
    total: tuple[float, float, float, float], turn: tuple[float, float, float]
) -> tuple[float, float, float, float]:
    """Adds the bump Z and the circulation vector tau of a shape to w_P, sum Z and sum Z tau."""
    path_weight, bump_sum, turn_x, turn_y = total
    zero_out, tx, ty = turn
    return path_weight * (1.0 - zero_out), bump_sum + zero_out, turn_x + zero_out * tx, turn_y + zero_out * ty


@kernel
def _turn(
    vx: float, vy: float, gap: float, nx: float, ny: float, radius: float, around: float, hull: bool,
    margins: BoundaryParameters, forms: Forms,
) -> tuple[float, float, float]:  # fmt: skip
    """Zero-out bump Z of a shape and circulation vector tau; Z = 0 for a robot outside or heading outward.

    Near a hull, tau has an outward component too: a hull may span an opening without an obstacle, along which a robot
    would slide into an edge.
    """
    if gap >= margins.reactive_margin or vx * nx + vy * ny >= 0.0:
        return 0.0, 0.0, 0.0
    zero_out = 1.0 - zero_in(max(gap, 0.0) + radius if hull else gap + radius, radius, margins, forms)
    out = min(max(1.0 - gap / margins.repulsive_margin, 0.0), 1.0) if hull and margins.repulsive_margin > 0.0 else 0.0
    return zero_out, out * nx - (1.0 - out) * around * ny, out * ny + (1.0 - out) * around * nx


@kernel
def way_out(boundaries: Boundaries, row: int, k: int, x: float, y: float, world: World) -> tuple[float, float]:
    """Unit vector of the shortest way out of the hull that contains (x, y); zero if there is no grid for it."""
    for g in range(world.boundary.shape[0]):
        member = g == k if row == ALONE else boundaries.cluster[g] == k
        columns = int(world.boundary[g, GRID_COLUMNS])
        if not member or columns == 0 or boundary_at(boundaries, ALONE, g, x, y)[0] >= 0.0:
            continue
        first, last = world.boundary_start[2, g], world.boundary_start[2, g + 1]
        rows = (last - first) // columns
        u = min(max((x - world.boundary[g, GRID_X]) / world.boundary[g, GRID_CELL], 0.0), columns - 1.001)
        v = min(max((y - world.boundary[g, GRID_Y]) / world.boundary[g, GRID_CELL], 0.0), rows - 1.001)
        column, line = int(u), int(v)
        u, v = u - column, v - line
        at = first + line * columns + column
        out_x, out_y = 0.0, 0.0
        for corner in range(4):
            node = at + corner % 2 + columns * (corner // 2)
            weight = (u if corner % 2 == 1 else 1.0 - u) * (v if corner >= 2 else 1.0 - v)
            out_x, out_y = out_x + weight * world.pocket[node, 0], out_y + weight * world.pocket[node, 1]
        length = math.sqrt(out_x * out_x + out_y * out_y)
        if length > 0.0:
            return out_x / length, out_y / length
    return 0.0, 0.0


@kernel
def smoothed_gap(g: int, x: float, y: float, world: World) -> tuple[float, float, float]:
    """Smoothed gap to the parts of group g inside its hull [m], and its unit gradient.

    A uniform cubic B-spline, C2, over the distances at the grid nodes: the exact distance is not differentiable where
    parts meet at an angle. Safety constraints use the exact distances.
    """
    columns = int(world.boundary[g, GRID_COLUMNS])
    first = world.boundary_start[2, g]
    rows = (world.boundary_start[2, g + 1] - first) // columns
    cell = world.boundary[g, GRID_CELL]
    u = min(max((x - world.boundary[g, GRID_X]) / cell, 1.0), columns - 2.001)
    v = min(max((y - world.boundary[g, GRID_Y]) / cell, 1.0), rows - 2.001)
    column, line = int(u), int(v)
    gap, slope_x, slope_y = 0.0, 0.0, 0.0
    for down in range(4):
        weight_v, change_v = _spline(v - line, down)
        for right in range(4):
            weight_u, change_u = _spline(u - column, right)
            room = world.pocket[first + (line + down - 1) * columns + column + right - 1, 2]
            gap += weight_u * weight_v * room
            slope_x += change_u * weight_v * room
            slope_y += weight_u * change_v * room
    length = math.sqrt(slope_x * slope_x + slope_y * slope_y)
    return (gap, slope_x / length, slope_y / length) if length > 0.0 else (gap, 1.0, 0.0)


@kernel
def _spline(t: float, node: int) -> tuple[float, float]:
    """Weight of the uniform cubic B-spline's node 0..3 at t in [0, 1), and its derivative."""
    s = 1.0 - t
    if node == 0:
        return s * s * s / 6.0, -s * s / 2.0
    if node == 1:
        return (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0, (3.0 * t * t - 4.0 * t) / 2.0
    if node == 2:
        return (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, (4.0 * s - 3.0 * s * s) / 2.0
    return t * t * t / 6.0, t * t / 2.0


@kernel
def zero_in_product(
    x: float, y: float, motion: Motion, world: World, margins: BoundaryParameters, forms: Forms
) -> float:
    """Product of S at (x, y) over all obstacles and burning fires, the factor in [9], [13] and [14] as printed."""
    product = 1.0
    for k in range(world.capsules.shape[0]):
        radius = float(world.capsules[k, 4])
        product *= zero_in(part_at(k, x, y, world)[0] + radius, radius, margins, forms)
    for j in range(world.fire_position.shape[0]):
        if motion.fire_burning[j]:
            dx, dy = x - world.fire_position[j, 0], y - world.fire_position[j, 1]
            product *= zero_in(math.sqrt(dx * dx + dy * dy), float(motion.fire_radius[j]), margins, forms)
    return product


@kernel
def agree_circulation(
    blended: Floats, position: Floats, before: Ints, component: Ints, influenced: int, flip: Bools,
    boundaries: Boundaries, margins: BoundaryParameters,
) -> Ints:  # fmt: skip
    """Agrees on circulation directions (N, K) in each connected component; all shapes of a cluster share one.

    The sign is the direction, positive counter-clockwise; the magnitude is its rank. The first robot that heads inward
    inside a reactive boundary sets the direction to the sign of v . E n (+-1). The influenced robot sets it again when
    it first heads inward (+-2). A robot to `flip` reverses it (+-3). All robots of the component adopt the direction of
    highest rank; it is cleared when none of them is inside.

    Args:
        blended: (N, 2) velocities [m/s].
        position: (N, 2) [m].
        before: (N, K) present directions.
        component: (N,) connected component of each robot.
        influenced: the influenced robot, or NOBODY.
        flip: (N,) robots in deadlock recovery that reverse the direction.
        boundaries: from `boundaries.find_boundaries`.
        margins: margin of the reactive boundary [m].
    """
    robots, count = before.shape
    agreed = np.zeros((robots, count), np.int64)  # indexed by component: its smallest robot index
    occupied = np.zeros((robots, count), np.bool_)
    for i in range(robots):
        c = component[i]
        for k in range(count):
            name = boundaries.cluster[k]
            if abs(before[i, k]) > abs(agreed[c, name]):
                agreed[c, name] = before[i, k]
    for i in range(robots):
        c = component[i]
        weight = 2 if i == influenced else 1
        for k in range(count):
            if boundaries.cluster[k] != k:
                continue
            row = TOGETHER if has_hull(boundaries, TOGETHER, k) else ALONE
            gap, nx, ny = boundary_at(boundaries, row, k, position[i, 0], position[i, 1])
            if gap >= margins.reactive_margin:
                continue
            occupied[c, k] = True
            heading_in = blended[i, 0] * nx + blended[i, 1] * ny < 0.0
            if flip[i] and agreed[c, k] != 0:
                agreed[c, k] = -3 if agreed[c, k] > 0 else 3
            elif abs(agreed[c, k]) < weight and heading_in:
                agreed[c, k] = weight if blended[i, 1] * nx - blended[i, 0] * ny >= 0.0 else -weight
    circulation = np.zeros((robots, count), np.int64)
    for i in range(robots):
        c = component[i]
        for k in range(count):
            name = boundaries.cluster[k]
            if occupied[c, name]:
                circulation[i, k] = agreed[c, name]
    return circulation


@kernel
def has_human(component: Ints, influenced: int, active: bool) -> Bools:
    """(N,) whether the human intention is active in each robot's component."""
    found = np.zeros(component.shape[0], np.bool_)
    if active:
        for i in range(component.shape[0]):
            found[i] = component[i] == component[influenced]
    return found
