"""Data of a case of the paper and of its findings: measurements, tables, pictures and runs."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from higvf_console.lab.reproduce.runs import Run, Runs

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Measurement(NamedTuple):
    """A measured value and the value expected of it.

    Attributes:
        what: what is measured, in one line.
        value: measured value; None if it cannot be measured.
        unit: "m", "s", "" ...
        expected: expected value, or that of the paper, as text.
        holds: whether the expectation is met; None if there is none.
    """

    what: str
    value: float | int | str | None
    unit: str
    expected: str
    holds: bool | None


class Table(NamedTuple):
    """A table of text cells."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


class Picture(NamedTuple):
    """A figure that is drawn on demand.

    Attributes:
        name: file name without suffix.
        caption: one or two sentences.
        draw: draws it within `figures.canvas.style`.
    """

    name: str
    caption: str
    draw: "Callable[[], Figure]"


class Findings(NamedTuple):
    """Findings of a case.

    Attributes:
        measurements: measured values, the most important first.
        pictures: figures, drawn as in the paper.
        runs: runs that the findings are based on.
        tables: comparisons of several values.
        notes: explanations for the reader.
        data: further entries at the top level of the JSON, e.g. {"table2": ...}.
    """

    measurements: tuple[Measurement, ...]
    pictures: tuple[Picture, ...] = ()
    runs: tuple[Run, ...] = ()
    tables: tuple[Table, ...] = ()
    notes: tuple[str, ...] = ()
    data: dict[str, Any] = {}  # noqa: RUF012 (never modified)


class Case(NamedTuple):
    """A result of the paper and the way to reproduce it.

    Attributes:
        name: name on the command line.
        title: heading in the report.
        paper: place in the paper, and its claim.
        how: description of the runs.
        run: computes the findings.
        beside: names of cases that are run and shown with it.
    """

    name: str
    title: str
    paper: str
    how: str
    run: Callable[[Runs], Findings]
    beside: tuple[str, ...] = ()


def within(what: str, value: float, unit: str, low: float, high: float, expected: str) -> Measurement:
    """A measurement whose expectation is met for `low` <= `value` <= `high`."""
    return Measurement(what, value, unit, expected, bool(low <= value <= high))
