"""What does not move: floor, metre grid with axes and scale bar, obstacles with their boundaries."""

from itertools import pairwise

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.viewport import Arena
from higvf_console.ui.scene import shapes
from higvf_console.ui.scene.glyphs import Triangles, lettering, merged
from higvf_console.ui.scene.parts import Canvas, Layer, Lines
from higvf_console.ui.theme import NOMINAL, cap_height
from higvf_console.world.polygons import obstacles_of
from higvf_console.world.setup import Setup

MARGIN_PX = (34.0, 30.0, 14.0, 14.0)  # for the lettering: left, bottom, right, top
_SCALE_BELOW = 31.0  # the x axis [px]


class Ground:
    """Draws once; the boundaries can be hidden."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Draws everything."""
        arena, px, ink = canvas.arena, canvas.px, canvas.palette
        floor = shapes.rectangle(*arena)
        canvas.mesh(Layer.FLOOR, "/ground/floor", shapes.filled(floor), ink.floor)
        spacing = shapes.tick_spacing(max(arena.width, arena.height), 13)
        canvas.lines(Layer.GRID, "/ground/grid", ink.grid, 1.0).draw(grid(arena, spacing))
        canvas.lines(Layer.GRID, "/ground/border", ink.border, 1.5).draw(shapes.segments(floor))
        letters = axis_lettering(arena, spacing, px, canvas.sizes.axis_text)
        canvas.mesh(Layer.GRID, "/ground/axes", letters, ink.axis_text)
        canvas.lines(Layer.GRID, "/ground/scale", ink.axis_text, 1.5).draw(scale_bar(arena, spacing, px))
        canvas.mesh(Layer.OBSTACLE, "/ground/obstacles", obstacle_bodies(setup), ink.obstacle)
        canvas.lines(Layer.OBSTACLE, "/ground/obstacle_edges", ink.obstacle_edge, NOMINAL.outline).draw(
            joined([shapes.segments(surface) for surface in obstacle_surfaces(setup)])
        )
        self._boundaries = boundaries(canvas, setup)

    def show_boundaries(self, visible: bool) -> None:
        """Shows or hides reactive and repulsive boundaries."""
        for lines in self._boundaries:
            lines.show(visible)


def boundaries(canvas: Canvas, setup: Setup) -> list[Lines]:
    """Reactive boundary R dashed, repulsive boundary Q drawn through."""
    margins, seen, colour = setup.params.boundaries, setup.arena, canvas.palette.boundary
    reactive = canvas.lines(Layer.BOUNDARY, "/ground/reactive", colour, NOMINAL.boundary)
    dash = 5 * canvas.px
    dashes = joined([shapes.dashed(o, dash, dash) for o in obstacle_outlines(setup, margins.reactive_margin)])
    reactive.draw(shapes.clipped(dashes, *seen))
    repulsive = canvas.lines(Layer.BOUNDARY, "/ground/repulsive", colour, NOMINAL.boundary)
    lines = joined([shapes.segments(o) for o in obstacle_outlines(setup, margins.repulsive_margin)])
    repulsive.draw(shapes.clipped(lines, *seen))
    return [reactive, repulsive]


def obstacle_outlines(setup: Setup, margin: float) -> list[Floats]:
    """Closed outlines (n, 2), `margin` [m] away from what robots go round: lone parts, and the hulls of groups."""
    world = setup.world
    starts = world.boundary_start[0]
    hulls = [world.hull[first:last] for first, last in pairwise(starts)]
    return [
        shapes.inflated(hull, margin)
        if len(hull)
        else shapes.capsule(boundary[:2], boundary[2:4], boundary[4] + margin)
        for boundary, hull in zip(world.boundary, hulls, strict=True)
    ]


def obstacle_surfaces(setup: Setup) -> list[Floats]:
    """Closed outlines (n, 2) of every obstacle itself, and of the free areas that polygons enclose."""
    return _round_outlines(setup, 0.0) + [shapes.closed(chain) for chain in setup.layout.obstacles.polygons]


def obstacle_bodies(setup: Setup) -> Triangles:
    """What the obstacles cover."""
    polygons = [shapes.filled_between(chains) for chains in obstacles_of(setup.layout.obstacles.polygons)]
    return merged([*(shapes.filled(outline) for outline in _round_outlines(setup, 0.0)), *polygons])


def _round_outlines(setup: Setup, margin: float) -> list[Floats]:
    """Of circles and bars that stand still; `movers` draws the others."""
    obstacles = setup.layout.obstacles.still()
    circles = [shapes.circle(x, y, radius + margin) for x, y, radius in obstacles.circles]
    return circles + [shapes.capsule(bar[:2], bar[2:4], bar[4] + margin) for bar in obstacles.bars]


def joined(pieces: list[Floats]) -> Floats:
    """Several sets of segments (s, 2, 2) as one."""
    return np.concatenate(pieces) if pieces else floats([], 0, 2, 2)


def with_margin(arena: Arena, px: float) -> Arena:
    """The arena and the room that its lettering needs: what the camera must show."""
    left, bottom, right, top = (side * px for side in MARGIN_PX)
    return Arena(arena.x_min - left, arena.y_min - bottom, arena.x_max + right, arena.y_max + top)


def grid(arena: Arena, spacing: float) -> Floats:
    """Grid lines (s, 2, 2) at the multiples of `spacing` [m]."""
    xs, ys = shapes.ticks(arena.x_min, arena.x_max, spacing), shapes.ticks(arena.y_min, arena.y_max, spacing)
    upright = [[[x, arena.y_min], [x, arena.y_max]] for x in xs]
    level = [[[arena.x_min, y], [arena.x_max, y]] for y in ys]
    return floats(upright + level, -1, 2, 2)


def axis_lettering(arena: Arena, spacing: float, px: float, text: float = NOMINAL.axis_text) -> Triangles:
    """The numbers along both axes, the last with its unit, and the scale bar's length."""
    size, gap = cap_height(text) * px, 8 * px
    below, beside = arena.y_min - gap - size / 2, arena.x_min - gap
    xs, ys = shapes.ticks(arena.x_min, arena.x_max, spacing), shapes.ticks(arena.y_min, arena.y_max, spacing)
    texts = [lettering(_number(x) + _unit(x, xs), x, below, size) for x in xs]
    texts += [lettering(_number(y) + _unit(y, ys), beside, y, size, anchor=1.0) for y in ys]
    texts.append(lettering("x", arena.x_max + gap, arena.y_min, size, anchor=0.0))
    texts.append(lettering("y", arena.x_min, arena.y_max + gap + size / 2, size))
    texts.append(lettering(f"{_number(spacing)} m", arena.x_max - spacing / 2, arena.y_min - _SCALE_BELOW * px, size))
    return merged(texts)


def scale_bar(arena: Arena, spacing: float, px: float) -> Floats:
    """A bar of one grid spacing with end ticks, below the right end of the x axis, its lettering in its middle."""
    right, y, tick, room = arena.x_max, arena.y_min - _SCALE_BELOW * px, 3 * px, 27 * px
    left, middle = right - spacing, right - spacing / 2
    bar = [[[left, y], [middle - room, y]], [[middle + room, y], [right, y]]] if spacing > 2.5 * room else []
    ends = [[[x, y - tick], [x, y + tick]] for x in (left, right)]
    return floats(bar + ends, -1, 2, 2)


def _number(value: float) -> str:
    return f"{value + 0.0:.6g}"  # + 0.0: never "-0"


def _unit(value: float, values: Floats) -> str:
    return " m" if value == values[-1] else ""
