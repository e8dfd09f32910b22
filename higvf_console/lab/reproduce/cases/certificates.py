"""Certificates of every run of the report."""

import math
from typing import Any

from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Table, within
from higvf_console.lab.reproduce.cases import circles, firefighting, physical
from higvf_console.lab.reproduce.runs import Run, Runs


def run_certificates(runs: Runs) -> Findings:
    """Evaluates the certificates of all runs of the other cases."""
    made = [runs.get(spec) for spec in (*circles.specs(), *firefighting.SPECS.values(), *physical.SPECS)]
    found = [certificates_of(run) for run in made]
    measured = [_worst(kind, [certificates[kind] for certificates in found]) for kind in found[0]]
    unlinked = min(float(run.connectivity.min()) for run in made)
    return Findings(
        (
            *measured,
            within(
                "Minimum of lambda_2 over all runs", unlinked, "", 1e-6, math.inf, "above 0: the team stays connected"
            ),
            Measurement(
                "Control periods with an infeasible robot (constraints without a solution)",
                sum(run.report["infeasible_ticks"] for run in made),
                "",
                "0",
                not any(run.report["infeasible_ticks"] for run in made),
            ),
        ),
        runs=tuple(made),
        tables=(_table(made, found),),
        notes=(
            "The bound on |v_s| does not depend on the number of robots; Theorem 1 of the paper is looser.",
            "The corrected intention update is semi-implicit and unconditionally stable; the case `forms` tests the"
            " printed one.",
        ),
    )


def certificates_of(run: Run) -> dict[str, dict[str, Any]]:
    """The worst value of each certificate of a run, by the name of the condition without its details."""
    return {entry["name"].partition(" (")[0]: entry for entry in run.report["certificates"]}


def _worst(kind: str, entries: list[dict[str, Any]]) -> Measurement:
    first = entries[0]
    values = [entry["value"] for entry in entries if entry["value"] is not None]
    value = (min if first["least"] else max)(values, default=math.inf)
    limit = f"at {'least' if first['least'] else 'most'} {first['limit']:g}"
    return Measurement(
        f"{kind}: {first['symbol']}, worst value of all runs", value, "", limit, all(entry["met"] for entry in entries)
    )


def _table(runs: list[Run], found: list[dict[str, dict[str, Any]]]) -> Table:
    head = ("run", *[f"{kind}: {entry['symbol']}" for kind, entry in found[0].items()], "clearance margin [m]")
    rows = tuple(
        (
            str(run.spec).removeprefix("higvf run ").replace(" --headless", ""),
            *[_number(entry["value"]) for entry in certificates.values()],
            _number(run.report["min_clearance_margin_m"]),
        )
        for run, certificates in zip(runs, found, strict=True)
    )
    return Table("Certificates of each run", head, rows)


def _number(value: float | None) -> str:
    return "no hazard near" if value is None else f"{value:.3g}"


CASES = (
    Case(
        "certificates",
        "Certificates",
        "Appendices A and B, and section V: stability, bounds, invariance.",
        "Conditions on the parameters, and on every control period of every run of the other cases.",
        run_certificates,
    ),
)
