"""The common style of all figures: palette (Okabe-Ito), line widths, font sizes, axes in metres."""

import io
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from higvf_console.core.optional import optional
from higvf_console.core.viewport import Arena

if TYPE_CHECKING:
    import matplotlib as mpl
    from matplotlib import figure as figures
    from matplotlib import ticker
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
else:
    mpl, figures = optional("matplotlib", "report"), optional("matplotlib.figure", "report")
    ticker = optional("matplotlib.ticker", "report")


class Inks(NamedTuple):
    """Colours for a white background, distinguishable with colour blindness; grey for static objects."""

    text: str = "#222222"
    quiet: str = "#6b7280"
    grid: str = "#e5e7eb"
    obstacle: str = "#9aa1ab"
    obstacle_edge: str = "#4b5563"
    path: str = "#cc79a7"
    fire: str = "#d55e00"
    reactive: str = "#009e73"
    repulsive: str = "#aa4499"
    link: str = "#8f98a3"
    good: str = "#009e73"
    bad: str = "#d55e00"
    paper: str = "#b6bcc6"
    ours: str = "#0072b2"


INK = Inks()
ROBOTS = ("#0072b2", "#e69f00", "#009e73", "#56b4e9", "#8c510a", "#332288")
PAGE = 6.9  # width of a full-page figure [in]
_HIGHEST = 4.6  # maximum height of a map [in]
_STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 5.0,
    "axes.labelsize": 8.0,
    "axes.labelcolor": INK.text,
    "axes.edgecolor": INK.quiet,
    "axes.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK.text,
    "xtick.color": INK.quiet,
    "ytick.color": INK.quiet,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "grid.color": INK.grid,
    "grid.linewidth": 0.5,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.hashsalt": "higvf",
    "figure.constrained_layout.use": True,
}


@contextmanager
def style() -> Generator[None]:
    """Applies the common style to everything drawn or saved within the context."""
    with mpl.rc_context(_STYLE):
        yield


def new_figure(width: float, height: float) -> "Figure":
    """An empty figure of `width` x `height` [in] without a window."""
    return figures.Figure(figsize=(width, height))


def map_figure(frame: Arena, width: float = PAGE) -> "tuple[Figure, Axes]":
    """A figure with one map and its legend.

    Args:
        frame: part of the plane to show [m]; the height of the figure follows from it.
        width: maximum width [in]; a high frame gives a narrower figure.
    """
    width = min(width, 0.55 + _HIGHEST * frame.width / frame.height)
    figure = new_figure(width, (width - 0.55) * frame.height / frame.width + 0.75)
    axes = figure.subplots()
    dress_map(axes, frame)
    return figure, axes


def dress_map(axes: "Axes", arena: Arena, step: float = 100.0) -> None:
    """Formats map axes: equal aspect, metres on both axes, a light grid with lines every `step` [m]."""
    axes.set_aspect("equal")
    axes.set_xlim(arena.x_min, arena.x_max)
    axes.set_ylim(arena.y_min, arena.y_max)
    axes.xaxis.set_major_locator(ticker.MultipleLocator(step))
    axes.yaxis.set_major_locator(ticker.MultipleLocator(step))
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.grid(visible=True)
    for edge in ("top", "right"):
        axes.spines[edge].set_visible(True)
    for spine in axes.spines.values():
        spine.set_color(INK.grid)


def robot_ink(robot: int) -> str:
    """Colour of a robot."""
    return ROBOTS[robot % len(ROBOTS)]


def rendered(draw: "Callable[[], Figure]", *endings: str) -> dict[str, bytes]:
    """Contents of the files of a figure, by suffix ("svg", "png"); the same figure gives the same bytes."""
    files: dict[str, bytes] = {}
    with style():
        figure = draw()
        for ending in endings:
            buffer = io.BytesIO()
            metadata = {"Date": None} if ending == "svg" else {"Software": None}
            figure.savefig(buffer, format=ending, dpi=200, metadata=metadata)
            files[ending] = buffer.getvalue()
    return files


def nice_step(span: float, most: int) -> float:
    """The smallest of 1, 2 or 5 times a power of ten that divides `span` into at most `most` parts."""
    raw = span / most
    power = 10.0 ** np.floor(np.log10(raw))
    return float(next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= raw))
