"""Benchmarks, as a table or as JSON: `higvf bench --suite NAME`.

filter, tick   time of the safety filter and of a whole tick; the ratios are comparable across machines
deadlock       arrivals, violations and deadlock time in random scenes, for each form of the equations
preview        speed of the preview, and its effect on the timing of the control loop
lsl            live streams: latency from push to command, and memory growth over an hour of gaze
ui             the console in a browser: network traffic, CPU, frame rate, latency from stroke to motion
endurance      memory, handles and threads over time: many robots, many observers, many hours
team           robots of another simulator: contacts with a bad link, and when they stand if a part is killed
"""

import json
from collections.abc import Callable
from typing import Any

from higvf_console.core.arguments import one_of
from higvf_console.core.errors import HigvfError
from higvf_console.core.optional import require
from higvf_console.lab.bench import deadlock as bench_deadlock
from higvf_console.lab.bench import deadlock_report
from higvf_console.lab.bench import filter as bench_filter
from higvf_console.lab.bench import lsl as bench_lsl
from higvf_console.lab.bench import preview as bench_preview
from higvf_console.lab.bench import tick as bench_tick
from higvf_console.lab.bench.timing import Case, Suite

_TIMINGS: dict[str, Callable[[], Suite]] = {"filter": bench_filter.run, "tick": bench_tick.run}
DEADLOCK, PREVIEW, LSL, UI = "deadlock", "preview", "lsl", "ui"
SAFETY, ENDURANCE, TEAM = (
    "safety",
    "endurance",
    "team",
)  # have commands of their own: `lab.safety`, `.endurance`, `lab.team`
SUITES = (*_TIMINGS, DEADLOCK, PREVIEW, LSL, UI)


def main(suite: str, as_json: bool, scenes: int | None = None, factor: float = 1.0) -> None:
    """Runs a suite and prints its table, or one JSON object."""
    print(run_suite(suite, as_json, scenes, factor))


def run_suite(name: str, as_json: bool, scenes: int | None = None, factor: float = 1.0) -> str:
    """The table of a suite, or its JSON.

    Args:
        name: one of `SUITES`.
        as_json: whether to return JSON instead of a table.
        scenes: number of spaced scenes of `DEADLOCK` to run, and the same share of the others; None = all.
        factor: size of these scenes, relative to the usual one.

    Raises:
        HigvfError: no such suite, the message lists them; or a package of an extra that it needs is missing.
    """
    if name == DEADLOCK:
        outcomes = bench_deadlock.run_all(scenes, factor=factor)
        return deadlock_report.as_json(outcomes) if as_json else deadlock_report.table(outcomes)
    if name == PREVIEW:
        measured = bench_preview.run()
        return json.dumps(bench_preview.plain(measured), indent=2) if as_json else bench_preview.table(measured)
    if name == LSL:
        figures = bench_lsl.run()
        return json.dumps(figures, indent=2) if as_json else bench_lsl.table(figures)
    if name == UI:
        require("viser", "console", "suite ui")
        from higvf_console.lab.bench import ui as bench_ui  # noqa: PLC0415 (needs viser)

        figures = bench_ui.run()
        return json.dumps(figures, indent=2) if as_json else bench_ui.table(figures)
    one_of("benchmark suite", name, SUITES, HigvfError)
    suite = _TIMINGS[name]()
    return json.dumps(_plain(name, suite), indent=2) if as_json else _table(suite)


def _plain(name: str, suite: Suite) -> dict[str, Any]:
    cases = [
        {
            "scene": case.scene,
            "robots": case.robots,
            "median_ms": dict(case.milliseconds),
            f"ratio_to_{suite.reference}": {
                contender: None if taken is None else taken / _reference_time(suite, case)
                for contender, taken in case.milliseconds.items()
            },
            **case.facts,
        }
        for case in suite.cases
    ]
    return {"suite": name, "title": suite.title, "cases": cases}


def _reference_time(suite: Suite, case: Case) -> float:
    own = case.milliseconds[suite.reference]
    assert own is not None
    return own


def _table(suite: Suite) -> str:
    """Median milliseconds of each contender, with its ratio to the reference in brackets."""
    first = suite.cases[0]
    head = ["scene", "robots", *first.milliseconds, *first.facts]
    lines = [head]
    for case in suite.cases:
        own = _reference_time(suite, case)
        times = [
            f"{taken:.3f}" + (f" ({taken / own:.1f}x)" if name != suite.reference else "")
            if taken is not None
            else "not installed"
            for name, taken in case.milliseconds.items()
        ]
        lines.append([case.scene, str(case.robots), *times, *(f"{fact:.3g}" for fact in case.facts.values())])
    widths = [max(len(line[column]) for line in lines) for column in range(len(head))]
    rows = ["  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)) for line in lines]
    return "\n".join([f"{suite.title}; median in ms, in brackets the ratio to {suite.reference}", *rows])
