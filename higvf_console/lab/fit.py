"""Finds the free parameters of Table II's world from its first column alone: `higvf fit`.

The rule, stated before any search:

1. Admissible is a sample (`fit_space.SPACE`) whose gains a scenario file would accept, and whose run without a human
   puts the fires out in the printed order 1-2-3-4-5 with no clearance below zero.
2. The best sample has the smallest largest relative error over the five loss areas of column 1, to 0.1 percentage
   points: one control period moves the area of fire 1 by that much.
3. Ties go to the smallest relative error of column 1's total, to 0.1 percentage points; then to the sample nearest to
   the project's default gains and bar.

Columns 2 and 3 have no part in it. The search is differential evolution from latin hypercubes, restarted; every sample
that was ever run is kept, so that the near-best fits show what column 1 leaves open.

Storn, Price, Differential evolution, J. Global Optimization 11 (1997).
"""

from collections.abc import Callable, Iterable, Sequence, Sized
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from scipy.optimize import OptimizeResult, differential_evolution
from scipy.stats import qmc

from higvf_console.arrays import Floats
from higvf_console.errors import HigvfError, ScenarioError
from higvf_console.lab.fire_run import FireRun, fight
from higvf_console.lab.fit_space import DURATION, SPACE, Sample, distance, on_grid, world_of
from higvf_console.lab.table2 import ALONE, PAPER, relative_errors
from higvf_console.sim.setup import Setup

NEAR = 0.01  # a near-best sample's largest relative error may exceed the best one's by this
RESTARTS = 4
POPULATION = 48
_HOPELESS = 0.15  # relative error of one fire at which a run is ended
_DIGITS = 3  # of errors that are compared
_REFUSED = 10.0  # objective of a sample that cannot be run


class Trial(NamedTuple):
    """A sample and what it gave.

    Attributes:
        sample: on the grid.
        errors: relative errors of the five loss areas of column 1; empty where the sample cannot be run.
        admissible: by the first part of the rule.
        objective: largest relative error; more by 0.2 a fire that is left, and by 1 where not admissible.
    """

    sample: Sample
    errors: tuple[float, ...]
    admissible: bool
    objective: float


Evaluate: TypeAlias = Callable[[Sequence[Sample]], Iterable[Trial]]


def attempt(sample: Sample, base: Setup) -> Trial:
    """Runs the world of a sample without a human and compares it with column 1."""
    try:
        setup = world_of(sample, base)
    except ScenarioError:
        return Trial(sample, (), False, _REFUSED)
    column = PAPER[ALONE]
    run = fight(setup, DURATION, enough=(1.0 + _HOPELESS) * np.array(column.loss_area))
    return judged(sample, run)


def judged(sample: Sample, run: FireRun) -> Trial:
    """A sample with the errors of its run."""
    column = PAPER[ALONE]
    errors = tuple(relative_errors(run, column))
    out = [errors[fire - 1] for fire in run.order]
    left = len(errors) - len(out)
    admissible = run.order == column.order and run.min_clearance >= 0.0
    worst = max((abs(error) for error in out), default=0.0)
    return Trial(sample, errors, admissible, worst if admissible else worst + 0.2 * left + 1.0)


def search(runs: int, seed: int, evaluate: Evaluate) -> list[Trial]:
    """About `runs` samples tried, each once; the same seed gives the same samples.

    Raises:
        HigvfError: fewer runs than one population of each restart.
    """
    share = runs // RESTARTS
    if share < POPULATION:
        raise HigvfError(f"--runs {runs}: give {RESTARTS * POPULATION} or more, {RESTARTS} populations of {POPULATION}")
    tried: dict[Sample, Trial] = {}

    def objective(points: Floats) -> Floats:
        samples = [on_grid(point) for point in points.T]
        new = [sample for sample in dict.fromkeys(samples) if sample not in tried]
        tried.update((trial.sample, trial) for trial in evaluate(new))
        return np.array([tried[sample].objective for sample in samples])

    bounds = np.array([[free.low, free.high] for free in SPACE])
    for number, entropy in enumerate(np.random.SeedSequence(seed).spawn(RESTARTS), start=1):
        rng = np.random.default_rng(entropy)
        start = qmc.scale(qmc.LatinHypercube(len(SPACE), rng=rng).random(POPULATION), *bounds.T)
        differential_evolution(
            objective, bounds, init=cast(Any, start), maxiter=runs, tol=0.0, rng=rng, polish=False, vectorized=True,
            updating="deferred", callback=_until(tried, number * share),
        )  # fmt: skip
    return list(tried.values())


def _until(tried: Sized, most: int) -> Callable[[OptimizeResult], None]:
    """Ends a restart before the generation that would try more than `most` samples."""

    def enough(intermediate_result: OptimizeResult) -> None:  # noqa: ARG001 (SciPy goes by this name)
        if len(tried) + POPULATION > most:
            raise StopIteration

    return enough


def choose(trials: Iterable[Trial], defaults: Sample) -> Trial:
    """The sample that the rule picks.

    Args:
        trials: of a search, in any order.
        defaults: the project's own gains and bar.

    Raises:
        HigvfError: no sample is admissible.
    """
    admissible = [trial for trial in trials if trial.admissible]
    if not admissible:
        raise HigvfError("no sample puts the fires out in the printed order; give more --runs")

    def rank(trial: Trial) -> tuple[float, float, float, Sample]:
        worst, total = round(trial.objective, _DIGITS), round(abs(total_error(trial)), _DIGITS)
        return worst, total, distance(trial.sample, defaults), trial.sample

    return min(admissible, key=rank)


def total_error(trial: Trial) -> float:
    """Relative error of column 1's total."""
    printed = np.array(PAPER[ALONE].loss_area)
    return float(printed @ np.array(trial.errors) / printed.sum())


def near_best(trials: Iterable[Trial], best: Trial, most: int) -> list[Trial]:
    """At most `most` admissible samples within `NEAR` of the best: it first, then each the farthest from all before."""
    rest = sorted(trial for trial in trials if trial.admissible and trial.objective <= best.objective + NEAR)
    rest = [trial for trial in rest if trial.sample != best.sample]
    kept = [best]
    gap = np.array([distance(trial.sample, best.sample) for trial in rest])
    while len(kept) < min(most, len(rest) + 1):
        farthest = int(np.argmax(gap))
        kept.append(rest[farthest])
        gap = np.minimum(gap, [distance(trial.sample, kept[-1].sample) for trial in rest])
    return kept
