"""Finds the free parameters of Table II's world from its first column alone: `higvf fit`.

The rule, stated before the search whose result is shipped:

1. Admissible is a sample (`fit_space.SPACE`) whose gains a scenario file would accept, and whose run without a human
   puts the fires out in the printed order 1-2-3-4-5 with no clearance below zero.
2. The misfit of a sample is the largest of its relative errors in column 1, each in units of what is allowed: 5 % for
   each of the five loss areas, 2 % for their total. The best sample has the smallest misfit, to 0.02: one control
   period moves the area of fire 1 by 0.1 %.
3. Ties go to the sample nearest to the project's default gains and bar, each parameter as a share of its range.

Columns 2 and 3 have no part in it. The search is differential evolution from latin hypercubes, restarted; every sample
that was ever run is kept. Those with a misfit of at most 1 are equally good by what is asked of column 1: they show
what it leaves open.

Storn, Price, Differential evolution, J. Global Optimization 11 (1997).
"""

from collections.abc import Callable, Iterable, Sequence, Sized
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from scipy.optimize import OptimizeResult, differential_evolution
from scipy.stats import qmc

from higvf_console.core.arrays import Floats
from higvf_console.core.errors import HigvfError, ScenarioError
from higvf_console.lab.fit.fire_run import FireRun, fight
from higvf_console.lab.fit.space import DURATION, SPACE, Sample, distance, on_grid, world_of
from higvf_console.lab.fit.table2 import ALONE, FIRE_LIMIT, TOTAL_LIMIT, relative_errors, summed, total
from higvf_console.lab.reproduce.paper import COLUMNS
from higvf_console.world.setup import Setup

ACCEPTABLE = 1.0  # misfit
RESTARTS = 4
POPULATION = 48
_HOPELESS = 0.15  # relative error of one fire at which a run is ended
_RESOLUTION = 0.02  # of the misfit
_REFUSED = 100.0  # objective of a sample that cannot be run


class Trial(NamedTuple):
    """A sample and what it gave.

    Attributes:
        sample: on the grid.
        errors: relative errors of the five loss areas of column 1; empty where the sample cannot be run.
        admissible: by the first part of the rule.
        objective: the misfit; where not admissible, that of the fires that are out, and 10, and 5 a fire that is left.
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
    column = COLUMNS[ALONE]
    run = fight(setup, DURATION, enough=(1.0 + _HOPELESS) * np.array(column.loss_area))
    return judged(sample, run)


def judged(sample: Sample, run: FireRun) -> Trial:
    """A sample with the errors of its run."""
    column = COLUMNS[ALONE]
    errors = tuple(relative_errors(run, column))
    if run.order == column.order and run.min_clearance >= 0.0:
        return Trial(sample, errors, True, misfit(errors, total(run) / summed(column) - 1.0))
    left = len(errors) - len(run.order)
    return Trial(sample, errors, False, misfit([errors[fire - 1] for fire in run.order], 0.0) + 10.0 + 5.0 * left)


def misfit(errors: Iterable[float], total_error: float) -> float:
    """The largest relative error of column 1 in units of what is allowed."""
    return max([abs(error) / FIRE_LIMIT for error in errors] + [abs(total_error) / TOTAL_LIMIT])


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

    def rank(trial: Trial) -> tuple[float, float, Sample]:
        return round(trial.objective / _RESOLUTION), distance(trial.sample, defaults), trial.sample

    return min(admissible, key=rank)


def acceptable(trials: Iterable[Trial], best: Trial) -> list[Trial]:
    """Admissible samples that meet what is asked of column 1; where not even the best does, those as good as it."""
    most = max(best.objective, ACCEPTABLE)
    return sorted(trial for trial in trials if trial.admissible and trial.objective <= most)


def widest(trials: Iterable[Trial], first: Trial, most: int) -> list[Trial]:
    """At most `most` samples that show how far they lie apart: `first`, then each the farthest from all before."""
    rest = [trial for trial in trials if trial.sample != first.sample]
    kept = [first]
    gap = np.array([distance(trial.sample, first.sample) for trial in rest])
    while len(kept) < min(most, len(rest) + 1):
        farthest = int(np.argmax(gap))
        kept.append(rest[farthest])
        gap = np.minimum(gap, [distance(trial.sample, kept[-1].sample) for trial in rest])
    return kept
