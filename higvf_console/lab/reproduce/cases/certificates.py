"""Certificates of every run of the report."""

import math

from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Table, within
from higvf_console.lab.reproduce.cases import circles, firefighting, physical
from higvf_console.lab.reproduce.certificates import Certificates, certificates_of
from higvf_console.lab.reproduce.runs import Run, Runs


def run_certificates(runs: Runs) -> Findings:
    """Checks all runs of the other cases."""
    made = [runs.get(spec) for spec in (*circles.specs(), *firefighting.SPECS.values(), *physical.SPECS)]
    found = [certificates_of(run) for run in made]
    return Findings(
        (
            Measurement("Runs in which |v_s| kept below its bound at every moment", sum(c.bounded for c in found), "",
                        f"all {len(found)}", all(c.bounded for c in found)),
            within("Largest share of the bound that |v_s| took", max(c.intention / c.bound for c in found), "", 0.0, 1.0,
                   "at most 1"),
            within("Smallest lambda_2 of the links", min(c.lambda_2 for c in found), "", 1e-9, math.inf,
                   "above 0: the team is connected"),
            within("Largest value of the sampling condition dt rate h_near²", max(c.sampling for c in found), "", 0.0, 1.0,
                   "at most 1"),
            within("Smallest barrier function h", min(c.least_h for c in found), "", 0.0, math.inf, "never negative"),
            Measurement("Largest dt times rate of the intention update", max(c.explicit_limit for c in found), "",
                        "any: the semi-implicit step is stable at each (explicit: below 2)", True),
        ),
        runs=tuple(made),
        tables=(_table(made, found),),
        notes=("Theorem 1 of the paper bounds |v_s| more loosely; the bound here does not depend on the number of"
               " robots.",),
        data={"certificates": {str(run.spec): c._asdict() for run, c in zip(made, found, strict=True)}},
    )  # fmt: skip


def _table(runs: list[Run], found: list[Certificates]) -> Table:
    head = ("run", "largest |v_s|", "bound", "lambda_2", "sampling", "least h", "clearance [m]")
    rows = tuple(
        (str(run.spec).removeprefix("higvf run ").replace(" --headless", ""), f"{c.intention:.3f}", f"{c.bound:.3f}",
         f"{c.lambda_2:.3g}", f"{c.sampling:.3g}", f"{c.least_h:.3g}", f"{run.clearance.min():.2f}")
        for run, c in zip(runs, found, strict=True)
    )  # fmt: skip
    return Table("Each run", head, rows)


CASES = (
    Case("certificates", "Certificates", "Appendices A and B, and section V: stability, bounds, invariance.",
         "Conditions of the parameters, and every moment of every run of the other cases.", run_certificates),
)  # fmt: skip
