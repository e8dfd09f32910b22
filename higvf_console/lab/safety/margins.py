"""What is left of the clearances in a world, by NumPy alone."""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import Motion
from higvf_console.world.polygons import obstacles_of, signed_distance, spine_distance
from higvf_console.world.setup import Setup

ROUNDING = 1e-6  # [m] by which a clearance may be missed


class Margins(NamedTuple):
    """What is left of each clearance [m], negative where it is violated: N robots, H hazards.

    Attributes:
        hazards: (N, H) of obstacles, walls and fires.
        pairs: (N, N) of robots; inf on the diagonal.
    """

    hazards: Floats
    pairs: Floats


class Measure:
    """Measures the margins in one world.

    Attributes:
        setup: the world and its clearances.
    """

    def __init__(self, setup: Setup) -> None:
        """Prepares what stays the same from tick to tick."""
        self.setup = setup
        layout = setup.layout
        self._moving = bool(layout.obstacles.movers())
        self._polygons = obstacles_of(layout.obstacles.polygons)
        self._fire_position = layout.fire_position
        arena = layout.arena
        self._low = np.array([arena.x_min, arena.y_min])
        self._high = np.array([arena.x_max, arena.y_max])

    def margins(self, points: Floats, motion: Motion, extra: float = 0.0) -> Margins:
        """Margins of points (N, 2) [m].

        Args:
            points: what is to keep clear, one for each robot.
            motion: tick and fires.
            extra: by how much clearances from hazards are enlarged, twice that between robots [m].
        """
        layout, safety = self.setup.layout, self.setup.params.safety
        obstacles = layout.obstacles_at(motion.tick) if self._moving else layout.obstacles
        gaps = [_to_centres(points, obstacles.circles[:, :2]) - obstacles.circles[:, 2]]
        if len(obstacles.bars):
            gaps.append(spine_distance(points, obstacles.bars[:, :4]) - obstacles.bars[:, 4])
        gaps += [signed_distance(chains, points)[:, None] for chains in self._polygons]
        burning = np.where(motion.fire_burning, motion.fire_radius, -math.inf)
        gaps.append(_to_centres(points, self._fire_position) - burning)
        if layout.walls:
            gaps += [points - self._low, self._high - points]
        apart = _to_centres(points, points)
        np.fill_diagonal(apart, math.inf)
        return Margins(
            floats(np.concatenate(gaps, axis=1) - (safety.obstacle_clearance + extra)),
            floats(apart - (safety.robot_clearance + 2.0 * extra)),
        )

    def worst(self, found: Margins) -> str:
        """The violation that is largest, in words; empty where there is none."""
        values = [(float(part.min(initial=math.inf)), part, name) for name, part in found._asdict().items()]
        margin, part, name = min(values, key=lambda one: one[0])
        if margin >= -2.0 * ROUNDING:  # a start may miss a clearance by one rounding already
            return ""
        i, k = np.unravel_index(int(part.argmin()), part.shape)
        return f"{self.name(name, int(i), int(k))}: margin {margin:.6g} m"

    def name(self, part: str, robot: int, column: int) -> str:
        """A robot and what it is too near to, e.g. "robot 2 and fire 1"."""
        if part == "pairs":
            return f"robot {robot + 1} and robot {column + 1}"
        layout = self.setup.layout
        counts = {
            "circle": len(layout.obstacles.circles),
            "bar": len(layout.obstacles.bars),
            "polygon": len(self._polygons),
            "fire": len(layout.fires),
        }
        for what, count in counts.items():
            if column < count:
                return f"robot {robot + 1} and {what} {column + 1}"
            column -= count
        return f"robot {robot + 1} and the arena's wall"


def _to_centres(points: Floats, centres: Floats) -> Floats:
    """Distances (n, K) [m] of points (n, 2) from centres (K, 2)."""
    return np.hypot(points[:, :1] - centres[:, 0], points[:, 1:] - centres[:, 1])
