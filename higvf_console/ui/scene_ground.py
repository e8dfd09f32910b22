"""What does not move: floor, metre grid with axes and scale bar, obstacles with their boundaries."""

import numpy as np

from higvf_console.arrays import Floats, floats
from higvf_console.control.gains import RingGains
from higvf_console.sim.setup import Setup
from higvf_console.state import World
from higvf_console.ui import shapes
from higvf_console.ui.glyphs import Triangles, lettering, merged
from higvf_console.ui.scene_parts import Canvas, Layer, Lines
from higvf_console.ui.theme import DARK, NOMINAL, cap_height
from higvf_console.viewport import Arena

MARGIN_PX = (34.0, 30.0, 14.0, 14.0)  # for the lettering: left, bottom, right, top
_SCALE_BELOW = 31.0  # the x axis [px]


class Ground:
    """Draws once; the boundaries can be hidden."""

    def __init__(self, canvas: Canvas, setup: Setup) -> None:
        """Draws everything."""
        arena, px = canvas.arena, canvas.px
        floor = shapes.rectangle(*arena)
        canvas.mesh(Layer.FLOOR, "/ground/floor", shapes.filled(floor), DARK.floor)
        spacing = shapes.tick_spacing(max(arena.width, arena.height), 13)
        canvas.lines(Layer.GRID, "/ground/grid", DARK.grid, 1.0).draw(grid(arena, spacing))
        canvas.lines(Layer.GRID, "/ground/border", DARK.border, 1.5).draw(shapes.segments(floor))
        canvas.mesh(Layer.GRID, "/ground/axes", axis_lettering(arena, spacing, px), DARK.axis_text)
        canvas.lines(Layer.GRID, "/ground/scale", DARK.axis_text, 1.5).draw(scale_bar(arena, spacing, px))
        surfaces = [outline for outline, _ in obstacle_outlines(setup.world, 0.0)]
        canvas.mesh(Layer.OBSTACLE, "/ground/obstacles", merged([shapes.filled(s) for s in surfaces]), DARK.obstacle)
        canvas.lines(Layer.OBSTACLE, "/ground/obstacle_edges", DARK.obstacle_edge, NOMINAL.outline).draw(
            joined([shapes.segments(surface) for surface in surfaces])
        )
        self._boundaries = boundaries(canvas, setup.world, setup.gains.rings)

    def show_boundaries(self, visible: bool) -> None:
        """Shows or hides reactive and repulsive boundaries."""
        for lines in self._boundaries:
            lines.show(visible)


def boundaries(canvas: Canvas, world: World, rings: RingGains) -> list[Lines]:
    """Reactive boundary R dashed, repulsive boundary Q drawn through."""
    reactive = canvas.lines(Layer.BOUNDARY, "/ground/reactive", DARK.boundary, NOMINAL.boundary)
    dash = 5 * canvas.px
    reactive.draw(joined([shapes.dashed(o, dash, dash) for o, _ in obstacle_outlines(world, rings.reactive_margin)]))
    repulsive = canvas.lines(Layer.BOUNDARY, "/ground/repulsive", DARK.boundary, NOMINAL.boundary)
    repulsive.draw(joined([shapes.segments(o) for o, _ in obstacle_outlines(world, rings.repulsive_margin)]))
    return [reactive, repulsive]


def obstacle_outlines(world: World, margin: float) -> list[tuple[Floats, Floats]]:
    """Closed outline (n, 2) and centre (2,) of every circle and bar, `margin` [m] away from its surface."""
    found = [(shapes.circle(x, y, radius + margin), floats([x, y])) for x, y, radius in world.circles]
    for ax, ay, bx, by, half_width in world.bars:
        a, b = floats([ax, ay]), floats([bx, by])
        found.append((shapes.capsule(a, b, half_width + margin), (a + b) / 2))
    return found


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


def axis_lettering(arena: Arena, spacing: float, px: float) -> Triangles:
    """The numbers along both axes, the last with its unit, and the scale bar's length."""
    size, gap = cap_height(NOMINAL.axis_text) * px, 8 * px
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
