"""A small line chart as SVG: crisp at any size, and the same whether its tab was hidden or not."""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_console.core.numbers import grouped
from higvf_console.ui.scene.shapes import tick_spacing, ticks
from higvf_console.ui.widgets.html import text

WIDTH, HEIGHT = 316, 152  # [CSS px]
_LEFT, _RIGHT, _TOP, _BOTTOM = 48, 8, 26, 20
MOST_POINTS = 200  # of a curve


class Curve(NamedTuple):
    """A named line.

    Attributes:
        name: in the legend.
        x: (n,).
        y: (n,).
        colour: as CSS has it.
        dashed: whether it is drawn in dashes.
    """

    name: str
    x: Floats
    y: Floats
    colour: str
    dashed: bool = False


def chart_svg(curves: list[Curve], x_unit: str, y_unit: str) -> str:
    """The curves over common axes from zero, with a legend above; a dot marks the end of those drawn through."""
    x_max, y_max = _limit([curve.x for curve in curves]), _limit([curve.y for curve in curves])
    right, bottom = WIDTH - _RIGHT, HEIGHT - _BOTTOM
    scale = np.array([(right - _LEFT) / x_max, -(bottom - _TOP) / y_max])
    parts = [_axes(x_max, y_max, scale, x_unit, y_unit)]
    for curve in curves:
        points = np.array([_LEFT, bottom]) + _thinned(np.stack([curve.x, curve.y], axis=1)) * scale
        parts.append(_line(curve, points))
    legend, pen = [], _LEFT
    for curve in curves:
        dash = ' stroke-dasharray="4 3"' if curve.dashed else ""
        legend.append(  # pyright: ignore[reportUnknownMemberType]
            f'<path d="M{pen} 8h18" stroke="{curve.colour}" stroke-width="2"{dash}/>'
            f'<text x="{pen + 23}" y="12">{text(curve.name)}</text>'
        )
        pen += 40 + round(6.3 * len(curve.name))
    return (
        f'<svg class="chart" viewBox="0 0 {WIDTH} {HEIGHT}" width="100%" role="img" fill="none">'
        f"{''.join(parts)}{''.join(legend)}</svg>"  # pyright: ignore[reportUnknownArgumentType]
    )


def _axes(x_max: float, y_max: float, scale: Floats, x_unit: str, y_unit: str) -> str:
    bottom = HEIGHT - _BOTTOM
    xs, ys = ticks(0.0, x_max, tick_spacing(x_max, 6)), ticks(0.0, y_max, tick_spacing(y_max, 4))
    parts: list[str] = []
    for y in ys:
        level = bottom + y * scale[1]
        parts.append(
            f'<path class="rule" d="M{_LEFT} {level:.1f}H{WIDTH - _RIGHT}"/>'
            f'<text x="{_LEFT - 6}" y="{level + 4:.1f}" text-anchor="end">{_number(y)}</text>'
        )
    parts.append(f'<text x="{_LEFT - 6}" y="12" text-anchor="end">{text(y_unit)}</text>')
    for x in xs:
        label = _number(x) + (f" {text(x_unit)}" if x == xs[-1] else "")
        parts.append(f'<text x="{_LEFT + x * scale[0]:.1f}" y="{bottom + 15}" text-anchor="middle">{label}</text>')
    return "".join(parts)


def _line(curve: Curve, points: Floats) -> str:
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dash = ' stroke-dasharray="5 4"' if curve.dashed else ""
    width = 1.5 if curve.dashed else 2
    line = f'<polyline points="{path}" stroke="{curve.colour}" stroke-width="{width}"{dash}/>'
    if curve.dashed or not len(points):
        return line
    return line + f'<circle cx="{points[-1, 0]:.1f}" cy="{points[-1, 1]:.1f}" r="3.5" fill="{curve.colour}"/>'


def _limit(values: list[Floats]) -> float:
    """The largest value with a little room above it; 1 where there is none."""
    most = max((float(value.max(initial=0.0)) for value in values), default=0.0)
    return 1.06 * most if most > 0.0 and math.isfinite(most) else 1.0


def _thinned(points: Floats) -> Floats:
    if len(points) <= MOST_POINTS:
        return points
    return points[np.linspace(0, len(points) - 1, MOST_POINTS).astype(np.int64)]


def _number(value: float) -> str:
    return grouped(value) if value >= 1000 else f"{value + 0.0:g}"
