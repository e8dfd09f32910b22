"""The report as Markdown, with its figures in figures/."""

from collections.abc import Iterable, Sequence

from higvf_console.lab.reproduce.case import Findings
from higvf_console.lab.reproduce.report.formatting import missed, number, tally, verdict
from higvf_console.lab.reproduce.report.notes import DIFFERENCES, METHOD
from higvf_console.lab.reproduce.results import Result, Results, plain_run


def markdown_report(results: Results) -> str:
    """The text of the report; it refers to `figures/NAME.png`."""
    lines = ["# Reproduction of HI-GVF", "", f"Created {results.made}", "", "## Summary", ""]
    lines += table(
        ("case", "paper", "met"),
        [
            (f"[{r.case.title}](#{_anchor(r.case.title)})", r.case.paper, "{} of {}".format(*tally(r.findings)))
            for r in results.results
        ],
    )
    lines += ["", *_missed(results)]
    for result in results.results:
        lines += _case(result)
    lines += ["## Differences from the paper", ""]
    lines += [f"- **{what}.** {why}" for what, why in DIFFERENCES]
    lines += ["", "## Method", "", *[f"- {note}" for note in METHOD], ""]
    lines += table(("program", "version"), list(results.versions.items()))
    lines += ["", "### Runs", ""]
    runs = [plain_run(run) for run in results.runs]
    lines += table(
        ("run", "forms", "duration [s]", "digest"),
        [(f"`{r['command']}`", r["forms"], f"{r['duration_s']:g}", f"`{r['digest']}`") for r in runs],
    )
    return "\n".join(lines) + "\n"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """The lines of a Markdown table."""
    cells = [[cell.replace("|", "\\|") for cell in row] for row in (head, *rows)]
    return [f"| {' | '.join(row)} |" for row in (cells[0], ["---"] * len(head), *cells[1:])]


def _missed(results: Results) -> list[str]:
    found = missed(results)
    if not found:
        return ["All expectations are met.", ""]
    lines = ["Expectations not met:", ""]
    lines += [f"- {name}: {m.what}: {number(m.value, m.unit)}; expected {m.expected}" for name, m in found]
    return [*lines, ""]


def _case(result: Result) -> list[str]:
    case, findings = result
    lines = [f"## {case.title}", "", f"Paper: {case.paper}", "", f"Reproduction: {case.how}", ""]
    lines += table(
        ("", "measured", "value", "expected"),
        [(verdict(m), m.what, number(m.value, m.unit), m.expected) for m in findings.measurements],
    )
    return [*lines, "", *_rest(findings)]


def _rest(findings: Findings) -> list[str]:
    lines: list[str] = []
    for shown in findings.tables:
        lines += [f"**{shown.title}**", "", *table(shown.head, shown.rows), ""]
    for picture in findings.pictures:
        lines += [f"![{picture.caption}](figures/{picture.name}.png)", "", f"*{picture.caption}*", ""]
    return [*lines, *[f"> {note}\n" for note in findings.notes]]


def _anchor(title: str) -> str:
    return "".join(c for c in title.lower().replace(" ", "-") if c.isalnum() or c == "-")
