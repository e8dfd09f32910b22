"""Rings: what the vector field goes round. Every obstacle is a capsule, a disc swept along a spine; a disc has a point.

Ring k is circle k, then bar k - P, then fire k - P - Q.
"""

import math

import numpy as np

from higvf_console.arrays import Floats
from higvf_console.control.kernel import kernel
from higvf_console.state import NOBODY, Motion, World

NO_RING = -math.inf  # radius of a ring that is not there: an extinguished fire


@kernel
def ring_table(motion: Motion, world: World) -> Floats:
    """All rings (K, 5): spine ax, ay, bx, by and radius [m]; NO_RING for an extinguished fire."""
    circles, bars, fires = world.circles.shape[0], world.bars.shape[0], world.fire_position.shape[0]
    table = np.empty((circles + bars + fires, 5))
    for k in range(circles):
        table[k, 0] = table[k, 2] = world.circles[k, 0]
        table[k, 1] = table[k, 3] = world.circles[k, 1]
        table[k, 4] = world.circles[k, 2]
    for k in range(bars):
        for column in range(5):
            table[circles + k, column] = world.bars[k, column]
    for k in range(fires):
        row = circles + bars + k
        table[row, 0] = table[row, 2] = world.fire_position[k, 0]
        table[row, 1] = table[row, 3] = world.fire_position[k, 1]
        table[row, 4] = motion.fire_radius[k] if motion.fire_burning[k] else NO_RING
    return table


@kernel
def fire_ring(fire: int, world: World) -> int:
    """The ring of a fire; NOBODY for none."""
    return NOBODY if fire == NOBODY else world.circles.shape[0] + world.bars.shape[0] + fire


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
def ring_at(table: Floats, k: int, x: float, y: float) -> tuple[float, float, float, float]:
    """Ring k from (x, y): distance to its spine [m], outward unit normal, radius [m]; +x at distance zero."""
    ox, oy = spine_point(x, y, table[k, 0], table[k, 1], table[k, 2], table[k, 3])
    dx, dy = x - ox, y - oy
    distance = math.sqrt(dx * dx + dy * dy)
    if distance == 0.0:
        return 0.0, 1.0, 0.0, table[k, 4]
    return distance, dx / distance, dy / distance, table[k, 4]
