"""Charts: a quantity over time, and bars of loss areas beside those of the paper."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.arrays import Floats
from higvf_console.lab.reproduce.figures.canvas import INK, PAGE, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def over_time(axes: "Axes", time: Floats, values: Floats, ink: str, label: str | None = None) -> None:
    """Plots one line over session time [s]."""
    axes.plot(time[::3], values[::3], color=ink, linewidth=1.2, label=label)
    axes.set_xlim(float(time[0]), float(time[-1]))
    axes.set_xlabel("time [s]")
    axes.grid(visible=True, axis="y")


def loss_bars(axes: "Axes", ours: Sequence[float], paper: Sequence[float], title: str) -> None:
    """Draws bars of the loss area of each fire, given in m^2, beside those of the paper."""
    place = np.arange(len(ours))
    axes.bar(place - 0.2, np.array(paper) / 1e3, 0.38, color=INK.paper, label="paper")
    bars = axes.bar(place + 0.2, np.array(ours) / 1e3, 0.38, color=INK.ours, label="reproduction")
    axes.bar_label(bars, [f"{value / 1e3:.1f}" for value in ours], fontsize=6.0, padding=1.5, color=INK.ours)
    axes.set_xticks(place, [f"fire {fire + 1}" for fire in place])
    axes.set_ylabel("loss area [1000 m²]")
    axes.set_title(title)
    axes.grid(visible=True, axis="y")
    axes.margins(y=0.12)


def table_2_bars(columns: Mapping[str, tuple[Sequence[float], Sequence[float]]]) -> "Figure":
    """One panel per column of Table II on a common scale; `columns` maps its title to (reproduction, paper)."""
    figure = new_figure(PAGE, 2.5)
    panels = figure.subplots(1, len(columns), sharey=True)
    for axes, (title, (ours, paper)) in zip(panels, columns.items(), strict=True):
        loss_bars(axes, ours, paper, title)
        axes.set_xticks(range(5), [f"{fire}" for fire in range(1, 6)])
        axes.set_xlabel("fire")
        axes.label_outer()
    panels[0].legend(loc="upper left")
    return figure
