"""How numbers and verdicts read, the same in HTML and Markdown."""

from higvf_console.lab.reproduce.case import Findings, Measurement
from higvf_console.lab.reproduce.results import Results


def number(value: float | int | str | None, unit: str) -> str:
    """A measured value with its unit: three or four digits, no exponent where none is needed."""
    if value is None:
        return "none"
    if isinstance(value, str):
        text = value
    elif isinstance(value, int):
        text = f"{value:,}"
    elif value == 0.0 or abs(value) < 1e-12:
        text = "0"
    elif 1e3 <= abs(value) < 1e7:
        text = f"{value:,.0f}"
    else:
        text = f"{value:.3g}"
    return f"{text} {unit}".strip()


def verdict(measurement: Measurement) -> str:
    """A mark: met, missed, nothing promised."""
    return {True: "✓", False: "✗", None: "—"}[measurement.holds]


def tally(findings: Findings) -> tuple[int, int]:
    """How many expectations are met, of how many."""
    judged = [m.holds for m in findings.measurements if m.holds is not None]
    return sum(judged), len(judged)


def missed(results: Results) -> list[tuple[str, Measurement]]:
    """(case, measurement) of every expectation that is not met."""
    return [
        (result.case.name, m) for result in results.results for m in result.findings.measurements if m.holds is False
    ]
