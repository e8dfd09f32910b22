"""Small teams and worlds for the tests: what a scenario file would say, without the file."""

from collections.abc import Sequence

import numpy as np

from higvf_console.control.parameters import Parameters, controlled
from higvf_console.core.arrays import Floats, floats, ints
from higvf_console.core.commands import OperatorCommand, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.viewport import Arena
from higvf_console.sim.setup import Setup
from higvf_console.sim.simulation import initial_state
from higvf_console.world.build import make_world

TRIANGLE = ((100.0, 350.0), (60.0, 320.0), (60.0, 380.0))


def team(
    robots: Sequence[tuple[float, float]] = TRIANGLE,
    fires: Sequence[tuple[float, float, float]] = (),
    circles: Sequence[tuple[float, float, float]] = (),
    bars: Sequence[tuple[float, float, float, float, float]] = (),
    params: Parameters | None = None,
    growth: float = 1.0,
    needs: int = 2,
    arena: Arena | None = None,
    polygons: Sequence[Floats] = (),
) -> Setup:
    """Robots (x, y), fires (x, y, radius), circles (x, y, radius), bars (ax, ay, bx, by, half width) [m]; no walls."""
    burning = floats(fires, -1, 3)
    params = params or Parameters()
    world = make_world(
        floats(circles, -1, 3), floats(bars, -1, 5), np.zeros((0, 3)), burning[:, :2], floats([growth] * len(fires)),
        ints([needs] * len(fires)), floats(robots, -1, 2), controlled(params).safety.obstacle_clearance,
        polygons=polygons,
    )  # fmt: skip
    start = initial_state(world.formation, floats(burning[:, 2]), world)
    return Setup(arena or Arena(0.0, 0.0, 1200.0, 700.0), world, params, start, tuple(polygons))


def stroke(points: Sequence[tuple[float, float]] | Floats, robot: int | None = None) -> list[OperatorCommand]:
    """The commands of a whole stroke."""
    return [StrokeBegin(), StrokePoints(floats(points, -1, 2)), StrokeEnd(robot=robot)]
