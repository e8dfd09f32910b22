"""A small picture of a scenario as SVG, drawn from its layout: the same bytes for the same scenario."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from higvf_console.control.guidance.paths import path_points
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.state import PathKind
from higvf_console.scenario.scenario import Scenario
from higvf_console.ui.theme import CSS
from higvf_console.world.polygons import obstacles_of

WIDTH = 190.0  # of the picture [CSS px]; what it shows keeps its proportions
MOST_ROBOTS = 150  # that are drawn; of more, every so many-th
_ROBOT_PX = 3.2  # radius of a robot
_LEAST_PX = 1.5  # radius below which nothing is drawn smaller
_POINTS = 60  # of a path
_ToPicture: TypeAlias = Callable[[Floats], Floats]


def scenario_svg(scenario: Scenario) -> str:
    """Arena, obstacles, path, fires and robots at the start, north up."""
    arena = scenario.arena
    scale = WIDTH / arena.width
    height = arena.height * scale

    def at(points: Floats) -> Floats:
        return (points - [arena.x_min, arena.y_max]) * [scale, -scale]

    parts = [f'<rect width="{WIDTH:g}" height="{height:.1f}" fill="{CSS.floor}" stroke="{CSS.border}"/>']
    parts += _obstacles(scenario, at, scale)
    if scenario.path.kind != PathKind.NONE:
        parts.append(_path(scenario, at))
    for fire in scenario.fires:
        x, y = at(floats([fire.position]))[0]
        parts.append(_disc(x, y, max(fire.radius * scale, 2.5), CSS.fire))
    robots = at(scenario.robots.points)
    every = -(-len(robots) // MOST_ROBOTS)
    radius = _ROBOT_PX if every == 1 else _LEAST_PX
    parts += [_disc(x, y, radius, CSS.robot) for x, y in robots[::every].tolist()]
    return f'<svg viewBox="0 0 {WIDTH:g} {height:.1f}" role="img" aria-hidden="true">{"".join(parts)}</svg>'


def _obstacles(scenario: Scenario, at: _ToPicture, scale: float) -> list[str]:
    obstacles = scenario.obstacles
    parts = list[str]()
    for x, y, radius in obstacles.circles.tolist():
        x1, y1 = at(floats([[x, y]]))[0].tolist()
        parts.append(_disc(x1, y1, max(radius * scale, _LEAST_PX), CSS.obstacle_edge))
    for ax, ay, bx, by, half_width in obstacles.bars.tolist():
        (x1, y1), (x2, y2) = at(floats([[ax, ay], [bx, by]])).tolist()
        width = max(2.0 * half_width * scale, 2.0 * _LEAST_PX)
        parts.append(
            f'<path d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" stroke="{CSS.obstacle_edge}" stroke-width="{width:.1f}" '
            'stroke-linecap="round"/>'
        )
    for chains in obstacles_of(obstacles.polygons):
        outline = "".join(f"M{_line(at(chain))}Z" for chain in chains)
        parts.append(f'<path d="{outline}" fill="{CSS.obstacle_edge}" fill-rule="evenodd"/>')
    return parts


def _path(scenario: Scenario, at: _ToPicture) -> str:
    path, arena = scenario.path, scenario.arena
    length = path.length if np.isfinite(path.length) else arena.width + arena.height
    start = 0.0 if np.isfinite(path.length) else -length
    points = at(path_points(path, floats(np.linspace(start, length, _POINTS))))
    return f'<path d="M{_line(points)}" fill="none" stroke="{CSS.operator}" stroke-width="1.8"/>'


def _line(points: Floats) -> str:
    return "L".join(f"{x:.1f} {y:.1f}" for x, y in points.tolist())


def _disc(x: float, y: float, radius: float, colour: str) -> str:
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="{colour}"/>'
