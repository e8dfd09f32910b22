"""The fit of Table II's world: its grid, its rule, its search and the scenario that it writes."""

import json
import random
from collections.abc import Sequence

import numpy as np
import pytest

from higvf_console.core.errors import HigvfError, ScenarioError
from higvf_console.lab.fit import search as fit
from higvf_console.lab.fit import study as fit_study
from higvf_console.lab.fit.search import Trial, acceptable, attempt, choose, judged, misfit, search, widest
from higvf_console.lab.fit.space import NAMES, SPACE, Sample, distance, on_grid, sample_of, unit, world_of
from higvf_console.lab.fit.study import BASE, predicted, scenario_text, study
from higvf_console.lab.fit.table2 import ALONE, SCENARIO
from higvf_console.lab.fit.text import summary
from higvf_console.lab.reproduce.paper import COLUMNS
from higvf_console.scenario.scenario import load_scenario, parse_scenario
from higvf_console.world.obstacles import NO_OBSTACLES
from higvf_console.world.setup import Setup

LOW, HIGH = (np.array([getattr(free, end) for free in SPACE]) for end in ("low", "high"))
CENTRE = on_grid((LOW + HIGH) / 2)


@pytest.fixture(scope="module")
def base() -> Setup:
    return load_scenario(BASE).setup()


@pytest.fixture(scope="module")
def shipped() -> Sample:
    return sample_of(load_scenario(SCENARIO).setup())


def trial(sample: Sample = CENTRE, errors: Sequence[float] = (0.0,) * 5, admissible: bool = True) -> Trial:
    return Trial(sample, tuple(errors), admissible, misfit(errors, 0.0))


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


def test_parameters_that_no_scenario_would_accept_are_refused(base: Setup) -> None:
    near = tuple(12.5 if name == "fires.stand_off" else value for name, value in zip(NAMES, CENTRE, strict=True))
    with pytest.raises(ScenarioError, match="stand_off"):
        world_of(near, base)
    refused = attempt(near, base)
    assert not refused.admissible
    assert refused.objective > attempt(CENTRE, base).objective


def test_a_world_without_its_bar_is_no_sample(base: Setup) -> None:
    with pytest.raises(ScenarioError, match="one vertical bar, not 0"):
        sample_of(base._replace(layout=base.layout._replace(obstacles=NO_OBSTACLES)))


def test_the_written_scenario_is_the_world_that_was_run(base: Setup, shipped: Sample) -> None:
    text = scenario_text(trial(shipped), load_scenario(BASE))
    setup = parse_scenario(text, "written.yaml").setup()
    for one, other in zip(
        (*setup.world, *setup.params), (*(world := world_of(shipped, base)).world, *world.params), strict=True
    ):
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()
    assert parse_scenario(text, "written.yaml").warnings == ()


def test_the_shipped_scenario_is_what_the_fit_writes(base: Setup, shipped: Sample) -> None:
    best = attempt(shipped, base)
    assert load_scenario(SCENARIO).text == scenario_text(best, load_scenario(BASE))
    assert best.admissible


def test_the_misfit_is_the_largest_error_relative_to_its_limit(base: Setup, shipped: Sample) -> None:
    columns = predicted(shipped, base)
    assert columns is not None
    printed, found = np.array(COLUMNS[ALONE].loss_area), columns[ALONE].loss_area
    fires, total = np.abs(found / printed - 1.0).max() / 0.05, abs(found.sum() / printed.sum() - 1.0) / 0.02
    assert attempt(shipped, base).objective == pytest.approx(max(fires, total))
    assert misfit([0.05, -0.01], 0.0) == misfit([0.0], -0.02) == pytest.approx(1.0)


def test_a_run_that_is_not_the_papers_is_not_admissible(base: Setup, shipped: Sample) -> None:
    columns = predicted(shipped, base)
    assert columns is not None
    run = columns[ALONE]
    assert judged(shipped, run).admissible
    assert not judged(shipped, run._replace(order=(2, 1, 3, 4, 5))).admissible
    assert not judged(shipped, run._replace(min_clearance=-1e-9)).admissible
    late, later = (judged(shipped, run._replace(order=run.order[:out])).objective for out in (2, 1))
    assert later > late > judged(shipped, run).objective


def test_the_rule_selects_the_smallest_misfit() -> None:
    good, bad = trial(errors=(0.02, -0.02, 0.02, 0, 0)), trial(errors=(0.0, 0.0, 0.0, 0.0, -0.025))
    assert choose([bad, good], CENTRE) == good


def test_ties_go_to_the_nearest_defaults() -> None:
    far, near = trial(moved("bar.x", 5.0), errors=(0.02,) * 5), trial(moved("bar.x", 2.0), errors=(0.0204,) * 5)
    assert choose([far, near], CENTRE) == near


def test_the_choice_does_not_depend_on_the_order_of_the_trials() -> None:
    shuffle = random.Random(3)
    trials = [trial(moved("bar.x", float(k)), [shuffle.uniform(-0.01, 0.01) for _ in range(5)]) for k in range(50)]
    best = choose(trials, CENTRE)
    shown = widest(acceptable(trials, best), best, 10)
    for _ in range(5):
        shuffle.shuffle(trials)
        assert choose(trials, CENTRE) == best
        assert widest(acceptable(trials, best), best, 10) == shown


def test_no_admissible_sample_is_an_error_with_advice() -> None:
    with pytest.raises(HigvfError, match="give more --runs"):
        choose([trial(admissible=False)], CENTRE)


def test_acceptable_samples_meet_the_targets_of_column_1() -> None:
    best, good, bad = trial(errors=(0.02,) * 5), trial(errors=(0.049,) * 5), trial(errors=(0.051,) * 5)
    assert acceptable([bad, good, best], best) == [best, good]
    assert acceptable([bad, trial(errors=(0.06,) * 5)], bad) == [bad]
    assert acceptable([best, trial(errors=(0.0,) * 5, admissible=False)], best) == [best]


def test_the_shown_samples_cover_the_spread() -> None:
    first, *rest = (trial(moved("bar.x", float(k))) for k in (0, 1, 2, 3, 40))
    assert widest([first, *rest], first, 3) == [first, rest[3], rest[2]]
    assert len(widest([first, *rest], first, 100)) == 5


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


def no_influence(*_: object) -> dict[str, None]:
    """Stands in for 60 runs, which have their own tests."""
    return dict.fromkeys(NAMES)


def test_a_small_study_predicts_judges_and_writes_its_world(monkeypatch: pytest.MonkeyPatch, shipped: Sample) -> None:
    monkeypatch.setattr(fit, "POPULATION", 6)
    monkeypatch.setattr(fit_study, "SPREAD_SAMPLES", 1)
    monkeypatch.setattr(fit_study, "sensitivity", no_influence)
    beside = tuple(
        free._replace(low=value - free.step, high=value + free.step) for free, value in zip(SPACE, shipped, strict=True)
    )
    monkeypatch.setattr(fit, "SPACE", beside)
    found = study(24, 0, workers=1)
    result = found.result
    assert json.loads(json.dumps(result, allow_nan=False)) == result
    assert tuple(result["chosen"].values()) == sample_of(parse_scenario(found.scenario, "written.yaml").setup())
    assert list(result["table2"]) == list(result["paper"]) == list(COLUMNS)
    for verdict in result["targets"]:
        assert verdict["target"] in summary(result)
        assert result["spread"]["targets_met"][verdict["target"]] == float(verdict["met"])
