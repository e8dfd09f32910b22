"""Vector fields on a grid, drawn as arrows."""

from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.viewport import Arena

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def grid_points(arena: Arena, columns: int) -> Floats:
    """Points (G, 2) [m] of a square grid with `columns` over the width, half a cell from the edges."""
    cell = arena.width / columns
    rows = max(1, round(arena.height / cell))
    x = arena.x_min + cell * (np.arange(columns) + 0.5)
    y = arena.y_min + arena.height * (np.arange(rows) + 0.5) / rows
    return floats(np.stack(np.meshgrid(x, y), axis=-1), -1, 2)


def draw_arrows(axes: "Axes", points: Floats, vectors: Floats, cell: float, ink: str | list[str]) -> None:
    """Draws vectors (G, 2) as arrows; a unit vector is 0.8 cells long, and vectors below 0.02 are omitted."""
    seen = np.hypot(vectors[:, 0], vectors[:, 1]) > 0.02
    colours = ink if isinstance(ink, str) else [colour for colour, shown in zip(ink, seen, strict=True) if shown]
    axes.quiver(
        *points[seen].T, *(0.8 * cell * vectors[seen]).T, color=colours, angles="xy", scale_units="xy", scale=1.0,
        pivot="mid", width=0.1 * cell, units="xy", headwidth=4.0, headlength=4.5, headaxislength=4.0, zorder=4,
    )  # fmt: skip
