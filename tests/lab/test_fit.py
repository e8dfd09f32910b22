"""The fit of Table II's world: its grid, its rule, its search and the scenario that it writes."""

import math
import random
from collections.abc import Sequence

import numpy as np
import pytest

from higvf_console.errors import HigvfError, ScenarioError
from higvf_console.lab import fit, fit_space, fit_study
from higvf_console.lab.fit import Trial, attempt, choose, judged, near_best, search
from higvf_console.lab.fit_space import NAMES, SPACE, Sample, distance, on_grid, sample_of, unit, world_of
from higvf_console.lab.fit_study import BASE, SPREAD_SAMPLES, predicted, scenario_text, study
from higvf_console.lab.fit_text import summary
from higvf_console.lab.table2 import ALONE, PAPER, SCENARIO, Columns, verdicts
from higvf_console.session.scenario import load_scenario, parse_scenario
from higvf_console.sim.setup import Setup

CENTRE = on_grid(np.array([(free.low + free.high) / 2 for free in SPACE]))


@pytest.fixture(scope="module")
def base() -> Setup:
    return load_scenario(BASE).setup()


@pytest.fixture(scope="module")
def shipped() -> Sample:
    return sample_of(load_scenario(SCENARIO).setup())


def trial(sample: Sample = CENTRE, errors: Sequence[float] = (0.0,) * 5, admissible: bool = True) -> Trial:
    return Trial(sample, tuple(errors), admissible, max(map(abs, errors)))


def moved(name: str, by: float) -> Sample:
    return tuple(value + (by if key == name else 0.0) for key, value in zip(NAMES, CENTRE, strict=True))


def test_samples_lie_on_their_grid_and_stay_there() -> None:
    for point in np.random.default_rng(1).random((20, len(SPACE))):
        sample = on_grid(
            np.array([free.low + share * (free.high - free.low) for free, share in zip(SPACE, point, strict=True)])
        )
        assert on_grid(np.array(sample)) == sample
        for free, value in zip(SPACE, sample, strict=True):
            assert free.low <= value <= free.high
            assert value / free.step == pytest.approx(round(value / free.step), abs=1e-6)


def test_every_free_parameter_has_a_unit_and_a_default(base: Setup) -> None:
    assert len(sample_of(base)) == len(SPACE)
    assert unit("fires.extinguish_time") == "s/m"
    assert unit("bar.x") == "m"


def test_a_world_is_its_sample_and_back(base: Setup, shipped: Sample) -> None:
    assert sample_of(world_of(shipped, base)) == shipped


def test_gains_that_no_scenario_would_accept_are_refused(base: Setup) -> None:
    near = tuple(12.5 if name == "fires.stand_off" else value for name, value in zip(NAMES, CENTRE, strict=True))
    with pytest.raises(ScenarioError, match="stand_off"):
        world_of(near, base)
    refused = attempt(near, base)
    assert not refused.admissible
    assert refused.objective > attempt(CENTRE, base).objective


def test_a_world_without_its_bar_is_no_sample(base: Setup) -> None:
    with pytest.raises(ScenarioError, match="one upright bar, not 0"):
        sample_of(base._replace(world=base.world._replace(bars=np.zeros((0, 5)))))


def test_the_written_scenario_is_the_world_that_was_run(base: Setup, shipped: Sample) -> None:
    text = scenario_text(trial(shipped), load_scenario(BASE))
    setup = parse_scenario(text, "written.yaml").setup()
    for one, other in zip(
        (*setup.world, *setup.gains), (*(world := world_of(shipped, base)).world, *world.gains), strict=True
    ):
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()
    assert parse_scenario(text, "written.yaml").warnings == ()


def test_the_shipped_scenario_is_what_the_fit_writes(base: Setup, shipped: Sample) -> None:
    best = attempt(shipped, base)
    assert load_scenario(SCENARIO).text == scenario_text(best, load_scenario(BASE))
    assert best.admissible


def test_the_objective_is_the_largest_relative_error_of_column_1(base: Setup, shipped: Sample) -> None:
    columns = predicted(shipped, base)
    assert columns is not None
    errors = columns[ALONE].loss_area / np.array(PAPER[ALONE].loss_area) - 1.0
    assert attempt(shipped, base).objective == pytest.approx(np.abs(errors).max())


def test_an_order_other_than_the_papers_is_not_admissible(base: Setup, shipped: Sample) -> None:
    columns = predicted(shipped, base)
    assert columns is not None
    assert judged(shipped, columns[ALONE]).admissible
    assert not judged(shipped, columns[ALONE]._replace(order=(2, 1, 3, 4, 5))).admissible
    assert not judged(shipped, columns[ALONE]._replace(min_clearance=-1e-9)).admissible
    late = judged(shipped, columns[ALONE]._replace(order=(1, 2)))
    later = judged(shipped, columns[ALONE]._replace(order=(1,)))
    assert later.objective > late.objective > judged(shipped, columns[ALONE]).objective


def test_the_rule_takes_the_smallest_largest_error() -> None:
    good, bad = trial(errors=(0.02, -0.02, 0.02, 0, 0)), trial(errors=(0.0, 0.0, 0.0, 0.0, -0.025))
    assert choose([bad, good], CENTRE) == good


def test_ties_go_to_the_total_then_to_the_nearest_defaults() -> None:
    equal = trial(moved("bar.x", 5.0), errors=(0.02, 0.02, 0.0, 0.0, 0.0))
    total = trial(moved("bar.x", 5.0), errors=(0.0204, -0.0204, 0.0, 0.0, 0.0))
    nearer = total._replace(sample=moved("bar.x", 2.0))
    assert choose([equal, total], CENTRE) == total
    assert choose([equal, total, nearer], CENTRE) == nearer


def test_the_choice_does_not_depend_on_the_order_of_the_trials() -> None:
    random.seed(3)
    trials = [
        trial(moved("bar.x", float(k)), errors=[random.uniform(-0.01, 0.01) for _ in range(5)]) for k in range(50)
    ]
    best = choose(trials, CENTRE)
    for _ in range(5):
        random.shuffle(trials)
        assert choose(trials, CENTRE) == best
        assert near_best(trials, best, 10) == near_best(sorted(trials), best, 10)


def test_no_admissible_sample_is_an_error_that_says_what_to_do() -> None:
    with pytest.raises(HigvfError, match="give more --runs"):
        choose([trial(admissible=False)], CENTRE)


def test_near_best_samples_are_spread_wide_and_within_the_margin() -> None:
    best = trial(errors=(0.02, 0, 0, 0, 0))
    crowd = [trial(moved("bar.x", float(k)), errors=(0.025, 0, 0, 0, 0)) for k in (1, 2, 3, 40)]
    bad = trial(moved("bar.x", 60.0), errors=(0.031, 0, 0, 0, 0))
    kept = near_best([*crowd, bad, best], best, 3)
    assert kept[:2] == [best, crowd[3]]
    assert len(kept) == 3
    assert bad not in near_best([*crowd, bad, best], best, 100)


def bowl(samples: Sequence[Sample]) -> list[Trial]:
    """A cheap stand-in for runs: the nearer to the centre, the smaller the error."""
    return [Trial(sample, (0.0,) * 5, True, distance(sample, CENTRE)) for sample in samples]


def test_the_search_tries_each_sample_once_and_repeats_itself() -> None:
    batches: list[int] = []

    def evaluate(samples: Sequence[Sample]) -> list[Trial]:
        batches.append(len(samples))
        return bowl(samples)

    runs = 3 * fit.RESTARTS * fit.POPULATION
    trials = search(runs, 5, evaluate)
    assert len(trials) == len({one.sample for one in trials}) == sum(batches)
    assert len(trials) <= runs
    assert trials == search(runs, 5, bowl)
    assert trials != search(runs, 6, bowl)


def test_the_search_comes_nearer_with_more_runs() -> None:
    least = fit.RESTARTS * fit.POPULATION
    few, many = (min(one.objective for one in search(runs, 0, bowl)) for runs in (least, 12 * least))
    assert many < 0.7 * few


def test_too_few_runs_are_refused_with_the_least() -> None:
    least = fit.RESTARTS * fit.POPULATION
    with pytest.raises(HigvfError, match=f"--runs 7: give {least} or more"):
        search(7, 0, bowl)


def test_a_small_study_predicts_judges_and_writes_its_world(monkeypatch: pytest.MonkeyPatch, shipped: Sample) -> None:
    monkeypatch.setattr(fit, "RESTARTS", 1)
    monkeypatch.setattr(fit, "POPULATION", 6)
    monkeypatch.setattr(fit_study, "SPREAD_SAMPLES", 2)
    near = tuple(
        free._replace(low=value - 2 * free.step, high=value + 2 * free.step)
        for free, value in zip(SPACE, shipped, strict=True)
    )
    for module in (fit, fit_space, fit_study):
        monkeypatch.setattr(module, "SPACE", near)
    found = study(12, 0, workers=1)
    assert set(found.result["chosen"]) == set(NAMES)
    assert summary(found.result)
