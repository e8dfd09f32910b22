"""The report as one self-contained HTML page: inline figures, no scripts, no external resources."""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape

from higvf_console.lab.reproduce.case import Measurement, Picture, Table
from higvf_console.lab.reproduce.report.formatting import missed, number, tally, verdict
from higvf_console.lab.reproduce.report.notes import DIFFERENCES, METHOD
from higvf_console.lab.reproduce.report.stylesheet import SHEET
from higvf_console.lab.reproduce.results import Result, Results, plain_run


def html_report(results: Results, figures: Mapping[str, bytes]) -> str:
    """The text of the page.

    Args:
        results: findings to report.
        figures: SVG of each picture, by its name.
    """
    cases = "".join(_case(result, figures) for result in results.results)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Reproduction of HI-GVF</title><style>{SHEET}</style></head>
<body>
<nav aria-label="Contents"><p>Contents</p><ol>{_contents(results)}</ol></nav>
<main>
<header><h1>Reproduction of HI-GVF</h1>
<p class="lead">Every result of the paper that a simulation can give, computed from the published data and compared with
the paper: {_sentence(results)}</p>
<p class="made">Created {escape(results.made)}</p></header>
<section id="summary"><h2>Summary</h2>{_summary(results)}{_missed(results)}</section>
{cases}
<section id="differences"><h2>Differences from the paper</h2><dl>{_differences()}</dl></section>
<section id="method"><h2>Method</h2><ul>{"".join(f"<li>{_code(note)}</li>" for note in METHOD)}</ul>
<h3>Versions</h3>{_grid(("program", "version"), list(results.versions.items()))}
<h3>Runs</h3>{_runs(results)}</section>
</main></body></html>
"""


def _contents(results: Results) -> str:
    entries = [("summary", "Summary"), *[(f"case-{r.case.name}", r.case.title) for r in results.results]]
    entries += [("differences", "Differences from the paper"), ("method", "Method")]
    return "".join(f'<li><a href="#{anchor}">{escape(title)}</a></li>' for anchor, title in entries)


def _sentence(results: Results) -> str:
    met, of = (sum(part) for part in zip(*[tally(r.findings) for r in results.results], strict=True))
    return f"{met} of {of} expectations are met, in {len(results.results)} cases and {len(results.runs)} runs."


def _summary(results: Results) -> str:
    rows = ""
    for case, findings in results.results:
        met, of = tally(findings)
        mark = f'<td class="{"met" if met == of else "missed"}">{met} of {of}</td>'
        rows += (
            f'<tr><td><a href="#case-{case.name}">{escape(case.title)}</a></td><td>{escape(case.paper)}</td>{mark}</tr>'
        )
    return _scroll(
        f"<table><thead><tr><th>case</th><th>paper</th><th>met</th></tr></thead><tbody>{rows}</tbody></table>"
    )


def _missed(results: Results) -> str:
    found = missed(results)
    if not found:
        return "<p>All expectations are met.</p>"
    items = "".join(
        f'<li><a href="#case-{name}">{name}</a>: {escape(m.what)}: <b>{escape(number(m.value, m.unit))}</b>; expected'
        f" {escape(m.expected)}</li>"
        for name, m in found
    )
    return f"<h3>Expectations not met</h3><ul>{items}</ul>"


def _case(result: Result, figures: Mapping[str, bytes]) -> str:
    case, findings = result
    tables = "".join(_table(shown) for shown in findings.tables)
    pictures = "".join(_picture(picture, figures[picture.name]) for picture in findings.pictures)
    notes = "".join(f'<p class="note">{_code(note)}</p>' for note in findings.notes)
    return f"""<section id="case-{case.name}"><h2>{escape(case.title)} <code>{case.name}</code></h2>
<p><b>Paper.</b> {escape(case.paper)}</p><p><b>Reproduction.</b> {escape(case.how)}</p>
{_measurements(findings.measurements)}{tables}{pictures}{notes}</section>
"""


def _measurements(measured: Sequence[Measurement]) -> str:
    rows = "".join(
        f'<tr><td class="{_KIND[m.holds]}" title="{_TITLE[m.holds]}">{verdict(m)}</td><td>{escape(m.what)}</td>'
        f'<td class="number">{escape(number(m.value, m.unit))}</td><td>{escape(m.expected)}</td></tr>'
        for m in measured
    )
    head = '<th></th><th>measured</th><th class="number">value</th><th>expected</th>'
    return _scroll(f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>")


_KIND = {True: "met", False: "missed", None: "open"}
_TITLE = {True: "met", False: "not met", None: "no expectation"}


def _table(shown: Table) -> str:
    return f"<h3>{escape(shown.title)}</h3>{_grid(shown.head, shown.rows)}"


def _grid(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    heads = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return _scroll(f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>")


def _picture(picture: Picture, svg: bytes) -> str:
    data = b64encode(svg).decode("ascii")
    caption = escape(picture.caption)
    image = f'<img alt="{caption}" src="data:image/svg+xml;base64,{data}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _differences() -> str:
    return "".join(f"<dt>{_code(what)}</dt><dd>{_code(why)}</dd>" for what, why in DIFFERENCES)


def _runs(results: Results) -> str:
    rows = "".join(
        f"<tr><td><code>{escape(run['command'])}</code></td><td>{run['forms']}</td>"
        f'<td class="number">{run["duration_s"]:g} s</td><td><code class="digest">{run["digest"]}</code></td></tr>'
        for run in map(plain_run, results.runs)
    )
    head = "<th>run</th><th>forms</th><th>duration</th><th>digest of the trajectory</th>"
    return _scroll(f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>")


def _scroll(table: str) -> str:
    return f'<div class="scroll">{table}</div>'


def _code(text: str) -> str:
    """Escapes text and marks the parts between backquotes as code."""
    parts = escape(text).split("`")
    return "".join(f"<code>{part}</code>" if odd % 2 else part for odd, part in enumerate(parts))
