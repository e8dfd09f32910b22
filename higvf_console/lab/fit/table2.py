"""Table II of the paper beside the results of this engine: loss areas of one world in three situations.

    without_human     no operator; the free parameters of the world were fitted to this column only
    change_priority   one stroke when fire 1 is out, after which fire 3 comes before fire 2
    find_hidden       one stroke when fire 4 is out, to a place from which fire 5 is visible

Columns 2 and 3 are predictions: they use the world of column 1, `scenarios/table2.yaml`, and fixed stroke files.
"""

import json
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from higvf_console.channels.channels import open_interface
from higvf_console.core.interface import InputSpec
from higvf_console.core.numbers import grouped
from higvf_console.lab.fit.firefighting import Branch, FirefightingRun, Milestone, milestones, result, run_branch
from higvf_console.lab.reproduce.paper import COLUMNS, Column
from higvf_console.scenario.scenario import Scenario, data_folder, load_scenario
from higvf_console.world.setup import Setup

SCENARIO = "table2"
FIRE_LIMIT = 0.05  # relative error of a fire of column 1
TOTAL_LIMIT = 0.02  # relative error of a column's total
REDUCTION_LIMIT = 0.01  # error of a reduction, as a share of the total without a human
ALONE = "without_human"


class Stroke(NamedTuple):
    """The scripted operator of a column.

    Attributes:
        script: name of the shipped script.
        after: number of the fire that must be out, from 1; the operator does nothing before.
    """

    script: str
    after: int


STROKES: Mapping[str, Stroke] = {
    "change_priority": Stroke("table2-priority", 1),
    "find_hidden": Stroke("table2-hidden", 4),
}


class Verdict(NamedTuple):
    """Result of the comparison with one target.

    Attributes:
        target: name of the target.
        paper: value in the paper, as text.
        found: value of the runs, as text.
        error: difference, relative where the target is an area; None for a target without a number.
        limit: largest error allowed; None for a target without a number.
        met: whether the target is met.
    """

    target: str
    paper: str
    found: str
    error: float | None
    limit: float | None
    met: bool


Columns = Mapping[str, FirefightingRun]  # by the name of the column in the paper


def run_columns(setup: Setup, duration: float, strokes: Mapping[str, Branch]) -> Columns:
    """Runs one world in all three situations.

    Args:
        setup: the world.
        duration: maximum duration of a run [s].
        strokes: operators from `open_strokes`.
    """
    return columns_of(milestones(setup, duration), setup, duration, strokes)


def columns_of(
    alone: Sequence[Milestone], setup: Setup, duration: float, strokes: Mapping[str, Branch]
) -> Columns:  # fmt: skip
    """All three columns of a world, from the milestones of its run without an operator."""
    branches = {name: run_branch(alone, branch, setup, duration) for name, branch in strokes.items()}
    return {ALONE: result(alone), **branches}


def open_strokes(scenario: Scenario) -> dict[str, Branch]:
    """Opens the scripted operator of each column that has one; each may serve many runs.

    Raises:
        HigvfError: a shipped script, or the interface that plays it, is missing.
    """
    folder, robots = data_folder() / "scenarios" / "scripts", len(scenario.robots.points)
    return {
        name: Branch(
            open_interface(InputSpec("script", str(folder / f"{stroke.script}.yaml"), {}, {}, scenario.arena, robots)),
            stroke.after - 1,
        )
        for name, stroke in STROKES.items()
    }


def table2() -> dict[str, Any]:
    """Runs the three columns of the shipped world, compares them with the paper, and adds the stored fit result.

    Returns:
        A dictionary ready for JSON. "table2": {column: {order, loss_area_m2 of fires 1 to 5, total_m2}}; "paper": the
        same for the paper; "relative_error": {column: {loss_area of fires 1 to 5, total}}; "targets": the verdicts; and
        the other entries of `study.study`: space, chosen, spread, sensitivity.
    """
    scenario = load_scenario(SCENARIO)
    runs = run_columns(scenario.setup(), scenario.duration, open_strokes(scenario))
    return {**kept_fit(), **as_json(runs)}


def kept_fit() -> dict[str, Any]:
    """The stored result of the `higvf fit` that chose the shipped world."""
    return json.loads((data_folder() / "scenarios" / f"{SCENARIO}-fit.json").read_text(encoding="utf-8"))


def as_json(runs: Columns, *, every_loss: bool = False) -> dict[str, Any]:
    """Three runs and the columns of the paper in the form that `table2` returns; `every_loss` as in `verdicts`."""
    return {
        "table2": {name: _column(run.order, run.loss_area.tolist(), total(run)) for name, run in runs.items()},
        "paper": {
            name: _column(column.order, list(column.loss_area), summed(column)) for name, column in COLUMNS.items()
        },
        "relative_error": {
            name: {"loss_area": relative_errors(run, COLUMNS[name]), "total": total(run) / summed(COLUMNS[name]) - 1.0}
            for name, run in runs.items()
        },
        "targets": [verdict._asdict() for verdict in verdicts(runs, every_loss=every_loss)],
    }


def _column(order: tuple[int, ...], loss_area: list[float], area: float) -> dict[str, Any]:
    return {"order": list(order), "loss_area_m2": loss_area, "total_m2": area}


def summed(column: Column) -> float:
    """Sum of a printed column [m^2]; the paper prints 48253.9 under the second one, whose sum is 48251.9."""
    return round(sum(column.loss_area), 2)


def total(run: FirefightingRun) -> float:
    """Loss area of all fires [m^2]."""
    return float(run.loss_area.sum())


def relative_errors(run: FirefightingRun, column: Column) -> list[float]:
    """Relative errors of the five loss areas: found / printed - 1."""
    return [float(found) / printed - 1.0 for found, printed in zip(run.loss_area, column.loss_area, strict=True)]


def reduction(runs: Columns, name: str) -> float:
    """Relative change of the total of a column against the run without a human; negative if less burns."""
    return total(runs[name]) / total(runs[ALONE]) - 1.0


def verdicts(runs: Columns, *, every_loss: bool = False) -> tuple[Verdict, ...]:
    """Compares with all targets: fires, totals, reductions, orders, signs of the changes, clearance.

    Args:
        runs: the three columns.
        every_loss: whether the fires of columns 2 and 3 are compared too, or those of column 1 alone.
    """
    changed = [name for name in COLUMNS if name != ALONE]
    return (
        *(verdict for name in (COLUMNS if every_loss else (ALONE,)) for verdict in _loss_verdicts(name, runs)),
        *(_total_verdict(name, runs) for name in COLUMNS),
        *(_reduction_verdict(name, runs) for name in changed),
        *(_order_verdict(name, runs) for name in COLUMNS),
        *(_changes_verdict(name, runs) for name in changed),
        _clearance_verdict(runs),
    )


def _loss_verdicts(name: str, runs: Columns) -> list[Verdict]:
    column = COLUMNS[name]
    situation = f" {column.title.lower()}" if name == ALONE else f", {column.title.lower()}"
    return [
        _near(f"fire {fire}{situation} [m²]", printed, float(found), float(found) / printed - 1.0, FIRE_LIMIT)
        for fire, printed, found in zip(range(1, 6), column.loss_area, runs[name].loss_area, strict=True)
    ]


def _near(target: str, printed: float, found: float, error: float, limit: float) -> Verdict:
    return Verdict(target, grouped(printed, 1), grouped(found, 1), error, limit, abs(error) <= limit)


def _total_verdict(name: str, runs: Columns) -> Verdict:
    printed, found = summed(COLUMNS[name]), total(runs[name])
    return _near(f"total, {COLUMNS[name].title.lower()} [m²]", printed, found, found / printed - 1.0, TOTAL_LIMIT)


def _reduction_verdict(name: str, runs: Columns) -> Verdict:
    printed, found = summed(COLUMNS[name]) / summed(COLUMNS[ALONE]) - 1.0, reduction(runs, name)
    target = f"change of the total, {COLUMNS[name].title.lower()} [%]"
    return _near(target, 100.0 * printed, 100.0 * found, found - printed, REDUCTION_LIMIT)


def _order_verdict(name: str, runs: Columns) -> Verdict:
    printed, found = COLUMNS[name].order, runs[name].order
    target = f"order, {COLUMNS[name].title.lower()}"
    return Verdict(target, "-".join(map(str, printed)), "-".join(map(str, found)), None, None, found == printed)


def _changes_verdict(name: str, runs: Columns) -> Verdict:
    printed = [_sign(new - old) for new, old in zip(COLUMNS[name].loss_area, COLUMNS[ALONE].loss_area, strict=True)]
    found = [_sign(float(new - old)) for new, old in zip(runs[name].loss_area, runs[ALONE].loss_area, strict=True)]
    target = f"sign of each fire's change, {COLUMNS[name].title.lower()}"
    return Verdict(target, " ".join(printed), " ".join(found), None, None, found == printed)


def _sign(change: float) -> str:
    """Sign of a change; "=" means bit for bit, because two runs are identical until the operator acts."""
    return "=" if change == 0.0 else "+" if change > 0.0 else "-"


def _clearance_verdict(runs: Columns) -> Verdict:
    least = min(run.min_clearance for run in runs.values())
    return Verdict("smallest clearance of all runs [m]", "not negative", f"{least:.2f}", None, None, least >= 0.0)
