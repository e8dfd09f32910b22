"""Compares each doubtful equation in its printed and its corrected form by a number that shows the failure."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.intention.intention import map_radius
from higvf_console.control.parameters import Parameters
from higvf_console.lab.reproduce import experiments
from higvf_console.lab.reproduce.case import Case, Findings, Measurement, Table
from higvf_console.lab.reproduce.runs import Runs
from higvf_console.scenario.scenario import load_scenario


class Doubt(NamedTuple):
    """A doubtful equation.

    Attributes:
        field: name of the equation in `Forms`.
        equation: number and name of the equation.
        printed: printed form.
        corrected: corrected form.
        shown: what the experiment measures.
        unit: unit of the measured value.
        measure: the experiment, from parameters to the measured value.
        low: lower limit of the values for which the equation works.
        high: upper limit of these values.
    """

    field: str
    equation: str
    printed: str
    corrected: str
    shown: str
    unit: str
    measure: Callable[[Parameters], float]
    low: float
    high: float

    def works(self, number: float) -> bool:
        """Whether the measured value is within the limits; False for NaN."""
        return self.low <= number <= self.high


DOUBTS = (
    Doubt(
        field="formation",
        equation="[12] formation",
        printed="-| |r| - d | r/|r|",
        corrected="-k_form (|r| - d) r/|r|",
        shown="distance of two robots after 30 s, initially 30 m, desired d = 60 m",
        unit="m",
        measure=experiments.formation_distance,
        low=59.0,
        high=61.0,
    ),
    Doubt(
        field="intention",
        equation="[15] shared intention",
        printed="a map with weights, not rates",
        corrected="semi-implicit step of its ODE",
        shown="largest |v_s| in the first second for a human intention of 1",
        unit="",
        measure=experiments.intention_peak,
        low=0.0,
        high=1.0,
    ),
    Doubt(
        field="target",
        equation="[11] robot intention",
        printed="-θ φ ∇φ, φ in m²",
        corrected="θ sat(distance / band) towards the fire",
        shown="largest |v_t| at the start of Table I; a human intention is at most 1",
        unit="",
        measure=experiments.target_length,
        low=0.0,
        high=math.pi,
    ),
    Doubt(
        field="human",
        equation="[9] human intention",
        printed="zero-in only: Π S · X_P",
        corrected="composite step with Z X_R, once, on the velocity",
        shown="distance that a robot covers in 15 s; a circle on its path ends at 220 m",
        unit="m",
        measure=experiments.way_past_obstacle,
        low=250.0,
        high=math.inf,
    ),
    Doubt(
        field="speed",
        equation="[17] speed",
        printed="C v/|v|",
        corrected="C v/max(|v|, δ)",
        shown="blended speed at rest, v_s = 0 and v_f = 0",
        unit="m/s",
        measure=experiments.speed_at_rest,
        low=0.0,
        high=0.0,
    ),
    Doubt(
        field="blending",
        equation="[19] blending",
        printed="k_s a/(k_s a + k_f b)",
        corrected="k_s a/(k_s a + k_f b + δ)",
        shown="λ at |v_s| = 1e-9, v_f = 0; continuity requires λ(0, 0) = 0",
        unit="",
        measure=experiments.weight_near_rest,
        low=0.0,
        high=1e-3,
    ),
    Doubt(
        field="bump",
        equation="[29]-[31] bump",
        printed="φ in squared lengths",
        corrected="φ dimensionless",
        shown="S at 0.01 m outside the repulsive boundary, where S = 0",
        unit="",
        measure=experiments.bump_at_boundary,
        low=0.0,
        high=1e-3,
    ),
    Doubt(
        field="fire_constraint",
        equation="[27] constraint of a growing fire",
        printed="no term for the growth",
        corrected="- (R_next² - R²)/(2 dt)",
        shown="minimum clearance of a paused robot beside a fire that grows by 1 m/s",
        unit="m",
        measure=experiments.clearance_at_fire,
        low=0.0,
        high=math.inf,
    ),
    Doubt(
        field="h_index",
        equation="[27] index of h",
        printed="h_ij in the constraint of obstacle k",
        corrected="h_ik",
        shown="minimum clearance on a path through the second of two circles",
        unit="m",
        measure=experiments.clearance_by_index,
        low=0.0,
        high=math.inf,
    ),
)


def printed_alone(field: str) -> Parameters:
    """The default parameters with one equation as printed."""
    return Parameters(forms=Forms()._replace(**{field: PRINTED}))


def run_forms(_: Runs) -> Findings:
    """Runs every experiment in both forms."""
    measured: list[Measurement] = []
    rows: list[tuple[str, ...]] = []
    with np.errstate(all="ignore"):
        for doubt in DOUBTS:
            good, bad = doubt.measure(Parameters()), doubt.measure(printed_alone(doubt.field))
            holds = doubt.works(good) and not doubt.works(bad)
            measured.append(
                Measurement(
                    f"{doubt.equation}: {doubt.shown}",
                    _number(good),
                    doubt.unit,
                    f"printed: {_shown(bad, doubt.unit)}",
                    holds,
                )
            )
            rows.append(
                (
                    doubt.equation,
                    doubt.printed,
                    doubt.corrected,
                    doubt.shown,
                    _shown(bad, doubt.unit),
                    _shown(good, doubt.unit),
                )
            )
    radius = _radius()
    measured.append(
        Measurement(
            "[15] as printed: spectral radius of the map for the team of Table I with robot 1 influenced",
            round(radius, 2),
            "",
            "above 1: the map diverges",
            radius > 1.0,
        )
    )
    return Findings(
        tuple(measured),
        tables=(
            Table(
                "Each equation as printed, with all others corrected",
                ("equation", "printed", "corrected", "measured", "value as printed", "value as corrected"),
                tuple(rows),
            ),
        ),
        notes=(
            "A check mark means that the corrected form works and the printed form fails. `higvf run SCENARIO --forms"
            " printed` runs a whole scenario in the printed forms.",
        ),
        data={
            "forms": {
                doubt.field: {"printed": cells[4], "corrected": cells[5]}
                for doubt, cells in zip(DOUBTS, rows, strict=True)
            }
        },
    )


def _radius() -> float:
    setup = load_scenario("firefighting").setup()
    robots = len(setup.start.motion.position)
    return map_radius(robots * np.eye(robots) - 1.0, 0, setup.params.intention)


def _number(value: float) -> float | str:
    return value if math.isfinite(value) else "NaN" if math.isnan(value) else "infinite"


def _shown(value: float, unit: str) -> str:
    number = _number(value)
    text = number if isinstance(number, str) else f"{number:.3g}"
    return f"{text} {unit}".strip()


CASES = (
    Case(
        "forms",
        "Printed and corrected equations",
        "Equations [9], [11], [12], [15], [17], [19], [27], [29]-[31] do not work as printed.",
        "One experiment per equation with the step of the engine, with one form switched at a time.",
        run_forms,
    ),
)
