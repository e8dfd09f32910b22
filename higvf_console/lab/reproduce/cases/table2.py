"""Table II side by side with the paper."""

from typing import Any, NamedTuple

from matplotlib.figure import Figure

from higvf_console.lab.reproduce import measures
from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Picture, Table
from higvf_console.lab.reproduce.cases.firefighting import SPECS
from higvf_console.lab.reproduce.figures.charts import table_2_bars
from higvf_console.lab.reproduce.paper import COLUMNS
from higvf_console.lab.reproduce.runs import Run, Runs

FIRE_BAND, TOTAL_BAND, REDUCTION_BAND = 5.0, 2.0, 1.0  # %, %, percentage points


class Comparison(NamedTuple):
    """Our Table II: `columns` as in the JSON, the runs they come from, and further tables, e.g. of the fit."""

    columns: dict[str, dict[str, Any]]
    runs: tuple[Run, ...]
    tables: tuple[Table, ...]
    notes: tuple[str, ...]


def compare(runs: Runs) -> Comparison:
    """Our Table II, of the scenario firefighting as it is shipped."""
    made = {name: runs.get(spec) for name, spec in SPECS.items()}
    columns = {
        name: {
            "order": list(measures.order(run)),
            "loss_area_m2": run.report["loss_area_m2"],
            "total_m2": run.report["loss_area_total_m2"],
        }
        for name, run in made.items()
    }
    notes = (
        "The paper gives no gains, no position of the bar, no law of extinguishing and no start delay; the areas depend"
        " on all four, the orders and the signs of the changes do not.",
        "Column 2 of Table II as printed sums to 48251.9, not 48253.9.",
    )
    return Comparison(columns, tuple(made.values()), (), notes)


def run_table_2(runs: Runs) -> Findings:
    """All three columns, beside the paper's."""
    ours = compare(runs)
    return Findings(
        _measured(ours),
        (Picture("table2", "Loss area of each fire in the three situations of Table II.", lambda: _draw(ours)),),
        ours.runs,
        (_table(ours), *ours.tables),
        ours.notes,
        {"table2": ours.columns},
    )


def _measured(ours: Comparison) -> tuple[Measurement, ...]:
    alone, paper = ours.columns["without_human"], COLUMNS["without_human"]
    worst = max(abs(a / b - 1.0) for a, b in zip(alone["loss_area_m2"], paper.loss_area, strict=True)) * 100.0
    found = [
        Measurement(
            "Orders of extinguishing",
            ", ".join("".join(map(str, c["order"])) for c in ours.columns.values()),
            "",
            ", ".join("".join(map(str, c.order)) for c in COLUMNS.values()),
            all(tuple(c["order"]) == COLUMNS[name].order for name, c in ours.columns.items()),
        ),
        Measurement(
            "Largest difference of a fire in column 1",
            round(worst, 2),
            "%",
            f"at most {FIRE_BAND:g}",
            worst <= FIRE_BAND,
        ),
    ]
    for name, column in ours.columns.items():
        off = 100.0 * (column["total_m2"] / sum(COLUMNS[name].loss_area) - 1.0)
        found.append(
            Measurement(
                f"{COLUMNS[name].title}: difference of the total",
                round(off, 2),
                "%",
                f"within {TOTAL_BAND:g}",
                abs(off) <= TOTAL_BAND,
            )
        )
    for name in list(COLUMNS)[1:]:
        change = 100.0 * (ours.columns[name]["total_m2"] / alone["total_m2"] - 1.0)
        wanted = 100.0 * (sum(COLUMNS[name].loss_area) / sum(paper.loss_area) - 1.0)
        found.append(
            Measurement(
                f"{COLUMNS[name].title}: change of the total",
                round(change, 2),
                "%",
                f"{wanted:.1f}, within {REDUCTION_BAND:g} percentage point",
                abs(change - wanted) <= REDUCTION_BAND,
            )
        )
    return tuple(found)


def _table(ours: Comparison) -> Table:
    names = list(COLUMNS)
    head = ["Loss area [m²]"]
    for name in names:
        head += [f"{COLUMNS[name].title}: here", "paper", "difference"]
    rows: list[tuple[str, ...]] = []
    for fire in (*range(5), None):
        cells = ["Sum" if fire is None else f"a(s{fire + 1})"]
        for name in names:
            here, paper = ours.columns[name], COLUMNS[name].loss_area
            a = here["total_m2"] if fire is None else here["loss_area_m2"][fire]
            b = sum(paper) if fire is None else paper[fire]
            cells += [f"{a:,.1f}", f"{b:,.1f}", f"{100.0 * (a / b - 1.0):+.1f} %"]
        rows.append(tuple(cells))
    return Table("Table II, side by side", tuple(head), tuple(rows))


def _draw(ours: Comparison) -> Figure:
    return table_2_bars(
        {
            COLUMNS[name].title: (column["loss_area_m2"], COLUMNS[name].loss_area)
            for name, column in ours.columns.items()
        }
    )


CASES = (
    Case(
        "table2",
        "Table II",
        "Table II: loss areas without a human, with a changed priority, with a hidden fire found.",
        "The three firefighting runs.",
        run_table_2,
    ),
)
