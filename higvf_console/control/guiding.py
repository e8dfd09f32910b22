"""Guiding vector field of the desired path, [2], and the composite field round obstacles, [7], [8].

The composite step is applied once, to the blended velocity: inside a reactive boundary that the robot heads into, its
velocity turns towards circulation, fully so at the repulsive boundary. The whole team circulates on one side of a ring:
that side is agreed in each connected component and kept until the ring is empty. Robots that each choose a side split
round a bar and hold each other there.
"""

import math

import numpy as np

from higvf_console.arrays import Bools, Floats, Ints
from higvf_console.control.bump import zero_in
from higvf_console.control.gains import PathGains, RingGains
from higvf_console.control.kernel import kernel
from higvf_console.control.obstacles import ring_at
from higvf_console.control.paths import nearest
from higvf_console.state import Path


@kernel
def guiding_vector(path: Path, w: float, window: float, x: float, y: float, gains: PathGains) -> tuple[float, float]:
    """Unit guiding vector at (x, y), [2] with signed distance over capture distance.

    X_hat = (gamma t - k e n) / sqrt(1 + (k e)^2); past the end of an open path it points back to the end.
    """
    w, fx, fy, tx, ty = nearest(path, w, window, x, y)
    gamma = path.direction
    if not path.closed and (
        (gamma > 0.0 and w >= path.length) or (gamma < 0.0 and w <= 0.0 and path.length < math.inf)
    ):
        gamma = 0.0
    vx = gamma * tx - (x - fx) / gains.capture_distance
    vy = gamma * ty - (y - fy) / gains.capture_distance
    norm = math.sqrt(vx * vx + vy * vy)
    if norm == 0.0:
        return path.direction * tx, path.direction * ty
    return vx / norm, vy / norm


@kernel
def composite_velocity(
    vx: float, vy: float, x: float, y: float, i: int, side: Ints, own_ring: int, table: Floats, rings: RingGains
) -> tuple[float, float]:
    """Turns robot i's velocity towards circulation inside the rings it heads into, [8].

    v <- w_P v + |v| sum_i w_i tau_i,  w_P = prod S_i,  w_i = (1 - w_P) Z_i / sum Z,  tau_i = side_i E n_i.

    Args:
        vx: velocity [m/s].
        vy: velocity [m/s].
        x: position [m].
        y: position [m].
        i: robot index.
        side: (N, K) circulation sides.
        own_ring: ring of the robot's goal, no obstacle to it, or NOBODY.
        table: (K, 5) rings.
        rings: margins and bump rates.
    """
    speed = math.sqrt(vx * vx + vy * vy)
    path_weight, bump_sum, turn_x, turn_y = 1.0, 0.0, 0.0, 0.0
    for k in range(table.shape[0]):
        distance, nx, ny, radius = ring_at(table, k, x, y)
        if distance >= radius + rings.reactive_margin or vx * nx + vy * ny >= 0.0 or k == own_ring:
            continue
        zero_out = 1.0 - zero_in(distance, radius, rings)
        around = 1.0 if side[i, k] >= 0 else -1.0
        path_weight *= 1.0 - zero_out
        bump_sum += zero_out
        turn_x -= around * zero_out * ny
        turn_y += around * zero_out * nx
    if bump_sum == 0.0:
        return vx, vy
    share = speed * (1.0 - path_weight) / bump_sum
    return path_weight * vx + share * turn_x, path_weight * vy + share * turn_y


@kernel
def agree_sides(
    blended: Floats, position: Floats, before: Ints, component: Ints, influenced: int, table: Floats, rings: RingGains
) -> Ints:
    """The circulation side of each ring, (N, K), agreed in each connected component.

    Set by the first robot that heads inward in a ring (sign of v . E n, +-1), set anew by the influenced robot when it
    first heads inward there (+-2), adopted by all, cleared when no robot of the component is in the ring.
    """
    robots, count = before.shape
    agreed = np.zeros((robots, count), np.int64)  # row of a component: its smallest robot index
    occupied = np.zeros((robots, count), np.bool_)
    for i in range(robots):
        c = component[i]
        for k in range(count):
            if abs(before[i, k]) > abs(agreed[c, k]):
                agreed[c, k] = before[i, k]
    for i in range(robots):
        c = component[i]
        weight = 2 if i == influenced else 1
        for k in range(count):
            distance, nx, ny, radius = ring_at(table, k, position[i, 0], position[i, 1])
            if distance >= radius + rings.reactive_margin:
                continue
            occupied[c, k] = True
            open_to_me = agreed[c, k] == 0 or abs(agreed[c, k]) < weight
            if open_to_me and blended[i, 0] * nx + blended[i, 1] * ny < 0.0:
                agreed[c, k] = weight if blended[i, 1] * nx - blended[i, 0] * ny >= 0.0 else -weight
    side = np.zeros((robots, count), np.int64)
    for i in range(robots):
        c = component[i]
        for k in range(count):
            if occupied[c, k]:
                side[i, k] = agreed[c, k]
    return side


@kernel
def has_human(component: Ints, influenced: int, active: bool) -> Bools:
    """(N,) whether the human intention acts in each robot's component."""
    found = np.zeros(component.shape[0], np.bool_)
    if active:
        for i in range(component.shape[0]):
            found[i] = component[i] == component[influenced]
    return found
