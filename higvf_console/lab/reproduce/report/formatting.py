"""Formatting of values and verdicts, shared by HTML and Markdown."""

from higvf_console.core.numbers import grouped
from higvf_console.lab.reproduce.case import Findings, Measurement
from higvf_console.lab.reproduce.results import Results


def number(value: float | int | str | None, unit: str) -> str:
    """Formats a measured value with its unit: three significant digits, without an exponent between 1e3 and 1e7."""
    if value is None:
        return "none"
    if isinstance(value, str):
        text = value
    elif isinstance(value, int):
        text = grouped(value)
    elif value == 0.0 or abs(value) < 1e-12:
        text = "0"
    elif 1e3 <= abs(value) < 1e7:
        text = grouped(value)
    else:
        text = f"{value:.3g}"
    return f"{text} {unit}".strip()


def verdict(measurement: Measurement) -> str:
    """Mark of a measurement: met, not met, or without expectation."""
    return {True: "✓", False: "✗", None: "—"}[measurement.holds]


def tally(findings: Findings) -> tuple[int, int]:
    """Number of expectations met, and number of expectations."""
    judged = [m.holds for m in findings.measurements if m.holds is not None]
    return sum(judged), len(judged)


def missed(results: Results) -> list[tuple[str, Measurement]]:
    """Case name and measurement of every expectation that is not met."""
    return [
        (result.case.name, m) for result in results.results for m in result.findings.measurements if m.holds is False
    ]
