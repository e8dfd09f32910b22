"""The parts of obstacles: every one is a capsule, a disc swept along a spine; the spine of a circle is a point."""

import math

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import World


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
    """A capsule from (x, y): gap to its surface [m], outward unit normal; +x on the spine itself."""
    ox, oy = spine_point(x, y, ax, ay, bx, by)
    dx, dy = x - ox, y - oy
    distance = math.sqrt(dx * dx + dy * dy)
    if distance == 0.0:
        return -radius, 1.0, 0.0
    return distance - radius, dx / distance, dy / distance


@kernel
def part_at(k: int, x: float, y: float, world: World) -> tuple[float, float, float]:
    """Part k from (x, y), as `capsule_at`."""
    capsules = world.capsules
    return capsule_at(
        x, y, capsules[k, 0], capsules[k, 1], capsules[k, 2], capsules[k, 3], float(capsules[k, 4])
    )  # fmt: skip
