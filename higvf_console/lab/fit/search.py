"""Fits the free parameters of the world of Table II to its first column: the search of `higvf fit`.

The selection rule was fixed before the search whose result is shipped:

1. A sample (`space.SPACE`) is admissible if a scenario file would accept its parameters, and if its run without a human
   extinguishes the fires in the printed order 1-2-3-4-5 with no clearance below zero.
2. The misfit of a sample is the largest of its relative errors in column 1, each divided by its limit: 5 % for each of
   the five loss areas, 2 % for their total. The best sample has the smallest misfit, at a resolution of 0.02: one
   control period changes the area of fire 1 by 0.1 %.
3. Ties go to the sample nearest to the project's default parameters and bar, each as a share of its range.

Columns 2 and 3 are not used. The search is differential evolution (Storn and Price, J. Global Optimization 11, 1997)
from Latin hypercubes with restarts; it keeps every sample that it ran. Samples with a misfit of at most 1 are
acceptable; their scatter shows what column 1 does not determine.
"""

from collections.abc import Callable, Iterable, Sequence, Sized
from typing import Any, NamedTuple, cast

import numpy as np
from scipy.optimize import OptimizeResult, differential_evolution
from scipy.stats import qmc

from higvf_console.core.arrays import Floats
from higvf_console.core.errors import HigvfError, ScenarioError
from higvf_console.lab.fit.firefighting import FirefightingRun, run_firefighting
from higvf_console.lab.fit.kept import AnyTrial, TrialForm
from higvf_console.lab.fit.space import DURATION, SPACE, Sample, distance, on_grid, world_of
from higvf_console.lab.fit.table2 import ALONE, FIRE_LIMIT, TOTAL_LIMIT, relative_errors, summed, total
from higvf_console.lab.reproduce.paper import COLUMNS
from higvf_console.world.setup import Setup

ACCEPTABLE = 1.0  # misfit
RESTARTS = 4
POPULATION = 48
ABORT_ERROR = 0.15  # relative error of one fire at which a run is ended early
_RESOLUTION = 0.02  # resolution of the misfit
REFUSED = 100.0  # objective of a sample that cannot be run


class Trial(NamedTuple):
    """A sample and the result of its run.

    Attributes:
        sample: the sample, on the grid.
        errors: relative errors of the five loss areas of column 1; empty if the sample cannot be run.
        admissible: whether it is admissible by rule 1.
        objective: the misfit; for a sample that is not admissible, the misfit of the extinguished fires, plus 10, plus
            5 for each fire that still burns.
    """

    sample: Sample
    errors: tuple[float, ...]
    admissible: bool
    objective: float


def _read(fields: Sequence[Any]) -> Trial:
    return Trial(tuple(fields[0]), tuple(fields[1]), *fields[2:])


FORM = TrialForm("1", _read)


def attempt(sample: Sample, base: Setup) -> Trial:
    """Runs the world of a sample without a human, and compares the result with column 1."""
    try:
        setup = world_of(sample, base)
    except ScenarioError:
        return Trial(sample, (), False, REFUSED)
    column = COLUMNS[ALONE]
    run = run_firefighting(setup, DURATION, limits=(1.0 + ABORT_ERROR) * np.array(column.loss_area))
    return judged(sample, run)


def judged(sample: Sample, run: FirefightingRun) -> Trial:
    """The trial of a sample and its run."""
    column = COLUMNS[ALONE]
    errors = tuple(relative_errors(run, column))
    if run.order == column.order and run.min_clearance >= 0.0:
        return Trial(sample, errors, True, misfit(errors, total(run) / summed(column) - 1.0))
    left = len(errors) - len(run.order)
    return Trial(sample, errors, False, misfit([errors[fire - 1] for fire in run.order], 0.0) + 10.0 + 5.0 * left)


def misfit(errors: Iterable[float], total_error: float) -> float:
    """The largest relative error of column 1, each divided by its limit."""
    return max([abs(error) / FIRE_LIMIT for error in errors] + [abs(total_error) / TOTAL_LIMIT])


def search(
    runs: int, seed: int, evaluate: Callable[[Sequence[Sample]], Iterable[AnyTrial]], restarts: int = RESTARTS
) -> list[AnyTrial]:
    """Tries about `runs` samples, each once; the same seed gives the same samples.

    Args:
        runs: number of samples.
        seed: seed of the search.
        evaluate: runs samples and returns their trials.
        restarts: number of searches that share the runs.

    Raises:
        HigvfError: `runs` is smaller than one population for each restart.
    """
    share = runs // restarts
    if share < POPULATION:
        raise HigvfError(
            f"--runs {runs}: give {restarts * POPULATION} or more ({restarts} restarts of {POPULATION} samples)"
        )
    tried: dict[Sample, AnyTrial] = {}

    def objective(points: Floats) -> Floats:
        samples = [on_grid(point) for point in points.T]
        new = [sample for sample in dict.fromkeys(samples) if sample not in tried]
        tried.update((trial.sample, trial) for trial in evaluate(new))
        return np.array([tried[sample].objective for sample in samples])

    bounds = np.array([[free.low, free.high] for free in SPACE])
    for number, entropy in enumerate(np.random.SeedSequence(seed).spawn(restarts), start=1):
        rng = np.random.default_rng(entropy)
        start = qmc.scale(qmc.LatinHypercube(len(SPACE), rng=rng).random(POPULATION), *bounds.T)
        differential_evolution(
            objective, bounds, init=cast(Any, start), maxiter=runs, tol=0.0, rng=rng, polish=False, vectorized=True,
            updating="deferred", callback=_until(tried, number * share),
        )  # fmt: skip
    return list(tried.values())


def _until(tried: Sized, most: int) -> Callable[[OptimizeResult], None]:
    """A callback that ends a restart before the number of tried samples exceeds `most`."""

    def enough(intermediate_result: OptimizeResult) -> None:  # noqa: ARG001 (SciPy requires this name)
        if len(tried) + POPULATION > most:
            raise StopIteration

    return enough


def choose(trials: Iterable[Trial], defaults: Sample) -> Trial:
    """The trial that the rule selects.

    Args:
        trials: trials of a search, in any order.
        defaults: the sample of the project's default parameters and bar.

    Raises:
        HigvfError: no sample is admissible.
    """
    admissible = [trial for trial in trials if trial.admissible]
    if not admissible:
        raise HigvfError("no sample extinguishes the fires in the printed order; give more --runs")

    def rank(trial: Trial) -> tuple[float, float, Sample]:
        return round(trial.objective / _RESOLUTION), distance(trial.sample, defaults), trial.sample

    return min(admissible, key=rank)


def acceptable(trials: Iterable[Trial], best: Trial) -> list[Trial]:
    """Admissible trials with a misfit of at most `ACCEPTABLE`, or as good as the best if that exceeds it."""
    most = max(best.objective, ACCEPTABLE)
    return sorted(trial for trial in trials if trial.admissible and trial.objective <= most)


def widest(trials: Iterable[AnyTrial], first: AnyTrial, most: int) -> list[AnyTrial]:
    """At most `most` trials that cover the spread: `first`, then repeatedly the one farthest from those chosen."""
    rest = [trial for trial in trials if trial.sample != first.sample]
    kept = [first]
    gap = np.array([distance(trial.sample, first.sample) for trial in rest])
    while len(kept) < min(most, len(rest) + 1):
        farthest = int(np.argmax(gap))
        kept.append(rest[farthest])
        gap = np.minimum(gap, [distance(trial.sample, kept[-1].sample) for trial in rest])
    return kept
