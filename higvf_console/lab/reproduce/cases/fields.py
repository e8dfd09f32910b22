"""Vector fields without simulation: guiding field, bump functions, boundaries."""

import math
from typing import TYPE_CHECKING

import numpy as np

from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.guidance.bump import zero_in
from higvf_console.control.guidance.guiding import guiding_vector
from higvf_console.control.guidance.paths import EVERYWHERE, circle_path
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import floats
from higvf_console.core.state import World
from higvf_console.core.viewport import Arena
from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Picture, within
from higvf_console.lab.reproduce.figures.arrows import draw_arrows, grid_points
from higvf_console.lab.reproduce.figures.canvas import INK, PAGE, dress_map, new_figure
from higvf_console.lab.reproduce.figures.maps import boundary, capsule, draw_obstacles, draw_path
from higvf_console.lab.reproduce.runs import Runs
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.world.setup import Setup

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PARAMETERS = Parameters()
CORRECTED, PIXELS = Forms(), Forms(bump=PRINTED)
ARENA = Arena(-200.0, -200.0, 200.0, 200.0)
CIRCLE = circle_path(0.0, 0.0, 120.0)
OBSTACLE_RADIUS = 20.0  # of the obstacle of the bump functions [m]
WIDE = "boundaries: {reactive_margin: 45, repulsive_margin: 14}"
_BOUNDED = f"""
version: 1
arena: {{x_min: -180, y_min: -100, x_max: 180, y_max: 100, walls: false}}
robots: {{start_m: [[-170, -90]]}}
obstacles:
  circles: [{{at_m: [-85, 0], radius_m: 30}}]
  bars: [{{from_m: [60, -40], to_m: [110, 40], half_width_m: 8}}]
path: {{line: {{at_m: [-180, 0], angle_deg: 0}}}}
parameters: {{{WIDE}}}
"""


def run_gvf(_: Runs) -> Findings:
    """Evaluates the guiding vector field of a circle and integrates its field lines."""
    radii = np.array([15.0, 60.0, 119.0, 180.0, 250.0])
    ends = [_end_radius(float(radius)) for radius in radii]
    on_path = guiding_vector(CIRCLE, 0.0, EVERYWHERE, 120.0, 0.0, PARAMETERS.path)
    at_centre = guiding_vector(CIRCLE, 0.0, EVERYWHERE, 0.0, 0.0, PARAMETERS.path)
    capture = guiding_vector(CIRCLE, 0.0, EVERYWHERE, 120.0 + PARAMETERS.path.capture_distance, 0.0, PARAMETERS.path)
    turned = math.degrees(math.atan2(-capture[0], capture[1]))
    return Findings(
        (
            within(
                "Largest final distance to the circle of five field lines that start 15 to 250 m from its centre",
                float(np.abs(np.array(ends) - 120.0).max()),
                "m",
                0.0,
                0.1,
                "0: the field leads to the path",
            ),
            within(
                "Angle between field and path on the path",
                math.degrees(math.atan2(-on_path[0], on_path[1])),
                "°",
                -1e-6,
                1e-6,
                "0: tangential on the path",
            ),
            within("The same angle at one capture distance 1/k from the path", turned, "°", 45 - 1e-6, 45 + 1e-6, "45"),
            within(
                "Length of the field at the centre, where the gradient vanishes",
                math.hypot(*at_centre),
                "",
                1 - 1e-9,
                1 + 1e-9,
                "1: the field is defined everywhere (printed: 0)",
            ),
        ),
        (
            Picture(
                "gvf",
                "The guiding vector field of a circle (paper, Fig. 3): tangential on the path, orthogonal far"
                " away. The arrows show the field of the engine.",
                _draw_gvf,
            ),
        ),
        notes=(
            "The signed distance in units of the capture distance replaces the level set in squared pixels, for which"
            " the tangential part is significant only within 0.002 px of the path.",
        ),
    )


def _end_radius(radius: float) -> float:
    x, y = radius, 0.0
    for _ in range(4000):
        vx, vy = guiding_vector(CIRCLE, 0.0, EVERYWHERE, x, y, PARAMETERS.path)
        x, y = x + 0.2 * vx, y + 0.2 * vy
    return math.hypot(x, y)


def _draw_gvf() -> "Figure":
    figure = new_figure(4.2, 4.1)
    axes = figure.subplots()
    dress_map(axes, ARENA)
    points = grid_points(ARENA, 21)
    field = floats([guiding_vector(CIRCLE, 0.0, EVERYWHERE, x, y, PARAMETERS.path) for x, y in points.tolist()])
    draw_path(axes, CIRCLE)
    draw_arrows(axes, points, field, ARENA.width / 21, INK.ours)
    return figure


def run_bumps(_: Runs) -> Findings:
    """S and Z between the boundaries: smooth in the dimensionless form, a jump in the printed one."""
    boundaries = PARAMETERS.boundaries
    start = OBSTACLE_RADIUS + boundaries.repulsive_margin
    printed = _printed(start + 0.01)
    smooth = zero_in(start + 0.01, OBSTACLE_RADIUS, boundaries, CORRECTED)
    distance = np.linspace(start, OBSTACLE_RADIUS + boundaries.reactive_margin, 20001)
    bump = np.array([zero_in(d, OBSTACLE_RADIUS, boundaries, CORRECTED) for d in distance.tolist()])
    rise = distance[np.searchsorted(bump, 0.99)] - distance[np.searchsorted(bump, 0.01)]
    return Findings(
        (
            within(
                "S as printed at 0.01 px outside the repulsive boundary",
                printed,
                "",
                0.4,
                0.5,
                "0.47: S jumps from 0 within 0.01 px",
            ),
            within("S as corrected at the same point", smooth, "", 0.0, 1e-6, "0: smooth"),
            within(
                "Width over which the corrected S rises from 1 % to 99 %",
                float(rise),
                "m",
                2.0,
                math.inf,
                "most of the 11 m between the boundaries",
            ),
            within(
                "Largest |S + Z - 1|",
                0.0 if bump.min() >= 0.0 and bump.max() <= 1.0 else 1.0,
                "",
                0.0,
                0.0,
                "0: Z = 1 - S",
            ),
        ),
        (
            Picture(
                "bumps",
                "Zero-in S (solid) and zero-out Z (dashed) between the boundaries of an obstacle of radius"
                " 20 m (paper, Fig. 5): dimensionless as in the engine (left), in px² as printed (right).",
                _draw_bumps,
            ),
        ),
    )


def _printed(distance: float) -> float:
    return zero_in(distance, OBSTACLE_RADIUS, PARAMETERS.boundaries, PIXELS)


def _draw_bumps() -> "Figure":
    boundaries = PARAMETERS.boundaries
    figure = new_figure(PAGE, 2.5)
    panels = figure.subplots(1, 2, sharey=True)
    distance = np.linspace(OBSTACLE_RADIUS + 10.0, OBSTACLE_RADIUS + 29.0, 1901)
    shapes = (
        ("Dimensionless, as run", [zero_in(d, OBSTACLE_RADIUS, boundaries, CORRECTED) for d in distance.tolist()]),
        ("Squared pixels, as printed", [_printed(d) for d in distance.tolist()]),
    )
    for axes, (title, values) in zip(panels, shapes, strict=True):
        bump = np.array(values)
        axes.plot(distance - OBSTACLE_RADIUS, bump, color=INK.ours, linewidth=1.6, label="S, zero-in")
        axes.plot(
            distance - OBSTACLE_RADIUS,
            1.0 - bump,
            color=INK.fire,
            linewidth=1.4,
            linestyle=(0, (4, 2)),
            label="Z, zero-out",
        )
        for margin, ink, word in (
            (boundaries.repulsive_margin, INK.repulsive, "Q"),
            (boundaries.reactive_margin, INK.reactive, "R"),
        ):
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
    boundaries, safety = setup.params.boundaries, setup.params.safety
    return Findings(
        (
            Measurement(
                "Reactive boundary R, from the surface",
                boundaries.reactive_margin,
                "m",
                "outside Q",
                boundaries.reactive_margin > boundaries.repulsive_margin,
            ),
            Measurement(
                "Repulsive boundary Q, from the surface",
                boundaries.repulsive_margin,
                "m",
                "outside the safety clearance, else robots would never reach it",
                boundaries.repulsive_margin > safety.obstacle_clearance,
            ),
            Measurement(
                "Safety clearance, from the surface", safety.obstacle_clearance, "m", "the paper gives no numbers", None
            ),
        ),
        (
            Picture(
                "boundaries",
                "Reactive boundary R (outer) and repulsive boundary Q (inner) of a circle and a bar"
                " (paper, Fig. 4). Robots start to turn inside R and only circulate inside Q.",
                lambda: _draw_boundaries(setup),
            ),
        ),
    )


def _draw_boundaries(setup: Setup) -> "Figure":
    figure = new_figure(PAGE, 4.1)
    axes = figure.subplots()
    dress_map(axes, setup.arena, 50.0)
    draw_path(axes, setup.start.intent.path)
    draw_obstacles(axes, setup.world)
    draw_obstacle_boundaries(axes, setup.world, setup.params)
    for label, at, ink in (
        ("reactive boundary R", (-85.0, 79.0), INK.reactive),
        ("repulsive boundary Q", (-85.0, 48.0), INK.repulsive),
        ("desired path P", (-18.0, 5.0), INK.path),
    ):
        axes.text(*at, label, color=ink, ha="center", va="bottom", fontsize=7.5)
    return figure


def draw_obstacle_boundaries(axes: "Axes", world: World, params: Parameters) -> None:
    """Draws R and Q of every circle and bar."""
    spines = [(x, y, x, y, radius) for x, y, radius in world.circles.tolist()] + world.bars.tolist()
    for ax, ay, bx, by, radius in spines:
        for margin, ink in (
            (params.boundaries.reactive_margin, INK.reactive),
            (params.boundaries.repulsive_margin, INK.repulsive),
        ):
            boundary(axes, capsule(ax, ay, bx, by, radius + margin), ink)


CASES = (
    Case(
        "gvf",
        "The guiding vector field",
        "Fig. 3: a field that leads to a circle and along it.",
        "The guiding vector [2] of the engine on a grid, and field lines integrated with small steps.",
        run_gvf,
    ),
    Case(
        "bumps",
        "Zero-in and zero-out bump functions",
        "Fig. 5 and equations [5], [6], [29]-[31].",
        "The bump of the engine between the boundaries, beside the printed formula in squared pixels.",
        run_bumps,
    ),
    Case(
        "boundaries",
        "Reactive and repulsive boundaries",
        "Fig. 4: R and Q round a circle and a bar.",
        "The boundaries of a circle and a bar in the engine.",
        run_boundaries,
    ),
)
