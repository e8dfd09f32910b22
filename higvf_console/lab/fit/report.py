"""Uncertainty of a fit: spread of the acceptable samples and of their predictions, and parameter sensitivity.

Only column 1 selects the sample. The scatter of columns 2 and 3 over samples that fit column 1 equally well is
therefore the uncertainty of these predictions.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from higvf_console.lab.fit.space import NAMES, SPACE, Sample, on_grid, unit
from higvf_console.lab.fit.table2 import ALONE, Columns, Verdict, reduction, relative_errors, summed, total, verdicts
from higvf_console.lab.reproduce.paper import COLUMNS

_STEP_SHARE = 0.02  # step of the central differences, as a share of the range of a parameter

RunColumns = Callable[[Sequence[Sample]], Sequence[Columns | None]]  # None if the sample cannot be run


def spread(samples: Sequence[Sample], run: RunColumns) -> dict[str, Any]:
    """Ranges of the acceptable samples and of their predictions, and the share that meets each target.

    Args:
        samples: acceptable samples, the chosen one first.
        run: computes the three columns of each sample.

    Returns:
        A dictionary ready for JSON: "samples", their number; "parameters": {name: {chosen, low, high, unit}};
        "predictions": {quantity: {paper, low, median, high}}; "targets_met": {target: share of the samples};
        "all_met": share that meets all targets; and "nearest": the sample with the smallest misses, which illustrates
        what the model can do and is never chosen.
    """
    table = np.array(samples)
    tried = [(sample, columns) for sample, columns in zip(samples, run(samples), strict=True) if columns is not None]
    outcomes = [columns for _, columns in tried]
    judged = [verdicts(columns) for columns in outcomes]
    nearest = min(range(len(judged)), key=lambda place: _missed(judged[place]))
    return {
        "samples": len(samples),
        "parameters": {
            free.name: {"chosen": column[0], "low": column.min(), "high": column.max(), "unit": unit(free.name)}
            for free, column in zip(SPACE, table.T, strict=True)
        },
        "predictions": quantity_ranges(outcomes),
        "targets_met": {
            verdict.target: float(np.mean([verdicts_of[place].met for verdicts_of in judged]))
            for place, verdict in enumerate(judged[0])
        },
        "all_met": float(np.mean([all(verdict.met for verdict in one) for one in judged])),
        "nearest": {
            "sample": dict(zip(NAMES, tried[nearest][0], strict=True)),
            "targets": [verdict._asdict() for verdict in judged[nearest]],
        },
    }


def quantity_ranges(outcomes: Sequence[Columns]) -> dict[str, dict[str, float]]:
    """Totals, reductions and largest errors over worlds: {quantity: {paper, low, median, high}}."""
    found, paper = [_quantities(columns) for columns in outcomes], _paper_quantities()
    return {name: {"paper": paper[name], **_range([one[name] for one in found])} for name in paper}


def _missed(judged: Sequence[Verdict]) -> tuple[int, float]:
    """Number of missed targets, and the largest error relative to its limit."""
    worst = max(abs(one.error) / one.limit for one in judged if one.error is not None and one.limit is not None)
    return sum(not one.met for one in judged), worst


def _range(values: Sequence[float]) -> dict[str, float]:
    return {"low": min(values), "median": float(np.median(values)), "high": max(values)}


def _quantities(columns: Columns) -> dict[str, float]:
    """Totals [m^2], reductions, and the largest relative error of a fire in each column."""
    totals = {f"total_m2.{name}": total(run) for name, run in columns.items()}
    changes = {f"reduction.{name}": reduction(columns, name) for name in COLUMNS if name != ALONE}
    worst = {
        f"largest_error.{name}": max(map(abs, relative_errors(run, COLUMNS[name]))) for name, run in columns.items()
    }
    return {**totals, **changes, **worst}


def _paper_quantities() -> dict[str, float]:
    totals = {f"total_m2.{name}": summed(column) for name, column in COLUMNS.items()}
    changes = {
        f"reduction.{name}": summed(column) / summed(COLUMNS[ALONE]) - 1.0
        for name, column in COLUMNS.items()
        if name != ALONE
    }
    return {**totals, **changes, **{f"largest_error.{name}": 0.0 for name in COLUMNS}}


def sensitivity(chosen: Sample, run: RunColumns) -> dict[str, Any]:
    """Sensitivity to each parameter, by central differences about the chosen sample.

    Args:
        chosen: the sample.
        run: computes the three columns of each sample.

    Returns:
        {parameter: {"step": h, "unit", "fires": the five changes of column 1, "totals": {column: change},
        "reductions": {column: change}}}, relative changes for a step of h = 2 % of the parameter's range; None for a
        parameter whose neighbouring samples cannot be run.
    """
    steps = [max(free.step, _STEP_SHARE * (free.high - free.low)) for free in SPACE]
    pairs = [
        [on_grid(np.array(chosen) + sign * step * np.eye(len(SPACE))[place]) for sign in (-1.0, 1.0)]
        for place, step in enumerate(steps)
    ]
    outcomes = run([sample for pair in pairs for sample in pair])
    found: dict[str, Any] = {}
    for place, name in enumerate(NAMES):
        below, above = outcomes[2 * place], outcomes[2 * place + 1]
        half = 0.5 * (pairs[place][1][place] - pairs[place][0][place])
        change = None if below is None or above is None else _change(below, above)
        found[name] = None if change is None else {"step": round(half, 6), "unit": unit(name), **change}
    return found


def _change(below: Columns, above: Columns) -> Mapping[str, Any]:
    """Half the difference between two samples: areas and totals relative to the printed ones, and reductions."""

    def half(high: float, low: float, scale: float = 1.0) -> float:
        return 0.5 * (high - low) / scale

    alone = zip(above[ALONE].loss_area, below[ALONE].loss_area, COLUMNS[ALONE].loss_area, strict=True)
    return {
        "fires": [half(float(high), float(low), printed) for high, low, printed in alone],
        "totals": {name: half(total(above[name]), total(below[name]), summed(COLUMNS[name])) for name in COLUMNS},
        "reductions": {name: half(reduction(above, name), reduction(below, name)) for name in COLUMNS if name != ALONE},
    }
