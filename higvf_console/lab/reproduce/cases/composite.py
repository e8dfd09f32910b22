"""The composite vector field: path field and circulating field, weighted by the bumps, and their sum."""

from typing import TYPE_CHECKING

import numpy as np

from higvf_console.control.guidance.bump import zero_in
from higvf_console.control.guidance.field import FieldKind, field_at
from higvf_console.control.guidance.obstacles import part_at
from higvf_console.core.arrays import Bools, Floats, floats, ints
from higvf_console.lab.reproduce.case import Case, Findings, Picture, within
from higvf_console.lab.reproduce.cases.fields import WIDE, draw_obstacle_boundaries
from higvf_console.lab.reproduce.figures.arrows import draw_arrows, grid_points
from higvf_console.lab.reproduce.figures.canvas import INK, PAGE, dress_map, new_figure
from higvf_console.lab.reproduce.figures.maps import draw_obstacles, draw_path
from higvf_console.lab.reproduce.runs import Runs
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_CROSSED = f"""
version: 1
arena: {{x_min: -150, y_min: -100, x_max: 150, y_max: 100, walls: false}}
robots: {{start_m: [[-140, 0]]}}
obstacles: {{circles: [{{at_m: [0, -8], radius_m: 22}}]}}
path: {{line: {{at_m: [-150, 0], angle_deg: 0}}}}
parameters: {{{WIDE}}}
"""


class _Panels:
    """The five fields of Fig. 6 on one grid, each (G, 2), with vectors of at most unit length."""

    def __init__(self, setup: Setup, columns: int) -> None:
        state, world, params = setup.start, setup.world, setup.params
        speed = params.blending.cruise_speed
        self.cell = setup.arena.width / columns
        self.points = grid_points(setup.arena, columns)
        self.path = field_at(FieldKind.PATH, self.points, state, world, params) / speed
        circle = world.circles[0]
        away = self.points - circle[:2]
        self.bump = np.array(
            [zero_in(float(np.hypot(*p)), float(circle[2]), params.boundaries, params.forms) for p in away]
        )
        normal = np.array([part_at(0, x, y, world)[1:] for x, y in self.points.tolist()])
        self.around = floats(np.stack([normal[:, 1], -normal[:, 0]], axis=1))  # -E n: clockwise
        clockwise = ints([[-1]])
        self.outside = np.hypot(*away.T) > circle[2]
        self.sum = self.bump[:, None] * self.path + (1.0 - self.bump)[:, None] * self.around
        agreed = state._replace(motion=state.motion._replace(circulation=clockwise))
        self.engine = field_at(FieldKind.COMPOSITE, self.points, agreed, world, params) / speed


def run_composite(_: Runs) -> Findings:
    """Compares the composite field of the engine with the five panels of Fig. 6."""
    setup = parse_scenario(_CROSSED, "composite").setup()
    panels = _Panels(setup, 30)
    outside = panels.bump == 1.0
    apart = np.hypot(*(panels.engine - panels.path).T)
    return Findings(
        (
            within(
                "Largest difference between composite and path field outside R",
                float(apart[outside].max()),
                "",
                0.0,
                1e-9,
                "0: only the path field acts outside R",
            ),
            within(
                "Largest share of the path field inside Q",
                float(panels.bump[_inside_q(panels, setup)].max()),
                "",
                0.0,
                0.0,
                "0: only the circulating field acts inside Q",
            ),
            within("Length of the circulating field", float(np.hypot(*panels.around.T).mean()), "", 0.999, 1.001, "1"),
        ),
        (
            Picture(
                "composite",
                "Composition of the vector field (paper, Fig. 6). Colours as in the paper: red outside"
                " R, green inside Q, blue between.",
                lambda: _draw_composite(setup),
            ),
            Picture(
                "composite-engine",
                "The field of the engine: an obstacle turns only robots that head towards it, so that a"
                " robot beyond the obstacle is not led round it again.",
                lambda: _draw_engine(setup),
            ),
        ),
        notes=(
            "The first five panels show the printed sum; the last figure shows the engine. The engine applies the"
            " composite step once, to the blended velocity of each robot, and only to robots that head inward inside a"
            " reactive boundary. Here X_R is orthogonal to the surface normal; the safety filter keeps the team clear"
            " of obstacles.",
        ),
    )


def _inside_q(panels: _Panels, setup: Setup) -> Bools:
    circle = setup.world.circles[0]
    return np.hypot(*(panels.points - circle[:2]).T) <= circle[2] + setup.params.boundaries.repulsive_margin


def _draw_composite(setup: Setup) -> "Figure":
    panels = _Panels(setup, 30)
    figure = new_figure(PAGE, 7.2)
    grid = figure.add_gridspec(3, 4)
    zero_out = (1.0 - panels.bump)[:, None]
    zone = [
        INK.reactive if inner else INK.fire if s == 1.0 else INK.ours
        for s, inner in zip(panels.bump.tolist(), _inside_q(panels, setup).tolist(), strict=True)
    ]
    shown: list[tuple[tuple[int, slice], str, Floats, str | list[str]]] = [
        ((0, slice(0, 2)), r"(a) $\hat{X}_P$: the desired path", panels.path, INK.fire),
        ((0, slice(2, 4)), r"(b) $\hat{X}_R$: circulation", panels.around, INK.reactive),
        ((1, slice(0, 2)), r"(c) $S\,\hat{X}_P$: zero-in", panels.bump[:, None] * panels.path, INK.fire),
        ((1, slice(2, 4)), r"(d) $Z\,\hat{X}_R$: zero-out", zero_out * panels.around, INK.reactive),
        ((2, slice(1, 3)), r"(e) $S\,\hat{X}_P + Z\,\hat{X}_R$: composite", panels.sum, zone),
    ]
    for (line, columns), title, field, ink in shown:
        axes = figure.add_subplot(grid[line, columns])
        _dress_panel(axes, setup, title)
        inked = ink if isinstance(ink, str) else [c for c, out in zip(ink, panels.outside, strict=True) if out]
        draw_arrows(axes, panels.points[panels.outside], field[panels.outside], panels.cell, inked)
    return figure


def _draw_engine(setup: Setup) -> "Figure":
    panels = _Panels(setup, 36)
    figure = new_figure(PAGE * 0.75, 3.6)
    axes = figure.subplots()
    _dress_panel(axes, setup, "")
    draw_arrows(axes, panels.points[panels.outside], panels.engine[panels.outside], panels.cell, INK.ours)
    return figure


def _dress_panel(axes: "Axes", setup: Setup, title: str) -> None:
    dress_map(axes, setup.arena, 50.0)
    axes.set_title(title)
    draw_path(axes, setup.start.intent.path)
    draw_obstacles(axes, setup.world)
    draw_obstacle_boundaries(axes, setup.world, setup.params)


CASES = (
    Case(
        "composite",
        "The composite vector field",
        "Fig. 6: path field and boundary field, weighted by the bumps.",
        "Path field, circulation and bump of the engine on a grid, multiplied and added as in the panels.",
        run_composite,
    ),
)
