"""Elements of a map: obstacles, fires, desired paths, tracks with time marks, formations at some times."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from higvf_console.control.guidance.paths import path_points
from higvf_console.core.arrays import Floats
from higvf_console.core.optional import optional
from higvf_console.core.state import Path, PathKind, World
from higvf_console.core.viewport import Arena
from higvf_console.lab.reproduce.figures.canvas import INK, nice_step, robot_ink
from higvf_console.lab.reproduce.runs import Run

if TYPE_CHECKING:
    from matplotlib import patches, patheffects
    from matplotlib import path as mpl_path
    from matplotlib.axes import Axes
else:
    patches, mpl_path = optional("matplotlib.patches", "report"), optional("matplotlib.path", "report")
    patheffects = optional("matplotlib.patheffects", "report")

_CORNER = 24  # points of each end of a capsule
_ROOMY = 38.0  # radius of a fire that has room for its label [m]


def frame_of(run: Run, margin: float = 40.0) -> Arena:
    """The smallest frame that contains tracks, desired paths, fires and obstacles, plus a margin [m]."""
    world = run.setup.world
    parts = [run.position.reshape(-1, 2), world.bars[:, 0:2], world.bars[:, 2:4]]
    for at, radius in (
        (world.circles[:, :2], world.circles[:, 2:]),
        (world.fire_position, run.fire_radius[-1][:, None]),
    ):
        parts += [at - radius, at + radius]
    parts += [path_points(given.path, np.linspace(0.0, given.path.length, 100)) for given in run.paths]
    points = np.vstack(parts)
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    if run.scenario.walls:
        arena = run.setup.arena
        low, high = np.maximum(low, (arena.x_min, arena.y_min)), np.minimum(high, (arena.x_max, arena.y_max))
    return Arena(float(low[0]), float(low[1]), float(high[0]), float(high[1]))


def draw_obstacles(axes: "Axes", world: World) -> None:
    """Draws circles, bars and irregular obstacles."""
    look: dict[str, Any] = {
        "facecolor": INK.obstacle, "edgecolor": INK.obstacle_edge, "linewidth": 0.6, "zorder": 2,
    }  # fmt: skip
    for x, y, radius in world.circles.tolist():
        axes.add_patch(patches.Circle((x, y), radius, **look))
    for bar in world.bars[world.bars[:, 4] > 0.0]:
        axes.add_patch(patches.Polygon(capsule(*bar.tolist()), **look))
    for corners in outlines(world):
        axes.add_patch(patches.Polygon(corners, **look))


def outlines(world: World) -> list[Floats]:
    """Corners (n, 2) [m] of the irregular obstacles, which a world stores as closed chains of bars of zero width."""
    found: list[Floats] = []
    chain: list[list[float]] = []
    for ax, ay, bx, by, _ in world.bars[world.bars[:, 4] == 0.0].tolist():
        chain.append([ax, ay])
        if [bx, by] == chain[0]:
            found.append(np.array(chain))
            chain = []
    return found


def capsule(ax: float, ay: float, bx: float, by: float, radius: float) -> Floats:
    """The outline (n, 2) [m] of a capsule."""
    angle = math.atan2(by - ay, bx - ax)
    turn = np.linspace(-math.pi / 2, math.pi / 2, _CORNER) + angle
    cap = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return np.vstack([cap + np.array([bx, by]), np.array([ax, ay]) - cap])


def draw_path(axes: "Axes", path: Path, label: str | None = None) -> None:
    """Draws a desired path."""
    length = path.length if path.kind != PathKind.LINE else 3000.0
    points = path_points(path, np.linspace(0.0, length, 400))
    axes.plot(*points.T, color=INK.path, linewidth=3.0, alpha=0.55, zorder=1.5, solid_capstyle="round", label=label)


def draw_tracks(axes: "Axes", run: Run, first: int = 0, last: int | None = None) -> None:
    """Draws the track of each robot, with an open mark at its start and a filled mark at its end."""
    stop = len(run.time) if last is None else last + 1
    for robot in range(run.position.shape[1]):
        track, ink = run.position[first:stop, robot], robot_ink(robot)
        axes.plot(*track[::5].T, color=ink, linewidth=1.2, zorder=4, label=f"robot {robot + 1}")
        axes.plot(*track[0], "o", color="white", markeredgecolor=ink, markeredgewidth=1.2, markersize=4.5, zorder=6)
        axes.plot(*track[-1], "o", color=ink, markersize=4.5, zorder=6)


def draw_formations(axes: "Axes", run: Run, times: Sequence[float]) -> None:
    """Draws the robots and their links at some times [s]."""
    for time in times:
        k = run.index_at(time)
        for i, j in run.links[k].tolist():
            axes.plot(*run.position[k, [i, j]].T, color=INK.link, linewidth=0.7, zorder=3)
        for robot in range(run.position.shape[1]):
            axes.plot(*run.position[k, robot], ".", color=robot_ink(robot), markersize=3.5, zorder=5)


def draw_fires(axes: "Axes", run: Run, order: Sequence[int]) -> None:
    """Draws fires at their largest radius, the initial radius dotted, with number and rank in the order."""
    final, start = run.fire_radius[-1], run.fire_radius[0]
    for fire, (x, y) in enumerate(run.setup.world.fire_position.tolist()):
        radius = float(final[fire])
        axes.add_patch(patches.Circle((x, y), radius, facecolor=INK.fire, alpha=0.16, edgecolor="none", zorder=1))
        axes.add_patch(patches.Circle((x, y), radius, fill=False, edgecolor=INK.fire, linewidth=0.8, zorder=2.5))
        axes.add_patch(
            patches.Circle(
                (x, y), start[fire], fill=False, edgecolor=INK.fire, linewidth=0.7, linestyle=":", zorder=2.5
            )
        )
        place = _ordinal(order.index(fire + 1) + 1) if fire + 1 in order else "burning"
        at = (x, y) if radius >= _ROOMY else _beside(axes, run, np.array([x, y]), radius)
        axes.text(
            *at, f"fire {fire + 1}\n{place}", ha="center", va="center", fontsize=7, color="#8a3d00", zorder=7,
            linespacing=1.1, path_effects=[patheffects.withStroke(linewidth=2.2, foreground="white", alpha=0.85)],
        )  # fmt: skip


def _beside(axes: "Axes", run: Run, centre: Floats, radius: float) -> tuple[float, float]:
    """Position of the label of a small fire: beside it, as far as possible from all tracks."""
    width = axes.get_xlim()[1] - axes.get_xlim()[0]
    angles = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
    spots = centre + (radius + 0.03 * width) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    busy = run.position[::10].reshape(-1, 2)
    gaps = [float(np.hypot(*((busy - spot) / (1.4, 1.0)).T).min()) for spot in spots]
    x, y = spots[int(np.argmax(gaps))].tolist()
    return x, y


def _ordinal(place: int) -> str:
    return f"{place}{ {1: 'st', 2: 'nd', 3: 'rd'}.get(place, 'th') }"


def time_marks(run: Run, most: int = 8, start: float = 0.0) -> list[float]:
    """At most `most` round times after `start` [s], not too near the end of the run."""
    end = float(run.time[-1])
    step = nice_step(end - start, most)
    return [t for t in np.arange(math.ceil(start / step) * step, end - 0.3 * step, step).tolist() if t > 0.0]


def draw_times(axes: "Axes", run: Run, times: Sequence[float]) -> None:
    """Writes times beside the team, each where it is farthest from tracks, fires and other labels."""
    busy = np.vstack([run.position[::10].reshape(-1, 2), *_occupied(run)])
    low, high = np.array([axes.get_xlim()[0], axes.get_ylim()[0]]), np.array([axes.get_xlim()[1], axes.get_ylim()[1]])
    reach = 0.035 * float((high - low).max())
    angles = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
    for time in times:
        team = run.position[run.index_at(time)]
        spots = [
            robot + factor * reach * np.array([math.cos(a), math.sin(a)])
            for robot in team for factor in (0.8, 1.1, 1.5) for a in angles
        ]  # fmt: skip
        inside = [spot for spot in spots if ((spot > low + reach) & (spot < high - reach)).all()] or spots
        gaps = [float(np.hypot(*((busy - spot) / (1.6, 1.0)).T).min()) for spot in inside]
        near = [
            min(gap, reach) - 0.12 * float(np.hypot(*(team - spot).T).min())
            for gap, spot in zip(gaps, inside, strict=True)
        ]
        spot = inside[int(np.argmax(near))]
        owner = team[int(np.argmin(np.hypot(*(team - spot).T)))]
        axes.plot(*np.array([owner, spot]).T, color=INK.quiet, linewidth=0.5, zorder=3)
        x, y = spot.tolist()
        axes.text(
            x, y, f"{time:.0f} s", ha="center", va="center", fontsize=6.5, color=INK.quiet, zorder=8,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
        )  # fmt: skip
        label = spot + np.array([(dx, 0.0) for dx in (-0.8 * reach, 0.0, 0.8 * reach)])
        busy = np.vstack([busy, label])


def _occupied(run: Run) -> list[Floats]:
    """Points (n, 2) [m] that cover each fire, circle and bar, where no label may be placed."""
    world = run.setup.world
    discs = [*np.c_[world.fire_position, run.fire_radius[-1]].tolist(), *world.circles.tolist()]
    turn = np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False)
    unit = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    spines = [np.linspace(bar[:2], bar[2:4], 12) for bar in world.bars]
    return [
        *(np.array([x, y]) + share * radius * unit for x, y, radius in discs for share in (0.3, 0.65, 1.0)),
        *spines,
    ]


def legend_below(axes: "Axes", columns: int = 6) -> None:
    """Draws the legend below the map, with each entry once."""
    handles, labels = axes.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    axes.legend(
        once.values(), once.keys(), loc="upper center", bbox_to_anchor=(0.5, -0.09), ncols=columns, columnspacing=1.4
    )


def boundary(axes: "Axes", outline: Floats, colour: str, label: str | None = None) -> None:
    """Draws a closed dashed boundary (n, 2) [m]."""
    closed = mpl_path.Path(np.vstack([outline, outline[:1]]))
    axes.add_patch(
        patches.PathPatch(
            closed, fill=False, edgecolor=colour, linewidth=1.1, linestyle=(0, (4, 2)), zorder=3, label=label
        )
    )
