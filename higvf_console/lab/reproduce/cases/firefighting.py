"""Firefighting in the world of Table I: without a human, with a changed priority, with a hidden fire found."""

from typing import TYPE_CHECKING

import numpy as np

from higvf_console.core.numbers import grouped
from higvf_console.lab.fit.table2 import SCENARIO, STROKES
from higvf_console.lab.reproduce import measures
from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Picture, Table, within
from higvf_console.lab.reproduce.figures import maps
from higvf_console.lab.reproduce.figures.canvas import PAGE, map_figure, new_figure
from higvf_console.lab.reproduce.figures.charts import loss_bars
from higvf_console.lab.reproduce.paper import COLUMNS, Column
from higvf_console.lab.reproduce.runs import Run, Runs, RunSpec

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def specs(scenario: str) -> dict[str, RunSpec]:
    """The runs of the three columns of Table II in a scenario."""
    return {name: RunSpec(scenario, STROKES[name].script if name in STROKES else None) for name in COLUMNS}


SPECS = specs(SCENARIO)
_PICTURES = {"without_human": "fire-alone", "change_priority": "fire-priority", "find_hidden": "fire-hidden"}


def run_alone(runs: Runs) -> Findings:
    """Runs the team without a human."""
    return _findings(runs, "without_human")


def run_priority(runs: Runs) -> Findings:
    """Runs with a stroke past obstacle 1, from where the team sees the full size of fire 3."""
    return _findings(runs, "change_priority")


def run_hidden(runs: Runs) -> Findings:
    """Runs with a stroke round the bar to fire 5."""
    return _findings(runs, "find_hidden")


def _findings(runs: Runs, name: str) -> Findings:
    run, column = runs.get(SPECS[name]), COLUMNS[name]
    measured = [
        Measurement(
            "Order in which the fires go out",
            _words(measures.order(run)),
            "",
            _words(column.order),
            measures.order(run) == column.order,
        ),
        Measurement(
            "Total loss area",
            round(sum(run.report["loss_area_m2"]), 1),
            "m²",
            f"{grouped(column.total, 1)} (paper)",
            None,
        ),
        within("Minimum clearance", measures.smallest_clearance(run), "m", 0.0, np.inf, "never negative"),
        within("Time in deadlock", run.report["deadlock_s"], "s", 0.0, 1.0, "at most 1 s"),
        Measurement("Time until the last fire is out", run.report["duration_s"], "s", "not given", None),
    ]
    made = [run]
    if name != "without_human":
        alone = runs.get(SPECS["without_human"])
        made.append(alone)
        measured += _against(run, alone, column)
    return Findings(
        tuple(measured),
        (
            Picture(
                _PICTURES[name],
                f"{column.title} (paper, Fig. 10). Fires at their largest radius, the initial radius"
                " dotted, with the order in which they went out.",
                lambda: draw_firefighting(run),
            ),
            Picture(
                f"{_PICTURES[name]}-loss",
                "Loss area of each fire beside that of the paper.",
                lambda: _draw_loss(run, column),
            ),
        ),
        tuple(made[:1]),
        (_loss_table(run, column),),
    )


def _against(run: Run, alone: Run, column: Column) -> list[Measurement]:
    ours, base = np.array(run.report["loss_area_m2"]), np.array(alone.report["loss_area_m2"])
    paper, paper_base = np.array(column.loss_area), np.array(COLUMNS["without_human"].loss_area)
    change = 100.0 * (ours.sum() / base.sum() - 1.0)
    measured = [
        Measurement(
            "Change of the total loss area against the run without a human",
            round(float(change), 2),
            "%",
            f"{100.0 * (paper.sum() / paper_base.sum() - 1.0):+.1f} (paper)",
            bool(change < 0.0),
        ),
    ]
    signs = [(_sign(ours[k] - base[k]), _sign(paper[k] - paper_base[k])) for k in range(len(ours))]
    here, there = (", ".join(f"{k + 1} {pair[which]}" for k, pair in enumerate(signs)) for which in (0, 1))
    return [*measured, Measurement("Change of each fire's loss area", here, "", there, here == there)]


def _sign(change: float) -> str:
    return "equal" if abs(change) < 1.0 else "up" if change > 0.0 else "down"


def _words(order: tuple[int, ...]) -> str:
    return "-".join(map(str, order))


def _loss_table(run: Run, column: Column) -> Table:
    rows = [
        (f"a(s{k + 1})", grouped(ours, 1), grouped(paper, 1), f"{100.0 * (ours / paper - 1.0):+.1f} %")
        for k, (ours, paper) in enumerate(zip(run.report["loss_area_m2"], column.loss_area, strict=True))
    ]
    total, paper = sum(run.report["loss_area_m2"]), sum(column.loss_area)
    rows.append(("Sum", grouped(total, 1), grouped(paper, 1), f"{100.0 * (total / paper - 1.0):+.1f} %"))
    return Table("Loss area [m²]", ("", "reproduction", "paper", "difference"), tuple(rows))


def draw_firefighting(run: Run) -> "Figure":
    """Draws the map of a firefighting run, with the formation at each time at which a fire went out."""
    figure, axes = map_figure(maps.frame_of(run), PAGE)
    maps.draw_fires(axes, run, measures.order(run))
    maps.draw_obstacles(axes, run.setup.world)
    for given in run.paths:
        maps.draw_path(axes, given.path, "stroke of the operator")
    maps.draw_tracks(axes, run)
    times = [float(t) for t in sorted(measures.extinguished_at(run)) if np.isfinite(t)]
    maps.draw_formations(axes, run, [0.0, *times])
    maps.draw_times(axes, run, times)
    maps.legend_below(axes)
    return figure


def _draw_loss(run: Run, column: Column) -> "Figure":
    figure = new_figure(PAGE * 0.72, 2.2)
    axes = figure.subplots()
    loss_bars(axes, run.report["loss_area_m2"], column.loss_area, "")
    axes.legend(loc="upper left", ncols=2)
    return figure


CASES = (
    Case(
        "fire-alone",
        "Firefighting without a human",
        "Fig. 10(a), Table II column 1: the fires go out in the order"
        " 1-2-3-4-5; after fire 1, obstacle 1 hides a part of fire 3.",
        "Scenario table2: Table I with the fitted parameters and bar.",
        run_alone,
    ),
    Case(
        "fire-priority",
        "Changing the priority",
        "Fig. 10(b), Table II column 2: after one stroke, fire 3 goes out before fire 2, and less area burns.",
        "Scenario table2 with the script table2-priority: one stroke when fire 1 is out.",
        run_priority,
    ),
    Case(
        "fire-hidden",
        "Finding a hidden fire",
        "Fig. 10(c), Table II column 3: one stroke leads the team round the bar to fire 5, and only the loss of fire 5"
        " changes.",
        "Scenario table2 with the script table2-hidden: one stroke when fire 4 is out.",
        run_hidden,
    ),
)
