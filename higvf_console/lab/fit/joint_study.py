"""The study of `higvf fit --columns all`: search, selection, margins and spread, as JSON and as a scenario file.

search, explore   samples that meet every number of Table II    lab/fit/search.py, lab/fit/joint.py
choose            the world that the selection rule picks       lab/fit/joint.py
neighbours        misfits with one parameter 1 % off            lab/fit/joint.py
basins            where the worlds that meet the table lie      lab/fit/joint.py
"""

import json
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

from higvf_console.core.errors import HigvfError
from higvf_console.lab.fit.firefighting import milestones
from higvf_console.lab.fit.joint import (
    FORM,
    HIDDEN,
    KNOWN,
    NEIGHBOUR,
    JointTrial,
    attempt_all,
    basins,
    choose_joint,
    explore,
    joint_misfit,
    neighbours,
    sight_of_last,
)
from higvf_console.lab.fit.kept import KeptTrials
from higvf_console.lab.fit.report import quantity_ranges
from higvf_console.lab.fit.search import POPULATION, search, widest
from higvf_console.lab.fit.space import DURATION, NAMES, Sample, world_of
from higvf_console.lab.fit.study import (
    BASE,
    CHUNK,
    SPREAD_SAMPLES,
    Study,
    head,
    listed,
    predicted,
    strokes,
    world_text,
)
from higvf_console.lab.fit.table2 import Columns, as_json
from higvf_console.lab.progress import ProgressBar
from higvf_console.scenario.scenario import Scenario, data_folder, load_scenario
from higvf_console.world.setup import Setup

JOINT_SCENARIO = "table2-joint"
JOINT_RESTARTS = 2  # fewer than for column 1: worlds that meet every number are rarer, and take longer to find


def joint_study(runs: int, seed: int, workers: int | None = None, keep: Path | None = None) -> Study:
    """Runs the study; the same runs and seed give the same numbers for any number of workers.

    Args:
        runs: number of samples to try.
        seed: seed of the search.
        workers: number of processes; None = one per processor.
        keep: file of trials, from which the search goes on and to which it writes; None = none.

    Raises:
        HigvfError: there are too few runs, no sample meets the table, or `keep` cannot be used.
    """
    searched = 3 * runs // 4
    if searched < JOINT_RESTARTS * POPULATION:
        least = -(-4 * JOINT_RESTARTS * POPULATION // 3)
        raise HigvfError(
            f"--runs {runs}: give {least} or more for --columns all (a quarter steps from the best worlds)"
        )
    base = load_scenario(BASE)
    setup = base.setup()
    kept = KeptTrials(FORM, keep, partial(_attempt, base=setup))
    bar = ProgressBar("fit", runs)
    with ProcessPoolExecutor(workers) as pool:

        def evaluate(samples: Sequence[Sample]) -> list[JointTrial]:
            def run(new: Sequence[Sample]) -> list[JointTrial]:
                return list(pool.map(partial(_attempt, base=setup), new, chunksize=CHUNK))

            found = kept.trials(samples, run)
            bar.advance(len(samples), f"smallest objective {kept.least():.2f}")
            return found

        def misfits(samples: Sequence[Sample]) -> list[float]:
            return list(pool.map(partial(_misfit, base=setup), samples, chunksize=CHUNK))

        trials = {
            trial.sample: trial for trial in [*evaluate(KNOWN), *search(searched, seed, evaluate, JOINT_RESTARTS)]
        }
        trials = explore(trials.values(), runs - len(trials), seed, evaluate)
        bar.end()
        best, margin = choose_joint(trials, misfits)
        met = sorted(trial for trial in trials if trial.meets)
        shown = [trial.sample for trial in widest(met, best, SPREAD_SAMPLES)]
        outcomes = list(pool.map(partial(predicted, base=setup), shown, chunksize=CHUNK))
        near = misfits(neighbours(best.sample))
    alone = milestones(world_of(best.sample, setup), DURATION)
    result = {
        "columns": FORM.columns,
        **head(len(trials), seed, best.sample, JOINT_RESTARTS),
        **as_json(_run(outcomes[0]), every_loss=True),
        "misfit": best.objective,
        "margin": margin,
        "neighbours": {
            "change": NEIGHBOUR,
            "meet": sum(misfit <= 1.0 for misfit in near),
            "misfit": {name: near[2 * place : 2 * place + 2] for place, name in enumerate(NAMES)},
        },
        "hidden_s": best.hidden,
        "sight_rad": sight_of_last(alone, world_of(best.sample, setup)),
        "worlds": len(met),
        "hidden_worlds": sum(trial.hidden >= HIDDEN for trial in met),
        "basins": basins(met),
        "spread": quantity_ranges([_run(columns) for columns in outcomes]),
    }
    return Study(result, joint_scenario_text(best, margin, base))


def kept_joint_fit() -> dict[str, Any]:
    """The stored result of the `higvf fit --columns all` that chose the shipped world."""
    return json.loads((data_folder() / "scenarios" / f"{JOINT_SCENARIO}-fit.json").read_text(encoding="utf-8"))


def joint_scenario_text(chosen: JointTrial, margin: float, base: Scenario) -> str:
    """The text of the scenario file of a sample: `base` with the fitted numbers, listed in a comment."""
    comment = _HEAD.format(fitted=listed(chosen.sample), misfit=chosen.objective, margin=margin)
    return comment + world_text(chosen.sample, base, "Table II, joint fit", _DESCRIPTION)


def _attempt(sample: Sample, base: Setup) -> JointTrial:
    return attempt_all(sample, base, strokes())


def _misfit(sample: Sample, base: Setup) -> float:
    return joint_misfit(predicted(sample, base))


def _run(columns: Columns | None) -> Columns:
    assert columns is not None  # the world has been run before
    return columns


_DESCRIPTION = (
    "The firefighting world fitted to all columns of Table II: a fit, not a prediction (higvf fit --columns all)."
)
_HEAD = """\
# Table I of the paper, with what the paper leaves open fitted to all three columns of Table II at once, the strokes of
# the operator unchanged. This is a fit to every number, not a prediction; table2.yaml is fitted to column 1 alone.
#
{fitted}
#
# Rule: every number within its limit (5 % a fire, 2 % a total, 1 point a reduction), then the largest margin when one
# parameter is 1 % off. Misfit, the largest error in units of its limit: {misfit:.2f}; margin: {margin:.2f}.
# Written by `higvf fit --columns all`, like table2-joint-fit.json beside it; do not edit.
"""
