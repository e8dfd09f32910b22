"""Following a circle: from inside, from outside, with a changed influenced robot, and past obstacles."""

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.arrays import Bools, Floats
from higvf_console.lab.reproduce import measures
from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Picture, within
from higvf_console.lab.reproduce.figures import maps
from higvf_console.lab.reproduce.figures.canvas import INK, PAGE, map_figure, new_figure, robot_ink
from higvf_console.lab.reproduce.figures.charts import over_time
from higvf_console.lab.reproduce.runs import Run, Runs, RunSpec

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BAND = 5.0  # distance within which a robot is on the path [m]
FORMATION_SHARE = 0.25  # largest RMS error of the formation distances, as a share of their mean
INSIDE = RunSpec("circle-inside-corrected")
OUTSIDE = (RunSpec("circle-outside-corrected"), RunSpec("circle-outside"), RunSpec("circle-inside"))
CHANGE = RunSpec("circle-inside-corrected", "change-robot")
OBSTACLES = RunSpec("circle-obstacles")
IRREGULAR = RunSpec("circle-irregular")


def specs() -> tuple[RunSpec, ...]:
    """All runs of these cases."""
    return (INSIDE, *OUTSIDE, CHANGE, OBSTACLES, IRREGULAR)


def run_inside(runs: Runs) -> Findings:
    """From inside: the corrected centre, for which the starts do lie inside."""
    run = runs.get(INSIDE)
    return Findings(_following(run), (_picture(run, "circle-inside", "from inside"),), (run,))


def run_outside(runs: Runs) -> Findings:
    """From outside: the corrected centre, and the published centre with both starts."""
    made = [runs.get(spec) for spec in OUTSIDE]
    names = ("corrected centre", "published centre, second start", "published centre, first start")
    measured = [
        m._replace(what=f"{name}: {m.what}") for run, name in zip(made, names, strict=True) for m in _following(run)
    ]
    return Findings(
        tuple(measured),
        tuple(
            _picture(run, f"circle-outside-{k + 1}", name)
            for k, (run, name) in enumerate(zip(made, names, strict=True))
        ),
        tuple(made),
        notes=(
            "The circle about the published centre (250, 300) contains none of the six start positions, although the"
            " paper places three of them inside. Both centres are run.",
        ),
    )


def run_change(runs: Runs) -> Findings:
    """Changes the influenced robot twice during the run."""
    run = runs.get(CHANGE)
    changes = np.flatnonzero(np.diff(run.influenced)) + 1
    path, error = run.paths[0].path, measures.path_distance(run.paths[0].path, measures.leader_track(run))
    ends = [*changes[1:].tolist(), len(run.time)]
    measured = [Measurement("Changes of the influenced robot", len(changes), "", "2", len(changes) == 2)]
    for change, end in zip(changes.tolist(), ends, strict=True):
        took = measures.settled_at(run.time[change:end], error[change:end], BAND) - float(run.time[change])
        robot = int(run.influenced[change]) + 1
        measured.append(
            within(
                f"Time until robot {robot} stays within {BAND:g} m of the path",
                took,
                "s",
                0.0,
                10.0,
                "short: the whole team responds",
            )
        )
    measured += [
        within(
            "Laps of the team's centre",
            measures.laps(path, run.position.mean(axis=1)),
            "",
            2.0,
            math.inf,
            "the team keeps following the path",
        ),
        _formation_measure(run),
        _clearance_measure(run),
    ]
    switched = [float(run.time[k]) for k in changes]
    return Findings(
        tuple(measured),
        (
            Picture(
                "circle-change",
                "The influenced robot is changed twice (paper, Fig. 9b), at the diamond marks.",
                lambda: _draw_change(run, switched),
            ),
            Picture(
                "circle-change-error",
                "Distance of each robot from the path; the influenced robot in full colour. The picked"
                " robot moves onto the path, and the team moves with it.",
                lambda: _draw_errors(run, switched),
            ),
        ),
        (run,),
    )


def run_obstacles(runs: Runs) -> Findings:
    """Past two circles and a bar on the path."""
    return _past_obstacles(runs.get(OBSTACLES), "circle-obstacles")


def run_irregular(runs: Runs) -> Findings:
    """Past irregular obstacles on the path."""
    return _past_obstacles(runs.get(IRREGULAR), "circle-irregular")


def _past_obstacles(run: Run, name: str) -> Findings:
    path = run.paths[0].path
    error = measures.path_distance(path, measures.leader_track(run))
    arrived = int(np.argmax(error <= BAND))
    away = measures.intervals(error[arrived:] > BAND)
    longest = max([run.time[b] - run.time[a] for a, b in away], default=0.0)
    half_lap = 0.5 * path.length / run.setup.params.blending.cruise_speed
    return Findings(
        (
            _clearance_measure(run),
            within(
                "Laps of the team's centre",
                measures.laps(path, run.position.mean(axis=1)),
                "",
                2.0,
                math.inf,
                "the team keeps circling",
            ),
            Measurement(
                "Excursions of the influenced robot from the path by more than 5 m",
                len(away),
                "",
                "at least one, followed by a return",
                bool(away) and bool(error[arrived:].min() < BAND),
            ),
            within("Longest excursion", float(longest), "s", 0.0, half_lap, "temporary: less than half a lap"),
            within(
                "Share of the time on the path after reaching it",
                float((error[arrived:] <= BAND).mean()),
                "",
                0.5,
                1.0,
                "more than half",
            ),
            _deadlock_measure(run),
        ),
        (
            _picture(run, name, "past obstacles"),
            Picture(
                f"{name}-error",
                "Distance of the influenced robot from the path: it leaves the path at each obstacle and returns.",
                lambda: _draw_errors(run, []),
            ),
        ),
        (run,),
        notes=("The paper does not give the positions of its obstacles; these are the project's own.",),
    )


def _following(run: Run) -> tuple[Measurement, ...]:
    """Measures of following a circle: arrival, distance, laps, formation, clearance."""
    path = run.paths[0].path
    error = measures.path_distance(path, measures.leader_track(run))
    settled = measures.settled_at(run.time, error, BAND)
    stays = error[run.time >= settled + 5.0]
    return (
        within(
            f"Time until the influenced robot stays within {BAND:g} m of the path",
            settled,
            "s",
            0.0,
            40.0,
            "the robot reaches the path",
        ),
        within(
            "Its largest distance from the path, from 5 s later",
            float(stays.max()) if len(stays) else math.inf,
            "m",
            0.0,
            BAND,
            "the robot follows the path",
        ),
        within(
            "Laps of the team's centre",
            measures.laps(path, run.position.mean(axis=1)),
            "",
            1.0,
            math.inf,
            "at least one, in the direction of the path",
        ),
        _formation_measure(run),
        _clearance_measure(run),
    )


def _formation_measure(run: Run) -> Measurement:
    later = measures.formation_error(run)[run.time >= run.time[-1] / 2]
    share = float(np.sqrt(np.mean(later**2))) / measures.formation_size(run)
    return within(
        "RMS error of the formation distances in the second half, as a share of their mean",
        share,
        "",
        0.0,
        FORMATION_SHARE,
        "the others keep moving in formation",
    )


def _clearance_measure(run: Run) -> Measurement:
    return within("Minimum clearance", measures.smallest_clearance(run), "m", 0.0, math.inf, "never negative")


def _deadlock_measure(run: Run) -> Measurement:
    return within("Time in deadlock", float(run.report["deadlock_s"]), "s", 0.0, 0.0, "0")


def _picture(run: Run, name: str, words: str) -> Picture:
    caption = f"Tracks {words} (paper, Fig. 9). Open marks: start; filled marks: end; thin lines: links at the"
    return Picture(name, f"{caption} times shown.", lambda: draw_following(run))


def draw_following(
    run: Run, times: Sequence[float] | None = None, also: "Callable[[Axes], None] | None" = None
) -> "Figure":
    """Draws the map of a run with desired paths, tracks and the formation at some times.

    Args:
        run: run to draw.
        times: times of the formations [s]; None = round times of the first lap.
        also: draws further elements on the axes.
    """
    figure, axes = map_figure(maps.frame_of(run))
    for given in run.paths:
        maps.draw_path(axes, given.path, "desired path")
    maps.draw_obstacles(axes, run.setup.world)
    maps.draw_tracks(axes, run)
    shown = maps.time_marks(run, 9) if times is None else list(times)
    shown = shown[:5] if times is None else shown
    maps.draw_formations(axes, run, [0.0, *shown])
    if also is not None:
        also(axes)
    maps.draw_times(axes, run, shown)
    maps.legend_below(axes)
    return figure


def _draw_change(run: Run, switched: Sequence[float]) -> "Figure":
    def mark(axes: "Axes") -> None:
        for time in switched:
            k = run.index_at(time)
            robot = int(run.influenced[k])
            axes.plot(
                *run.position[k, robot], "D", color=robot_ink(robot), markeredgecolor="white", markersize=7.5, zorder=9
            )

    return draw_following(run, [*switched, *[time + 3.0 for time in switched]], mark)


def _draw_errors(run: Run, switched: Sequence[float]) -> "Figure":
    figure = new_figure(PAGE, 2.2)
    axes = figure.subplots()
    path = run.paths[0].path
    for robot in range(run.position.shape[1]):
        error = measures.path_distance(path, run.position[:, robot])
        axes.plot(run.time[::3], error[::3], color=robot_ink(robot), linewidth=0.8, alpha=0.35)
        over_time(axes, run.time, _masked(error, run.influenced == robot), robot_ink(robot), f"robot {robot + 1}")
    for time in switched:
        axes.axvline(time, color=INK.quiet, linewidth=0.8, linestyle=":")
    axes.set_ylabel("distance from the path [m]")
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper right", ncols=3)
    return figure


def _masked(values: Floats, shown: Bools) -> Floats:
    return np.where(shown, values, np.nan)


_PAPER = "Simulation 1, Fig. 9"
CASES = (
    Case(
        "circle-inside",
        "Following a circle from inside",
        f"{_PAPER}(a): the influenced robot follows the circle; the others keep the formation.",
        "Scenario circle-inside-corrected, 90 s.",
        run_inside,
    ),
    Case(
        "circle-outside",
        "Following a circle from outside",
        f"{_PAPER}(a): the same from outside.",
        "Scenarios circle-outside-corrected, circle-outside and circle-inside (published centre), 90 s each.",
        run_outside,
    ),
    Case(
        "circle-change",
        "Changing the influenced robot",
        f"{_PAPER}(b): the operator can pick any robot, and the team keeps following the path.",
        "Scenario circle-inside-corrected with the script change-robot: two picks during the run.",
        run_change,
    ),
    Case(
        "circle-obstacles",
        "Following a circle past obstacles",
        f"{_PAPER}(c): robots leave the path at obstacles and return to it.",
        "Scenario circle-obstacles: two circles and a bar on the path, 120 s.",
        run_obstacles,
    ),
    Case(
        "circle-irregular",
        "Following a circle past irregular obstacles",
        f"{_PAPER}(c): obstacles can be irregularly shaped.",
        "Scenario circle-irregular: an L, a U and a star on the path, 120 s.",
        run_irregular,
    ),
)
