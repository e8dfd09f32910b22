"""Table II beside the paper: the world fitted to column 1, its predictions, and the uncertainty of the fit."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from higvf_console.core.numbers import grouped
from higvf_console.lab.fit.table2 import ALONE, FIRE_LIMIT, REDUCTION_LIMIT, TOTAL_LIMIT, kept_fit
from higvf_console.lab.reproduce import measures
from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Picture, Table
from higvf_console.lab.reproduce.cases.firefighting import SPECS
from higvf_console.lab.reproduce.figures.charts import table_2_bars
from higvf_console.lab.reproduce.paper import COLUMNS
from higvf_console.lab.reproduce.runs import Run, Runs, RunSpec

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIRE_BAND, TOTAL_BAND, REDUCTION_BAND = (100.0 * limit for limit in (FIRE_LIMIT, TOTAL_LIMIT, REDUCTION_LIMIT))


Columns = Mapping[str, Mapping[str, Any]]  # {column: {order, loss_area_m2, total_m2}}, as in the JSON


def columns_of(made: Mapping[str, Run]) -> Columns:
    """Table II as the runs of its columns give it."""
    return {
        name: {
            "order": list(measures.order(run)),
            "loss_area_m2": run.report["loss_area_m2"],
            "total_m2": run.report["loss_area_total_m2"],
        }
        for name, run in made.items()
    }


def runs_of(runs: Runs, specs: Mapping[str, RunSpec]) -> dict[str, Run]:
    """The runs of the columns."""
    return {name: runs.get(spec) for name, spec in specs.items()}


def quantities(title: str, ranges: Mapping[str, Mapping[str, float]]) -> Table:
    """The spread of totals, reductions and largest errors over several worlds, as `fit.report` gives it."""
    rows = [
        (name.replace(".", ", "), *(_amount(name, found[key]) for key in ("paper", "low", "median", "high")))
        for name, found in ranges.items()
    ]
    return Table(title, ("", "paper", "minimum", "median", "maximum"), tuple(rows))


def _amount(name: str, value: float) -> str:
    return f"{grouped(value)} m²" if name.startswith("total") else f"{100.0 * value:+.1f} %"


def _parameters(fit: Mapping[str, Any]) -> Table:
    spread = fit["spread"]["parameters"]
    rows = [
        (name, *(f"{found[key]:g} {found['unit']}".rstrip() for key in ("chosen", "low", "high")))
        for name, found in spread.items()
    ]
    return Table("Fitted parameters, and their range over these worlds", ("", "chosen", "from", "to"), tuple(rows))


def _influence(fit: Mapping[str, Any]) -> Table:
    rows = [
        (f"{name} +{found['step']:g} {found['unit']}".rstrip(), *(f"{100.0 * change:+.2f} %" for change in changes))
        for name, found in fit["sensitivity"].items()
        if found is not None
        for changes in [(*found["fires"], *found["totals"].values())]
    ]
    fires, totals = (f"a(s{fire})" for fire in range(1, 6)), (f"total, {c.title.lower()}" for c in COLUMNS.values())
    head = ("step of", *fires, *totals)
    return Table("Sensitivity to each parameter (central differences)", head, tuple(rows))


def run_table_2(runs: Runs) -> Findings:
    """Compares the columns of the world fitted to column 1 with those of the paper."""
    made, fit = runs_of(runs, SPECS), kept_fit()
    columns = columns_of(made)
    missed = [verdict["target"] for verdict in fit["spread"]["nearest"]["targets"] if not verdict["met"]]
    notes = (
        "The paper gives no parameters, no position of the bar, no law of extinguishing and no start delay. These were"
        " fitted to column 1 only, by a rule fixed beforehand; columns 2 and 3 are predictions.",
        f"The fit is not unique: the second table shows the spread of the predictions over {fit['spread']['samples']}"
        f" worlds that meet the targets of column 1. The nearest of them misses {', '.join(missed) or 'no target'}; it"
        " was not chosen, because that choice would use all columns. The case `table2-joint` makes that choice.",
        "The printed entries of column 2 sum to 48251.9; the paper prints 48253.9.",
    )
    return Findings(
        measured(columns, (ALONE,)),
        (
            picture(
                "table2",
                "Loss area of each fire in the three situations of Table II; columns 2 and 3 are predicted.",
                columns,
            ),
        ),
        tuple(made.values()),
        (
            loss_table(columns),
            quantities("Predictions of the worlds that meet column 1", fit["spread"]["predictions"]),
            _parameters(fit),
            _influence(fit),
        ),
        notes,
        {"table2": columns},
    )


def measured(columns: Columns, fires_of: Sequence[str]) -> tuple[Measurement, ...]:
    """Orders, losses, totals and reductions beside those of the paper.

    Args:
        columns: Table II.
        fires_of: the columns whose fires are compared one by one.
    """
    alone, paper = columns[ALONE], COLUMNS[ALONE]
    found = [
        Measurement(
            "Order in which the fires go out, by column",
            ", ".join("".join(map(str, c["order"])) for c in columns.values()),
            "",
            ", ".join("".join(map(str, c.order)) for c in COLUMNS.values()),
            all(tuple(c["order"]) == COLUMNS[name].order for name, c in columns.items()),
        )
    ]
    for name in fires_of:
        areas = zip(columns[name]["loss_area_m2"], COLUMNS[name].loss_area, strict=True)
        worst = max(abs(here / printed - 1.0) for here, printed in areas) * 100.0
        found.append(
            Measurement(
                f"{COLUMNS[name].title}: largest error of a loss area",
                round(worst, 2),
                "%",
                f"at most {FIRE_BAND:g}",
                worst <= FIRE_BAND,
            )
        )
    for name, column in columns.items():
        off = 100.0 * (column["total_m2"] / sum(COLUMNS[name].loss_area) - 1.0)
        found.append(
            Measurement(
                f"{COLUMNS[name].title}: error of the total",
                round(off, 2),
                "%",
                f"at most {TOTAL_BAND:g} in magnitude",
                abs(off) <= TOTAL_BAND,
            )
        )
    for name in list(COLUMNS)[1:]:
        change = 100.0 * (columns[name]["total_m2"] / alone["total_m2"] - 1.0)
        wanted = 100.0 * (sum(COLUMNS[name].loss_area) / sum(paper.loss_area) - 1.0)
        found.append(
            Measurement(
                f"{COLUMNS[name].title}: change of the total",
                round(change, 2),
                "%",
                f"{wanted:.1f}, to within {REDUCTION_BAND:g} percentage point",
                abs(change - wanted) <= REDUCTION_BAND,
            )
        )
    return tuple(found)


def loss_table(columns: Columns) -> Table:
    """Table II beside the paper."""
    names = list(COLUMNS)
    head = ["Loss area [m²]"]
    for name in names:
        head += [f"{COLUMNS[name].title}: reproduction", "paper", "difference"]
    rows: list[tuple[str, ...]] = []
    for fire in (*range(5), None):
        cells = ["Sum" if fire is None else f"a(s{fire + 1})"]
        for name in names:
            here, paper = columns[name], COLUMNS[name].loss_area
            a = here["total_m2"] if fire is None else here["loss_area_m2"][fire]
            b = sum(paper) if fire is None else paper[fire]
            cells += [grouped(a, 1), grouped(b, 1), f"{100.0 * (a / b - 1.0):+.1f} %"]
        rows.append(tuple(cells))
    return Table("Table II", tuple(head), tuple(rows))


def picture(name: str, caption: str, columns: Columns) -> Picture:
    """The loss areas of the three columns as bars beside those of the paper."""

    def draw() -> "Figure":
        return table_2_bars(
            {COLUMNS[key].title: (column["loss_area_m2"], COLUMNS[key].loss_area) for key, column in columns.items()}
        )

    return Picture(name, caption, draw)


CASES = (
    Case(
        "table2",
        "Table II, predicted from its first column",
        "Table II: loss areas without a human, with a changed priority, with a hidden fire found.",
        "The three firefighting runs in scenario table2, fitted to column 1 alone: columns 2 and 3 are predictions.",
        run_table_2,
        ("table2-joint",),
    ),
)
