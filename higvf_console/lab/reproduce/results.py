"""Findings of all selected cases, and their form for JSON."""

import json
import math
import platform
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any, NamedTuple

from tqdm import tqdm

from higvf_console.control.forms import name_of
from higvf_console.lab.reproduce.case import Case, Findings, Measurement
from higvf_console.lab.reproduce.report.notes import DIFFERENCES
from higvf_console.lab.reproduce.runs import Run, Runs

SCHEMA = 1
_PACKAGES = ("higvf-console", "numpy", "scipy", "numba", "osqp", "matplotlib")


class Result(NamedTuple):
    """A case and its findings."""

    case: Case
    findings: Findings


class Results(NamedTuple):
    """A complete reproduction.

    Attributes:
        made: time stamp, ISO 8601; the only part in which two reproductions differ.
        versions: versions of Python and the packages.
        results: results in the order of the paper.
    """

    made: str
    versions: dict[str, str]
    results: tuple[Result, ...]

    @property
    def runs(self) -> tuple[Run, ...]:
        """All distinct runs."""
        return tuple({run.spec: run for result in self.results for run in result.findings.runs}.values())

    def plain(self) -> dict[str, Any]:
        """The results without pictures, ready for JSON; numbers that are not finite become null."""
        whole: dict[str, Any] = {
            "version": SCHEMA,
            "made": self.made,
            "versions": self.versions,
            "cases": [_plain_case(result) for result in self.results],
            "runs": [plain_run(run) for run in self.runs],
            "differences": [{"what": what, "why": why} for what, why in DIFFERENCES],
        }
        for result in self.results:
            whole.update(result.findings.data)
        return _finite(whole)

    def json(self) -> str:
        """The JSON text of the results."""
        return json.dumps(self.plain(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def run_cases(cases: Sequence[Case]) -> Results:
    """Runs cases in sequence, with a progress bar on standard error."""
    runs, results = Runs(), list[Result]()
    with tqdm(cases, unit="case", file=sys.stderr, bar_format="{l_bar}{bar:30}| {n_fmt}/{total_fmt} {postfix}") as bar:
        for case in bar:
            bar.set_postfix_str(case.name)
            results.append(Result(case, case.run(runs)))
    made = datetime.now(UTC).isoformat(timespec="seconds")
    return Results(made, _versions(), tuple(results))


def _versions() -> dict[str, str]:
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found


def plain_run(run: Run) -> dict[str, Any]:
    """Identification and key figures of a run: command, forms, seed, figures, digest of the trajectory."""
    report = run.report
    return {
        "command": str(run.spec),
        "scenario": report["scenario"],
        "forms": name_of(run.setup.params.forms),
        "seed": report["seed"],
        "duration_s": report["duration_s"],
        "ticks": report["ticks"],
        "extinguished": report["extinguished"],
        "loss_area_total_m2": report["loss_area_total_m2"],
        "min_clearance_margin_m": report["min_clearance_margin_m"],
        "infeasible_ticks": report["infeasible_ticks"],
        "deadlock_s": report["deadlock_s"],
        "certificates": report["certificates"],
        "digest": report["digest"],
    }


def _plain_case(result: Result) -> dict[str, Any]:
    case, findings = result
    judged = [m.holds for m in findings.measurements if m.holds is not None]
    return {
        "name": case.name,
        "title": case.title,
        "paper": case.paper,
        "how": case.how,
        "holds": all(judged),
        "measurements": [_plain_measurement(m) for m in findings.measurements],
        "pictures": [{"name": p.name, "caption": p.caption} for p in findings.pictures],
        "runs": [str(run.spec) for run in findings.runs],
        "notes": list(findings.notes),
    }


def _plain_measurement(m: Measurement) -> dict[str, Any]:
    return {"what": m.what, "value": m.value, "unit": m.unit, "expected": m.expected, "holds": m.holds}


def _finite(value: Any) -> Any:
    match value:
        case dict():
            return {key: _finite(item) for key, item in value.items()}
        case list() | tuple():
            return [_finite(item) for item in value]
        case float() if not math.isfinite(value):
            return None
        case _:
            return value
