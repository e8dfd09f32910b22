"""The parts of obstacles: every one is a capsule, a disc swept along a spine; a disc's spine is a point.

Part k is circle k, then bar k - P. An irregular obstacle is a closed chain of bars without width.
"""

import math

from higvf_console.control.kernel import kernel
from higvf_console.core.state import World


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
def part_radius(k: int, world: World) -> float:
    """Radius of part k [m]."""
    circles = world.circles.shape[0]
    return world.circles[k, 2] if k < circles else world.bars[k - circles, 4]


@kernel
def part_at(k: int, x: float, y: float, world: World) -> tuple[float, float, float]:
    """Part k from (x, y), as `capsule_at`."""
    circles = world.circles.shape[0]
    if k < circles:
        cx, cy = world.circles[k, 0], world.circles[k, 1]
        return capsule_at(x, y, cx, cy, cx, cy, world.circles[k, 2])
    b = k - circles
    return capsule_at(
        x, y, world.bars[b, 0], world.bars[b, 1], world.bars[b, 2], world.bars[b, 3], world.bars[b, 4]
    )  # fmt: skip
