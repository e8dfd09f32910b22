"""The study of `higvf fit`: search, selection, prediction and uncertainty, as one JSON object and one scenario file.

search        samples that fit column 1                      lab/fit/search.py
choose        the sample that the selection rule picks       lab/fit/search.py
predict       columns 2 and 3 of the chosen world            lab/fit/table2.py
spread        predictions of all acceptable worlds           lab/fit/report.py
sensitivity   central differences about the chosen world     lab/fit/report.py
"""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from higvf_console.core.errors import ScenarioError
from higvf_console.lab.fit.firefighting import Branch
from higvf_console.lab.fit.kept import KeptTrials
from higvf_console.lab.fit.report import sensitivity, spread
from higvf_console.lab.fit.search import FORM, POPULATION, RESTARTS, Trial, acceptable, attempt, choose, search, widest
from higvf_console.lab.fit.space import BAR_HALF_WIDTH, DURATION, NAMES, SPACE, Sample, sample_of, unit, world_of
from higvf_console.lab.fit.table2 import Columns, as_json, open_strokes, run_columns
from higvf_console.lab.progress import ProgressBar
from higvf_console.scenario.scenario import Scenario, load_scenario
from higvf_console.world.setup import Setup

BASE = "firefighting"  # robots, fires and circles of Table I, with the project's own parameters and bar
SPREAD_SAMPLES = 60
CHUNK = 4  # samples per job of a worker


class Study(NamedTuple):
    """Result of a fit.

    Attributes:
        result: dictionary ready for JSON.
        scenario: YAML text of the chosen world.
    """

    result: dict[str, Any]
    scenario: str


def study(runs: int, seed: int, workers: int | None = None, keep: Path | None = None) -> Study:
    """Runs the study; the same runs and seed give the same numbers for any number of workers.

    Args:
        runs: number of samples to try.
        seed: seed of the search.
        workers: number of processes; None = one per processor.
        keep: file of trials, from which the search goes on and to which it writes; None = none.

    Raises:
        HigvfError: there are too few runs, no sample extinguishes the fires in the printed order, or `keep` cannot be
            used.
    """
    base = load_scenario(BASE)
    setup = base.setup()
    kept = KeptTrials(FORM, keep, partial(attempt, base=setup))
    bar = ProgressBar("fit", runs)
    with ProcessPoolExecutor(workers) as pool:

        def evaluate(samples: Sequence[Sample]) -> list[Trial]:
            found = kept.trials(samples, lambda new: list(pool.map(partial(attempt, base=setup), new, chunksize=CHUNK)))
            bar.advance(len(samples), f"smallest objective {kept.least():.2f}")
            return found

        def predict(samples: Sequence[Sample]) -> list[Columns | None]:
            return list(pool.map(partial(predicted, base=setup), samples, chunksize=CHUNK))

        trials = search(runs, seed, evaluate)
        bar.end()
        best = choose(trials, sample_of(setup))
        good = acceptable(trials, best)
        shown = widest(good, best, SPREAD_SAMPLES)
        (columns,) = predict([best.sample])
        assert columns is not None  # its world has been run before
        result = {
            **head(len(trials), seed, best.sample),
            **as_json(columns),
            "misfit": best.objective,
            "acceptable": len(good),
            "spread": spread([trial.sample for trial in shown], predict),
            "sensitivity": sensitivity(best.sample, predict),
        }
    return Study(result, scenario_text(best, base))


def head(runs: int, seed: int, chosen: Sample, restarts: int = RESTARTS) -> dict[str, Any]:
    """What the result of a fit begins with: the search, its space and the chosen sample."""
    return {
        "runs": runs,
        "seed": seed,
        "restarts": restarts,
        "population": POPULATION,
        "space": [{**free._asdict(), "unit": unit(free.name)} for free in SPACE],
        "chosen": dict(zip(NAMES, chosen, strict=True)),
        "bar_half_width_m": BAR_HALF_WIDTH,
    }


def predicted(sample: Sample, base: Setup) -> Columns | None:
    """All three columns of the world of a sample; None if it cannot be run."""
    try:
        setup = world_of(sample, base)
    except ScenarioError:
        return None
    return run_columns(setup, DURATION, strokes())


@cache
def strokes() -> dict[str, Branch]:
    """The shipped operators, opened once in each process."""
    return open_strokes(load_scenario(BASE))


def scenario_text(chosen: Trial, base: Scenario) -> str:
    """The text of the scenario file of a sample: `base` with the fitted numbers, listed in a comment."""
    description = "The firefighting world whose open numbers were fitted to Table II, column 1 (higvf fit)."
    comment = _HEAD.format(fitted=listed(chosen.sample), misfit=chosen.objective)
    return comment + world_text(chosen.sample, base, "Table II", description)


def listed(sample: Sample) -> str:
    """The values of a sample as lines of a comment."""
    return "\n".join(
        f"#   {name:26} {value:>8g} {unit(name)}".rstrip() for name, value in zip(NAMES, sample, strict=True)
    )


def world_text(sample: Sample, base: Scenario, title: str, description: str) -> str:
    """The YAML of `base` with the parameters and the bar of a sample."""
    values = dict(zip(NAMES, sample, strict=True))
    content: dict[str, Any] = yaml.safe_load(base.text)
    content["title"], content["description"] = title, description
    x, low, high = (values[f"bar.{end}"] for end in ("x", "y_low", "y_high"))
    content["obstacles"]["bars"] = [{"from_m": [x, low], "to_m": [x, high], "half_width_m": BAR_HALF_WIDTH}]
    content["parameters"] = {}
    for name, value in values.items():
        group, _, key = name.partition(".")
        if group != "bar":
            content["parameters"].setdefault(group, {})[key] = value
    content["duration_s"] = DURATION
    return yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=118)


_HEAD = """\
# Table I of the paper, with what the paper leaves open fitted to the first column of Table II (without human) alone:
#
{fitted}
#
# Rule: the smallest misfit, the largest relative error of column 1 in units of what is allowed (5 % a fire, 2 % their
# total; here {misfit:.2f}); ties go to the nearest to the project's defaults. Columns 2 and 3 are predictions.
# Written by `higvf fit`, like table2-fit.json beside it; do not edit.
"""
