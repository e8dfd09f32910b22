"""Simulations of the two physical experiments; positions are the project's own, since the paper gives none."""

import math
from typing import TYPE_CHECKING

import numpy as np

from higvf_console.control.guidance.paths import WINDOW
from higvf_console.core.scale import BODY_RADIUS
from higvf_console.core.state import PathStatus
from higvf_console.lab.reproduce import measures
from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Picture, within
from higvf_console.lab.reproduce.figures import maps
from higvf_console.lab.reproduce.figures.canvas import INK, PAGE, map_figure, new_figure
from higvf_console.lab.reproduce.figures.charts import over_time
from higvf_console.lab.reproduce.runs import Run, Runs, RunSpec

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PATROL = RunSpec("physical-1")
GAZE = RunSpec("barrier-gaze", demo=True)
GAZE_ALONE = RunSpec("barrier-gaze")
SPECS = (PATROL, GAZE, GAZE_ALONE)
_BAND = 10.0  # distance within which a robot is on a sketched path [m]


def run_patrol(runs: Runs) -> Findings:
    """Case 1: the team leaves a given path for targets that it finds, and returns to the path."""
    run = runs.get(PATROL)
    away = measures.intervals(run.path_status == PathStatus.BREAK_AWAY)
    w, last = run.path_parameter, len(run.time) - 1
    kept = [float(np.ptp(w[a : b + 1])) for a, b in away]
    joined = [abs(float(w[min(b + 1, last)] - w[b])) for _, b in away]
    back = [_time_back(run, b) for _, b in away]
    finished = bool((run.path_status == PathStatus.FINISHED).any())
    return Findings(
        (
            Measurement(
                "Order of the targets",
                _words(run),
                "",
                "1-2-3: two found on the way, one at the end of the path",
                _words(run) == "1-2-3",
            ),
            Measurement(
                "Number of break-aways from the path",
                len(away),
                "",
                "2: the third target is below the threshold",
                len(away) == 2,
            ),
            within(
                "Largest change of the path parameter w during a break-away",
                max(kept, default=math.nan),
                "m",
                0.0,
                0.0,
                "0: w is kept",
            ),
            within(
                "Largest distance along the path between the kept w and the point of return",
                max(joined, default=math.nan),
                "m",
                0.0,
                WINDOW * BODY_RADIUS,
                "within the search window: the team skips no part of the path",
            ),
            within(
                "Longest time until the influenced robot is back on the path",
                max(back, default=math.nan),
                "s",
                0.0,
                20.0,
                "the robots are guided back to the given path",
            ),
            Measurement("The path is finished", "yes" if finished else "no", "", "yes", finished),
            within(
                "Minimum clearance",
                measures.smallest_clearance(run),
                "m",
                0.0,
                math.inf,
                "never negative, although the path crosses barriers",
            ),
            within("Time in deadlock", run.report["deadlock_s"], "s", 0.0, 1.0, "at most 1 s"),
        ),
        (
            Picture(
                "physical-1",
                "Physical case 1 (paper, Figs. 11 and 12): the given path crosses barriers; thick"
                " parts of the track of robot 1 are break-aways to a target.",
                lambda: _draw_patrol(run, away),
            ),
            Picture(
                "physical-1-w",
                "The path parameter w is kept during a break-away and continues afterwards.",
                lambda: _draw_parameter(run, away),
            ),
        ),
        (run,),
        notes=("The perception range is 150 m. Positions, path and threshold are the project's own.",),
    )


def _time_back(run: Run, end: int) -> float:
    path = run.paths[-1].path
    error = measures.path_distance(path, measures.leader_track(run)[end:])
    on_path = np.flatnonzero(error <= _BAND)
    return float(run.time[end + on_path[0]] - run.time[end]) if len(on_path) else math.inf


def _draw_patrol(run: Run, away: list[tuple[int, int]]) -> "Figure":
    figure, axes = map_figure(maps.frame_of(run), PAGE)
    maps.draw_fires(axes, run, measures.order(run))
    maps.draw_obstacles(axes, run.setup.world)
    for given in run.paths:
        maps.draw_path(axes, given.path, "given path")
    maps.draw_tracks(axes, run)
    for first, last in away:
        robot = int(run.influenced[first])
        axes.plot(
            *run.position[first : last + 1 : 3, robot].T,
            color=INK.fire,
            linewidth=2.6,
            alpha=0.8,
            zorder=4.5,
            label="break-away",
        )
    times = maps.time_marks(run, 9)
    maps.draw_formations(axes, run, [0.0, *times])
    maps.draw_times(axes, run, times)
    maps.legend_below(axes)
    return figure


def _draw_parameter(run: Run, away: list[tuple[int, int]]) -> "Figure":
    figure = new_figure(PAGE, 2.0)
    axes = figure.subplots()
    over_time(axes, run.time, run.path_parameter, INK.ours)
    _shade(axes, run, away, "break-away")
    axes.set_ylabel("w [m]")
    axes.legend(loc="upper left")
    return figure


def _shade(axes: "Axes", run: Run, intervals: list[tuple[int, int]], label: str) -> None:
    for number, (first, last) in enumerate(intervals):
        axes.axvspan(
            float(run.time[first]),
            float(run.time[last]),
            color=INK.fire,
            alpha=0.15,
            linewidth=0,
            label=label if number == 0 else None,
        )


def run_gaze(runs: Runs) -> Findings:
    """Case 2: pause by EMG, path by gaze, robot by BCI, resume."""
    run, alone = runs.get(GAZE), runs.get(GAZE_ALONE)
    paused = measures.intervals(run.paused)
    speed = np.hypot(run.velocity[..., 0], run.velocity[..., 1]).max(axis=1)
    stands = max((float(speed[a + 2 : b].max()) for a, b in paused if b - a > 2), default=math.nan)
    kinds = [entry["kind"] for entry in run.report["commands"]]
    sources = sorted({entry["source"] for entry in run.report["commands"]})
    less = 100.0 * (run.report["loss_area_total_m2"] / alone.report["loss_area_total_m2"] - 1.0)
    steps = [kinds.index(kind) if kind in kinds else -1 for kind in ("Pause", "StrokeBegin", "StrokeEnd", "Resume")]
    return Findings(
        (
            Measurement(
                "Order without the operator",
                _words(alone),
                "",
                "2-1-3: the barrier hides target 3",
                _words(alone) == "2-1-3",
            ),
            Measurement("Order with the operator", _words(run), "", "2-3-1", _words(run) == "2-3-1"),
            Measurement(
                "Sequence of commands",
                " ".join(kinds),
                "",
                "pause, path and pick, resume",
                -1 not in steps and steps == sorted(steps) and "Pick" in kinds,
            ),
            Measurement(
                "Devices",
                ", ".join(sources),
                "",
                "gaze, EMG and BCI only",
                sources == ["bci", "emg", "gaze"],
            ),
            within(
                "Fastest robot while paused", stands, "m/s", 0.0, 5.0, "about 0: robots only yield to a growing fire"
            ),
            Measurement("Change of the total loss area", round(less, 1), "%", "negative: less area burns", less < 0.0),
            within("Minimum clearance", measures.smallest_clearance(run), "m", 0.0, math.inf, "never negative"),
        ),
        (
            Picture(
                "physical-2",
                "Physical case 2 (paper, Figs. 14 to 16) with the operator: paused at the crosses; the"
                " gaze path leads the team round the barrier to target 3.",
                lambda: _draw_gaze(run, paused),
            ),
            Picture(
                "physical-2-alone", "The same world without the operator: order 2-1-3.", lambda: _draw_gaze(alone, [])
            ),
        ),
        (run, alone),
        notes=("The inputs are synthetic recordings of the project; the positions are its own as well.",),
    )


def _words(run: Run) -> str:
    return "-".join(map(str, measures.order(run)))


def _draw_gaze(run: Run, paused: list[tuple[int, int]]) -> "Figure":
    figure, axes = map_figure(maps.frame_of(run), PAGE * 0.85)
    maps.draw_fires(axes, run, measures.order(run))
    maps.draw_obstacles(axes, run.setup.world)
    for given in run.paths:
        maps.draw_path(axes, given.path, "gaze path")
    maps.draw_tracks(axes, run)
    for first, _ in paused:
        for robot in range(run.position.shape[1]):
            axes.plot(
                *run.position[first, robot],
                "X",
                color=INK.text,
                markeredgecolor="white",
                markersize=6.5,
                zorder=9,
                label="paused here",
            )
    times = [float(t) for t in sorted(measures.extinguished_at(run)) if np.isfinite(t)]
    maps.draw_formations(axes, run, [0.0, *times])
    maps.draw_times(axes, run, times)
    maps.legend_below(axes)
    return figure


CASES = (
    Case(
        "physical-1",
        "Physical case 1: a given path, targets on the way",
        "Figs. 11 and 12: with limited perception, robots"
        " leave a given path that crosses barriers for a target that they find, and return to the path.",
        "Scenario physical-1, headless.",
        run_patrol,
    ),
    Case(
        "physical-2",
        "Physical case 2: pause by EMG, path by gaze, robot by BCI",
        "Figs. 14 to 16: the order without the operator is"
        " 2-1-3. With a pause by EMG, a path by gaze and a robot picked by BCI, target 3 comes before target 1.",
        "Scenario barrier-gaze with its recorded inputs (--demo) and without them.",
        run_gaze,
    ),
)
