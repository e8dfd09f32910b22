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
from typing import Any, NamedTuple

import yaml

from higvf_console.core.errors import ScenarioError
from higvf_console.lab.fit.firefighting import Branch
from higvf_console.lab.fit.report import sensitivity, spread
from higvf_console.lab.fit.search import POPULATION, RESTARTS, Trial, acceptable, attempt, choose, search, widest
from higvf_console.lab.fit.space import BAR_HALF_WIDTH, DURATION, NAMES, SPACE, Sample, sample_of, unit, world_of
from higvf_console.lab.fit.table2 import Columns, as_json, open_strokes, run_columns
from higvf_console.lab.progress import ProgressBar
from higvf_console.scenario.scenario import Scenario, load_scenario
from higvf_console.world.setup import Setup

BASE = "firefighting"  # robots, fires and circles of Table I, with the project's own parameters and bar
SPREAD_SAMPLES = 60
_CHUNK = 4  # samples per job of a worker


class Study(NamedTuple):
    """Result of a fit.

    Attributes:
        result: dictionary ready for JSON.
        scenario: YAML text of the chosen world.
    """

    result: dict[str, Any]
    scenario: str


def study(runs: int, seed: int, workers: int | None = None) -> Study:
    """Runs the study; the same runs and seed give the same numbers for any number of workers.

    Args:
        runs: number of samples to try.
        seed: seed of the search.
        workers: number of processes; None = one per processor.

    Raises:
        HigvfError: there are too few runs, or no sample extinguishes the fires in the printed order.
    """
    base = load_scenario(BASE)
    setup = base.setup()
    bar = ProgressBar("fit", runs)
    with ProcessPoolExecutor(workers) as pool:

        def evaluate(samples: Sequence[Sample]) -> list[Trial]:
            trials = list(pool.map(partial(attempt, base=setup), samples, chunksize=_CHUNK))
            bar.advance(len(samples))
            return trials

        def predict(samples: Sequence[Sample]) -> list[Columns | None]:
            return list(pool.map(partial(predicted, base=setup), samples, chunksize=_CHUNK))

        trials = search(runs, seed, evaluate)
        best = choose(trials, sample_of(setup))
        good = acceptable(trials, best)
        shown = widest(good, best, SPREAD_SAMPLES)
        (columns,) = predict([best.sample])
        assert columns is not None  # its world has been run before
        result = {
            "runs": len(trials),
            "seed": seed,
            "restarts": RESTARTS,
            "population": POPULATION,
            "space": [{**free._asdict(), "unit": unit(free.name)} for free in SPACE],
            "chosen": dict(zip(NAMES, best.sample, strict=True)),
            "bar_half_width_m": BAR_HALF_WIDTH,
            **as_json(columns),
            "misfit": best.objective,
            "acceptable": len(good),
            "spread": spread([trial.sample for trial in shown], predict),
            "sensitivity": sensitivity(best.sample, predict),
        }
    return Study(result, scenario_text(best, base))


def predicted(sample: Sample, base: Setup) -> Columns | None:
    """All three columns of the world of a sample; None if it cannot be run."""
    try:
        setup = world_of(sample, base)
    except ScenarioError:
        return None
    return run_columns(setup, DURATION, _strokes())


@cache
def _strokes() -> dict[str, Branch]:
    return open_strokes(load_scenario(BASE))


def scenario_text(chosen: Trial, base: Scenario) -> str:
    """The text of the scenario file of a sample: `base` with the fitted numbers, listed in a comment."""
    values = dict(zip(NAMES, chosen.sample, strict=True))
    content: dict[str, Any] = yaml.safe_load(base.text)
    content["title"] = "Table II"
    content["description"] = "The firefighting world whose open numbers were fitted to Table II, column 1 (higvf fit)."
    x, low, high = (values[f"bar.{end}"] for end in ("x", "y_low", "y_high"))
    content["obstacles"]["bars"] = [{"from_m": [x, low], "to_m": [x, high], "half_width_m": BAR_HALF_WIDTH}]
    content["parameters"] = {}
    for name, value in values.items():
        group, _, key = name.partition(".")
        if group != "bar":
            content["parameters"].setdefault(group, {})[key] = value
    content["duration_s"] = DURATION
    fitted = "\n".join(f"#   {name:26} {value:>8g} {unit(name)}".rstrip() for name, value in values.items())
    return _HEAD.format(fitted=fitted, misfit=chosen.objective) + yaml.safe_dump(
        content, sort_keys=False, default_flow_style=None, width=118
    )


_HEAD = """\
# Table I of the paper, with what the paper leaves open fitted to the first column of Table II (without human) alone:
#
{fitted}
#
# Rule: the smallest misfit, the largest relative error of column 1 in units of what is allowed (5 % a fire, 2 % their
# total; here {misfit:.2f}); ties go to the nearest to the project's defaults. Columns 2 and 3 are predictions.
# Written by `higvf fit`, like table2-fit.json beside it; do not edit.
"""
