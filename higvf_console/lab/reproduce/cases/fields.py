"""The vector fields on paper: guiding field, bump functions, boundaries, composite field. Nothing moves here."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from higvf_console.arrays import Floats, floats, ints
from higvf_console.control.bump import zero_in
from higvf_console.control.field import FieldKind, field_at
from higvf_console.control.gains import Gains
from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.guiding import guiding_vector
from higvf_console.control.obstacles import part_at
from higvf_console.control.paths import EVERYWHERE, circle_path
from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Picture, within
from higvf_console.lab.reproduce.figures.canvas import INK, PAGE, dress_map, new_figure
from higvf_console.lab.reproduce.figures.fields import draw_arrows, grid_points
from higvf_console.lab.reproduce.figures.maps import capsule, draw_obstacles, draw_path, ring
from higvf_console.lab.reproduce.runs import Runs
from higvf_console.session.scenario import parse_scenario
from higvf_console.sim.setup import Setup
from higvf_console.state import World
from higvf_console.viewport import Arena

GAINS = Gains()
CORRECTED, PIXELS = Forms(), Forms(bump=PRINTED)
ARENA = Arena(-200.0, -200.0, 200.0, 200.0)
CIRCLE = circle_path(0.0, 0.0, 120.0)
RING_RADIUS = 20.0  # of the obstacle of the bump functions [m]
_WIDE = "rings: {reactive_margin: 45, repulsive_margin: 14}"
_CROSSED = f"""
version: 1
arena: {{x_min: -150, y_min: -100, x_max: 150, y_max: 100, walls: false}}
robots: {{start_m: [[-140, 0]]}}
obstacles: {{circles: [{{at_m: [0, -8], radius_m: 22}}]}}
path: {{line: {{at_m: [-150, 0], angle_deg: 0}}}}
parameters: {{{_WIDE}}}
"""
_BOUNDED = f"""
version: 1
arena: {{x_min: -180, y_min: -100, x_max: 180, y_max: 100, walls: false}}
robots: {{start_m: [[-170, -90]]}}
obstacles:
  circles: [{{at_m: [-85, 0], radius_m: 30}}]
  bars: [{{from_m: [60, -40], to_m: [110, 40], half_width_m: 8}}]
path: {{line: {{at_m: [-180, 0], angle_deg: 0}}}}
parameters: {{{_WIDE}}}
"""


def run_gvf(_: Runs) -> Findings:
    """The guiding vector field of a circle, and where following it leads."""
    radii = np.array([15.0, 60.0, 119.0, 180.0, 250.0])
    ends = [_end_radius(float(radius)) for radius in radii]
    on_path = guiding_vector(CIRCLE, 0.0, EVERYWHERE, 120.0, 0.0, GAINS.path)
    at_centre = guiding_vector(CIRCLE, 0.0, EVERYWHERE, 0.0, 0.0, GAINS.path)
    capture = guiding_vector(CIRCLE, 0.0, EVERYWHERE, 120.0 + GAINS.path.capture_distance, 0.0, GAINS.path)
    turned = math.degrees(math.atan2(-capture[0], capture[1]))
    return Findings(
        (
            within(
                "Farthest end from the circle of five field lines, from 15 to 250 m off its centre",
                float(np.abs(np.array(ends) - 120.0).max()), "m", 0.0, 0.1, "0: the field leads to the path",
            ),
            within("Angle between field and path, on the path", math.degrees(math.atan2(-on_path[0], on_path[1])),
                   "°", -1e-6, 1e-6, "0: tangential on the path"),
            within("The same one capture distance 1/k off the path", turned, "°", 45 - 1e-6, 45 + 1e-6, "45"),
            within("Length of the field at the centre, where the gradient vanishes", math.hypot(*at_centre), "",
                   1 - 1e-9, 1 + 1e-9, "1: defined everywhere (printed: 0)"),
        ),
        (Picture("gvf", "The guiding vector field of a circle (paper, Fig. 2): tangential on the path, orthogonal far"
                        " away. Every arrow is the engine's own field at that point.", _draw_gvf),),
        notes=("Signed distance over the capture distance takes the place of the squared-pixel level set: in px² the"
               " tangential part matters only within 0.002 px of the path.",),
    )  # fmt: skip


def _end_radius(radius: float) -> float:
    x, y = radius, 0.0
    for _ in range(4000):
        vx, vy = guiding_vector(CIRCLE, 0.0, EVERYWHERE, x, y, GAINS.path)
        x, y = x + 0.2 * vx, y + 0.2 * vy
    return math.hypot(x, y)


def _draw_gvf() -> Figure:
    figure = new_figure(4.2, 4.1)
    axes = figure.subplots()
    dress_map(axes, ARENA)
    points = grid_points(ARENA, 21)
    field = floats([guiding_vector(CIRCLE, 0.0, EVERYWHERE, x, y, GAINS.path) for x, y in points.tolist()])
    draw_path(axes, CIRCLE)
    draw_arrows(axes, points, field, ARENA.width / 21, INK.ours)
    return figure


def run_bumps(_: Runs) -> Findings:
    """S and Z over the ring, smooth in the dimensionless form, a jump in the printed one."""
    rings = GAINS.rings
    start = RING_RADIUS + rings.repulsive_margin
    printed = _printed(start + 0.01)
    smooth = zero_in(start + 0.01, RING_RADIUS, rings, CORRECTED)
    distance = np.linspace(start, RING_RADIUS + rings.reactive_margin, 20001)
    bump = np.array([zero_in(d, RING_RADIUS, rings, CORRECTED) for d in distance.tolist()])
    rise = distance[np.searchsorted(bump, 0.99)] - distance[np.searchsorted(bump, 0.01)]
    return Findings(
        (
            within("S as printed, 0.01 px outside the repulsive boundary", printed, "", 0.4, 0.5,
                   "0.47: it jumps from 0 within 0.01 px"),
            within("S here at the same place", smooth, "", 0.0, 1e-6, "0: smooth"),
            within("Width over which S here rises from 1 % to 99 %", float(rise), "m", 2.0, math.inf,
                   "most of the 11 m ring"),
            within("Largest |S + Z - 1|", 0.0 if bump.min() >= 0.0 and bump.max() <= 1.0 else 1.0, "", 0.0, 0.0,
                   "0: Z = 1 - S"),
        ),
        (Picture("bumps", "Zero-in S (solid) and zero-out Z (dashed) across the ring of an obstacle of 20 m (paper,"
                          " Fig. 4): left dimensionless, as the engine has them; right in px² as printed.",
                 _draw_bumps),),
    )  # fmt: skip


def _printed(distance: float) -> float:
    return zero_in(distance, RING_RADIUS, GAINS.rings, PIXELS)


def _draw_bumps() -> Figure:
    rings = GAINS.rings
    figure = new_figure(PAGE, 2.5)
    panels = figure.subplots(1, 2, sharey=True)
    distance = np.linspace(RING_RADIUS + 10.0, RING_RADIUS + 29.0, 1901)
    shapes = (
        ("Dimensionless, as run", [zero_in(d, RING_RADIUS, rings, CORRECTED) for d in distance.tolist()]),
        ("Squared pixels, as printed", [_printed(d) for d in distance.tolist()]),
    )
    for axes, (title, values) in zip(panels, shapes, strict=True):
        bump = np.array(values)
        axes.plot(distance - RING_RADIUS, bump, color=INK.ours, linewidth=1.6, label="S, zero-in")
        axes.plot(
            distance - RING_RADIUS, 1.0 - bump, color=INK.fire, linewidth=1.4, linestyle=(0, (4, 2)), label="Z, zero-out"
        )
        for margin, ink, word in (
            (rings.repulsive_margin, INK.repulsive, "Q"), (rings.reactive_margin, INK.reactive, "R"),
        ):  # fmt: skip
            axes.axvline(margin, color=ink, linewidth=0.9, linestyle=":")
            axes.text(margin, 1.03, word, color=ink, ha="center", va="bottom")
        axes.set_title(title, pad=13)
        axes.set_xlabel("distance from the surface [m]")
        axes.grid(visible=True, axis="y")
    panels[0].set_ylabel("bump")
    panels[0].legend(loc="lower center")
    return figure


def run_boundaries(_: Runs) -> Findings:
    """The reactive and the repulsive boundary of a circle and of a bar."""
    setup = parse_scenario(_BOUNDED, "boundaries").setup()
    rings, safety = setup.gains.rings, setup.gains.safety
    return Findings(
        (
            Measurement("Reactive boundary R, from the surface", rings.reactive_margin, "m", "outside Q",
                        rings.reactive_margin > rings.repulsive_margin),
            Measurement("Repulsive boundary Q, from the surface", rings.repulsive_margin, "m",
                        "outside the safety barrier, else only the filter would ever see it",
                        rings.repulsive_margin > safety.obstacle_clearance),
            Measurement("Safety barrier, from the surface", safety.obstacle_clearance, "m",
                        "the paper gives no numbers", None),
        ),
        (Picture("boundaries", "Reactive boundary R (outer) and repulsive boundary Q (inner) of a circle and a bar"
                               " (paper, Fig. 3). Robots react between them and only circulate inside Q.",
                 lambda: _draw_boundaries(setup)),),
    )  # fmt: skip


def _draw_boundaries(setup: Setup) -> Figure:
    figure = new_figure(PAGE, 4.1)
    axes = figure.subplots()
    dress_map(axes, setup.arena, 50.0)
    draw_path(axes, setup.start.intent.path)
    draw_obstacles(axes, setup.world)
    draw_rings(axes, setup.world, setup.gains)
    for words, at, ink in (
        ("reactive boundary R", (-85.0, 79.0), INK.reactive), ("repulsive boundary Q", (-85.0, 48.0), INK.repulsive),
        ("desired path P", (-18.0, 5.0), INK.path),
    ):  # fmt: skip
        axes.text(*at, words, color=ink, ha="center", va="bottom", fontsize=7.5)
    return figure


def draw_rings(axes: Axes, world: World, gains: Gains) -> None:
    """R and Q of every circle and bar."""
    spines = [(x, y, x, y, radius) for x, y, radius in world.circles.tolist()] + world.bars.tolist()
    for ax, ay, bx, by, radius in spines:
        for margin, ink in (
            (gains.rings.reactive_margin, INK.reactive), (gains.rings.repulsive_margin, INK.repulsive),
        ):  # fmt: skip
            ring(axes, capsule(ax, ay, bx, by, radius + margin), ink)


class _Panels:
    """The five fields of Fig. 5 on one grid, each a row a point (G, 2), unit vectors at most."""

    def __init__(self, setup: Setup, columns: int) -> None:
        state, world, gains = setup.start, setup.world, setup.gains
        speed = gains.blending.cruise_speed
        self.cell = setup.arena.width / columns
        self.points = grid_points(setup.arena, columns)
        self.path = field_at(FieldKind.PATH, self.points, state, world, gains) / speed
        circle = world.circles[0]
        away = self.points - circle[:2]
        self.bump = np.array([zero_in(float(np.hypot(*p)), float(circle[2]), gains.rings, gains.forms) for p in away])
        normal = np.array([part_at(0, x, y, world)[1:] for x, y in self.points.tolist()])
        self.around = floats(np.stack([normal[:, 1], -normal[:, 0]], axis=1))  # side E n, clockwise
        side = ints([[-1]])
        self.outside = np.hypot(*away.T) > circle[2]
        self.sum = self.bump[:, None] * self.path + (1.0 - self.bump)[:, None] * self.around
        agreed = state._replace(motion=state.motion._replace(side=side))
        self.engine = field_at(FieldKind.COMPOSITE, self.points, agreed, world, gains) / speed


def run_composite(_: Runs) -> Findings:
    """The five panels of Fig. 5, and the field that the engine makes of them."""
    setup = parse_scenario(_CROSSED, "composite").setup()
    panels = _Panels(setup, 30)
    outside = panels.bump == 1.0
    apart = np.hypot(*(panels.engine - panels.path).T)
    return Findings(
        (
            within("Outside R: largest difference between composite and path field", float(apart[outside].max()), "",
                   0.0, 1e-9, "0: outside R only the path counts"),
            within("Inside Q: largest share of the path field", float(panels.bump[_inside_q(panels, setup)].max()), "",
                   0.0, 0.0, "0: inside Q only the obstacle counts"),
            within("Length of the circulating field", float(np.hypot(*panels.around.T).mean()), "", 0.999, 1.001, "1"),
        ),
        (
            Picture("composite", "How the composite field is made (paper, Fig. 5). Colours as in the paper: red outside"
                                 " R, green inside Q, blue between.", lambda: _draw_composite(setup)),
            Picture("composite-engine", "The field that robots feel: obstacles turn only what heads into them, so a"
                                        " robot behind the obstacle is not pulled round it again.",
                    lambda: _draw_engine(setup)),
        ),
        notes=("The engine applies the composite step once, to the blended velocity of each robot, and only to what"
               " heads into a ring; the first five panels are the printed sum, the last one is the engine's. X_R here circulates"
               " at right angles to the surface's normal; that the team does not enter Q is the safety filter's task.",),
    )  # fmt: skip


def _inside_q(panels: _Panels, setup: Setup) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    circle = setup.world.circles[0]
    return np.hypot(*(panels.points - circle[:2]).T) <= circle[2] + setup.gains.rings.repulsive_margin


def _draw_composite(setup: Setup) -> Figure:
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
        ((0, slice(2, 4)), r"(b) $\hat{X}_R$: round the obstacle", panels.around, INK.reactive),
        ((1, slice(0, 2)), r"(c) $S\,\hat{X}_P$: zero-in", panels.bump[:, None] * panels.path, INK.fire),
        ((1, slice(2, 4)), r"(d) $Z\,\hat{X}_R$: zero-out", zero_out * panels.around, INK.reactive),
        ((2, slice(1, 3)), r"(e) $S\,\hat{X}_P + Z\,\hat{X}_R$: composite", panels.sum, zone),
    ]
    for (row, columns), title, field, ink in shown:
        axes = figure.add_subplot(grid[row, columns])
        _dress_panel(axes, setup, title)
        inked = ink if isinstance(ink, str) else [c for c, out in zip(ink, panels.outside, strict=True) if out]
        draw_arrows(axes, panels.points[panels.outside], field[panels.outside], panels.cell, inked)
    return figure


def _draw_engine(setup: Setup) -> Figure:
    panels = _Panels(setup, 36)
    figure = new_figure(PAGE * 0.75, 3.6)
    axes = figure.subplots()
    _dress_panel(axes, setup, "")
    draw_arrows(axes, panels.points[panels.outside], panels.engine[panels.outside], panels.cell, INK.ours)
    return figure


def _dress_panel(axes: Axes, setup: Setup, title: str) -> None:
    dress_map(axes, setup.arena, 50.0)
    axes.set_title(title)
    draw_path(axes, setup.start.intent.path)
    draw_obstacles(axes, setup.world)
    draw_rings(axes, setup.world, setup.gains)


CASES = (
    Case("gvf", "The guiding vector field", "Fig. 2: a field that leads to a circle and along it.",
         "The engine's guiding vector [2] on a grid, and field lines by small steps along it.", run_gvf),
    Case("bumps", "Zero-in and zero-out bump functions", "Fig. 4 and equations [5], [6], [29]-[31].",
         "The engine's bump across a ring, and the printed formula in squared pixels beside it.", run_bumps),
    Case("boundaries", "Reactive and repulsive boundaries", "Fig. 3: R and Q round a circle and a bar.",
         "The engine's rings of a circle and a bar.", run_boundaries),
    Case("composite", "The composite vector field", "Fig. 5: path field and boundary field, blended by the bumps.",
         "The engine's path field, circulation and bump on a grid, multiplied and added as the panels say.",
         run_composite),
)  # fmt: skip
