"""What a case is, and what it finds: numbers beside the paper's, tables, pictures, the runs that they come from."""

from collections.abc import Callable
from typing import Any, NamedTuple

from matplotlib.figure import Figure

from higvf_console.lab.reproduce.runs import Run, Runs


class Measurement(NamedTuple):
    """One number and what it is held against.

    Attributes:
        what: one line, without the number.
        value: as measured; None where it cannot be.
        unit: "m", "s", "" ...
        expected: the paper's or the expected value, in words.
        holds: whether the expectation is met; None where nothing is promised.
    """

    what: str
    value: float | int | str | None
    unit: str
    expected: str
    holds: bool | None


class Table(NamedTuple):
    """A table of texts, ready to print."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


class Picture(NamedTuple):
    """A figure that is drawn when a report wants it.

    Attributes:
        name: of its file, without an ending.
        caption: what it shows, one or two sentences.
        draw: makes it, inside the style of `figures.canvas`.
    """

    name: str
    caption: str
    draw: Callable[[], Figure]


class Findings(NamedTuple):
    """What a case found.

    Attributes:
        measurements: the numbers, the most important first.
        pictures: as the paper draws them.
        runs: what was simulated.
        tables: comparisons of more than one number.
        notes: sentences on how to read it.
        data: further entries of the JSON's top level, e.g. {"table2": ...}.
    """

    measurements: tuple[Measurement, ...]
    pictures: tuple[Picture, ...] = ()
    runs: tuple[Run, ...] = ()
    tables: tuple[Table, ...] = ()
    notes: tuple[str, ...] = ()
    data: dict[str, Any] = {}  # noqa: RUF012 (never written)


class Case(NamedTuple):
    """One result of the paper.

    Attributes:
        name: word of the command line.
        title: what a person reads.
        paper: where the paper shows it, and what it says there.
        how: how it is run here.
        run: does it.
    """

    name: str
    title: str
    paper: str
    how: str
    run: Callable[[Runs], Findings]


def within(what: str, value: float, unit: str, low: float, high: float, expected: str) -> Measurement:
    """A measurement that holds inside [low, high]."""
    return Measurement(what, value, unit, expected, bool(low <= value <= high))
