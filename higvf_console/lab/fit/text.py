"""The result of `higvf fit` as plain text: chosen world, Table II, targets, predictions and sensitivity."""

from collections.abc import Mapping, Sequence
from typing import Any

from higvf_console.core.numbers import grouped
from higvf_console.lab.fit.table2 import ALONE, summed
from higvf_console.lab.reproduce.paper import COLUMNS


def summary(result: Mapping[str, Any]) -> str:
    """The text of all sections.

    Args:
        result: `Study.result` of `study.study`.
    """
    head = (
        f"{result['runs']} runs without a human, seed {result['seed']}: misfit {result['misfit']:.2f}; "
        f"{result['acceptable']} samples meet the targets of column 1"
    )
    parts = [_parameters(result), loss_table(result), _targets(result), _predictions(result), _influence(result)]
    return "\n\n".join([head, *parts])


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """Formats a table of cells: the first column left-aligned, the others right-aligned."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if column == 0 else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


def _parameters(result: Mapping[str, Any]) -> str:
    rows: list[Sequence[str]] = [("parameter", "chosen", "spread from", "to", "search from", "to", "unit")]
    for free in result["space"]:
        found = result["spread"]["parameters"][free["name"]]
        numbers = (found["chosen"], found["low"], found["high"], free["low"], free["high"])
        rows.append((free["name"], *(f"{number:g}" for number in numbers), free["unit"]))
    return aligned(rows)


def loss_table(result: Mapping[str, Any]) -> str:
    """The loss areas beside those of the paper."""
    rows: list[Sequence[str]] = [
        ("loss area [m²]", *(cell for column in COLUMNS.values() for cell in (column.title, "paper", "error")))
    ]
    for fire in range(5):
        cells = [f"fire {fire + 1}"]
        for name, column in COLUMNS.items():
            found, error = result["table2"][name]["loss_area_m2"][fire], result["relative_error"][name]["loss_area"]
            cells += [grouped(found, 1), grouped(column.loss_area[fire], 1), f"{100.0 * error[fire]:+.2f} %"]
        rows.append(tuple(cells))
    cells = ["total"]
    for name, column in COLUMNS.items():
        error = 100.0 * result["relative_error"][name]["total"]
        cells += [grouped(result["table2"][name]["total_m2"], 1), grouped(summed(column), 1), f"{error:+.2f} %"]
    return aligned([*rows, tuple(cells)])


def _targets(result: Mapping[str, Any]) -> str:
    rows: list[Sequence[str]] = [("target", "paper", "found", "error", "limit", "", "samples that meet it")]
    for verdict in result["targets"]:
        off, limit = verdict["error"], verdict["limit"]
        share = result["spread"]["targets_met"][verdict["target"]]
        rows.append((
            verdict["target"], verdict["paper"], verdict["found"], "" if off is None else f"{100.0 * off:+.2f} %",
            "" if limit is None else f"{100.0 * limit:g} %", "met" if verdict["met"] else "MISSED",
            f"{100.0 * share:.0f} %",
        ))  # fmt: skip
    missed = [verdict["target"] for verdict in result["spread"]["nearest"]["targets"] if not verdict["met"]]
    last = (
        f"{100.0 * result['spread']['all_met']:.0f} % of {result['spread']['samples']} samples meet all targets; "
        f"the nearest sample misses: {', '.join(missed) or 'none'}"
    )
    return f"{aligned(rows)}\n{last}"


def _predictions(result: Mapping[str, Any]) -> str:
    found = result["spread"]
    return quantity_table(f"{found['samples']} samples that meet column 1", found["predictions"])


def quantity_table(title: str, ranges: Mapping[str, Mapping[str, float]]) -> str:
    """The result of `report.quantity_ranges` as a table."""
    rows: list[Sequence[str]] = [(title, "paper", "minimum", "median", "maximum")]
    for name, found in ranges.items():
        numbers = (found[key] for key in ("paper", "low", "median", "high"))
        rows.append((name, *(grouped(number) if "total" in name else f"{100 * number:+.2f} %" for number in numbers)))
    return aligned(rows)


def _influence(result: Mapping[str, Any]) -> str:
    changed = [name for name in COLUMNS if name != ALONE]
    fires = [f"a(s{fire})" for fire in range(1, 6)]
    totals, reductions = [f"total {name}" for name in COLUMNS], [f"reduction {name}" for name in changed]
    rows: list[Sequence[str]] = [("change [%]", "step", *fires, *totals, *reductions)]
    for name, found in result["sensitivity"].items():
        if found is None:
            rows.append((name, "not computable", *("" for _ in (*fires, *totals, *reductions))))
            continue
        changes = (*found["fires"], *found["totals"].values(), *found["reductions"].values())
        rows.append((name, f"+{found['step']:g} {found['unit']}".rstrip(), *(f"{100 * one:+.2f}" for one in changes)))
    return aligned(rows)
