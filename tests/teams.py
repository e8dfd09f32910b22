"""Small teams and worlds for the tests: what a scenario file would say, without the file."""

from collections.abc import Sequence

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import OperatorCommand, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.viewport import Arena
from higvf_console.world.layout import Fire, Layout
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.setup import Setup, make_setup

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
    layout = Layout(
        arena=arena or Arena(0.0, 0.0, 1200.0, 700.0),
        formation=floats(robots, -1, 2),
        walls=False,
        obstacles=Obstacles(floats(circles, -1, 3), floats(bars, -1, 5), tuple(polygons)),
        fires=tuple(Fire((x, y), radius, growth, needs) for x, y, radius in fires),
        params=params or Parameters(),
    )
    return make_setup(layout, layout.formation)


def stroke(points: Sequence[tuple[float, float]] | Floats, robot: int | None = None) -> list[OperatorCommand]:
    """The commands of a whole stroke."""
    return [StrokeBegin(), StrokePoints(floats(points, -1, 2)), StrokeEnd(robot=robot)]
