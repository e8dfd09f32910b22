"""The fit to all columns: its rule on known landscapes, and the shipped world, which meets every number of Table II."""

from collections.abc import Sequence

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.errors import HigvfError
from higvf_console.lab.fit import joint
from higvf_console.lab.fit.firefighting import FirefightingRun, milestones
from higvf_console.lab.fit.joint import (
    HIDDEN,
    JointTrial,
    attempt_all,
    basins,
    choose_joint,
    explore,
    hidden_time,
    joint_misfit,
    neighbours,
    sight_of_last,
)
from higvf_console.lab.fit.joint_study import JOINT_SCENARIO, joint_scenario_text, kept_joint_fit
from higvf_console.lab.fit.joint_text import joint_summary, mechanism
from higvf_console.lab.fit.space import DURATION, NAMES, SPACE, Sample, distance, on_grid, sample_of, world_of
from higvf_console.lab.fit.study import BASE, strokes
from higvf_console.lab.fit.table2 import Columns, as_json, run_columns, verdicts
from higvf_console.lab.reproduce.paper import COLUMNS
from higvf_console.scenario.scenario import load_scenario
from higvf_console.world.setup import Setup

LOW, HIGH = (np.array([getattr(free, end) for free in SPACE]) for end in ("low", "high"))
CENTRE = on_grid((LOW + HIGH) / 2)
BAR = NAMES.index("bar.x")


@pytest.fixture(scope="module")
def world() -> Setup:
    return load_scenario(JOINT_SCENARIO).setup()


@pytest.fixture(scope="module")
def columns(world: Setup) -> Columns:
    return run_columns(world, DURATION, strokes())


def printed() -> dict[str, FirefightingRun]:
    return {
        name: FirefightingRun(column.order, floats(column.loss_area), 2100, 1.0) for name, column in COLUMNS.items()
    }


def with_loss(name: str, fire: int, factor: float) -> Columns:
    runs = printed()
    area = runs[name].loss_area.copy()
    area[fire - 1] *= factor
    return {**runs, name: runs[name]._replace(loss_area=area)}


def at(metres: float, objective: float, hidden: float = 0.0, *, meets: bool = True) -> JointTrial:
    sample = tuple(value + metres * (place == BAR) for place, value in enumerate(CENTRE))
    return JointTrial(sample, objective, meets, hidden)


def test_the_shipped_world_meets_every_number_of_table_2(columns: Columns) -> None:
    found = verdicts(columns, every_loss=True)
    assert [verdict.target for verdict in found if not verdict.met] == []
    assert len([verdict for verdict in found if verdict.limit == 0.05]) == 15
    assert len([verdict for verdict in found if verdict.limit == 0.02]) == 3
    assert len([verdict for verdict in found if verdict.limit == 0.01]) == 2


def test_the_stored_fit_belongs_to_this_engine_and_world(columns: Columns, world: Setup) -> None:
    """Where this fails, the engine has changed: run `higvf fit --columns all` again and ship what it writes."""
    kept = kept_joint_fit()
    for key, value in as_json(columns, every_loss=True).items():
        assert kept[key] == value
    assert kept["misfit"] == joint_misfit(columns)
    alone = milestones(world, DURATION)
    assert kept["hidden_s"] == hidden_time(alone, world)
    assert tuple(kept["sight_rad"]) == sight_of_last(alone, world)


def test_the_shipped_scenario_is_what_the_fit_writes(world: Setup) -> None:
    kept = kept_joint_fit()
    base = load_scenario(BASE)
    trial = attempt_all(sample_of(world), base.setup(), strokes())
    assert trial.meets
    assert trial.sample == tuple(kept["chosen"].values())
    assert load_scenario(JOINT_SCENARIO).text == joint_scenario_text(trial, kept["margin"], base)


def test_the_stored_margin_is_the_smallest_of_the_neighbours() -> None:
    kept = kept_joint_fit()
    misfits = [misfit for pair in kept["neighbours"]["misfit"].values() for misfit in pair]
    assert len(misfits) == 2 * len(SPACE)
    assert kept["margin"] == 1.0 - max(kept["misfit"], *misfits)
    assert kept["neighbours"]["meet"] == sum(misfit <= 1.0 for misfit in misfits)


def test_the_summary_says_that_it_is_a_fit() -> None:
    text = joint_summary(kept_joint_fit())
    assert "This is a fit to all columns, not a prediction." in text
    assert "missed: none" in text
    assert mechanism(kept_joint_fit()) in text


def test_the_printed_table_has_no_misfit() -> None:
    assert joint_misfit(printed()) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("name", COLUMNS)
@pytest.mark.parametrize("fire", [1, 3, 5])
def test_a_loss_of_any_column_counts(name: str, fire: int) -> None:
    runs = with_loss(name, fire, 1.06)
    assert joint_misfit(runs) >= 1.2 - 1e-9
    missed = [verdict.target for verdict in verdicts(runs, every_loss=True) if not verdict.met]
    assert any(target.startswith(f"fire {fire}") and COLUMNS[name].title.lower() in target for target in missed)


def test_a_missed_order_is_a_misfit_whatever_the_numbers_are() -> None:
    runs = printed()
    runs["find_hidden"] = runs["find_hidden"]._replace(order=(2, 1, 3, 4, 5))
    assert joint_misfit(runs) == 2.0


def test_neighbours_change_one_parameter_by_a_hundredth() -> None:
    found = neighbours(CENTRE)
    assert len(set(found)) == 2 * len(SPACE)
    for place, (below, above) in enumerate(zip(found[::2], found[1::2], strict=True)):
        assert [below[place], above[place]] == pytest.approx([0.99 * CENTRE[place], 1.01 * CENTRE[place]])
        assert [one for k, one in enumerate(below) if k != place] == [one for k, one in enumerate(CENTRE) if k != place]


def test_the_rule_prefers_the_wide_valley_to_the_deep_one() -> None:
    deep, wide, wrong = at(0.0, 0.2), at(100.0, 0.5), at(50.0, 0.1, meets=False)

    def misfits(samples: Sequence[Sample]) -> list[float]:
        return [0.9 if sample[BAR] < CENTRE[BAR] + 50.0 else 0.6 for sample in samples]

    assert choose_joint([deep, wide, wrong], misfits) == (wide, pytest.approx(0.4))


def test_the_rule_prefers_the_papers_mechanism_to_the_margin() -> None:
    seen, hidden = at(0.0, 0.2, HIDDEN - 0.02), at(100.0, 0.9, HIDDEN)
    assert choose_joint([seen, hidden], lambda samples: [1.5] * len(samples)) == (hidden, -0.5)


def test_worlds_that_cannot_win_are_not_run() -> None:
    asked: list[Sample] = []

    def misfits(samples: Sequence[Sample]) -> list[float]:
        asked.extend(samples)
        return [0.5] * len(samples)

    best = at(0.0, 0.1)
    assert choose_joint([at(100.0, 0.6), best, at(200.0, 0.7)], misfits) == (best, 0.5)
    assert sorted(asked) == sorted(neighbours(best.sample))


def test_a_world_is_given_up_at_its_first_neighbour_below_the_best_margin() -> None:
    asked: list[Sample] = []

    def misfits(samples: Sequence[Sample]) -> list[float]:
        asked.extend(samples)
        return [0.9 if sample[BAR] > CENTRE[BAR] + 50.0 else 0.5 for sample in samples]

    best, beaten = at(0.0, 0.1), at(100.0, 0.2)
    assert choose_joint([best, beaten], misfits) == (best, 0.5)
    assert len(asked) == 2 * len(SPACE) + joint.TOGETHER


def test_the_worlds_known_before_meet_the_table() -> None:
    assert all(attempt_all(sample, load_scenario(BASE).setup(), strokes()).meets for sample in joint.KNOWN)


def test_no_world_that_meets_the_table_is_an_error_with_advice() -> None:
    with pytest.raises(HigvfError, match="no sample meets every number of Table II; give more --runs"):
        choose_joint([at(0.0, 1.1, meets=False)], lambda samples: [0.0] * len(samples))


def ball(samples: Sequence[Sample]) -> list[JointTrial]:
    """Worlds near the centre meet the table."""
    return [JointTrial(one, distance(one, CENTRE), distance(one, CENTRE) < 0.1, 0.0) for one in samples]


def test_exploring_steps_from_worlds_that_meet_the_table() -> None:
    start = ball([CENTRE])
    found = explore(start, 300, 1, ball)
    assert found == explore(start, 300, 1, ball)
    assert 200 < len(found) <= 301
    assert sum(one.meets for one in found) > 5
    for one in found:
        assert np.all(np.array(one.sample) >= LOW - 1e-9)
        assert np.all(np.array(one.sample) <= HIGH + 1e-9)


def test_exploring_comes_nearer_where_no_world_meets_the_table_yet() -> None:
    far = tuple(value + 30.0 * (place == BAR) for place, value in enumerate(CENTRE))
    found = explore(ball([far]), 20 * joint.BATCH, 1, ball)
    assert min(one.objective for one in found) < 0.7 * distance(far, CENTRE)


def test_basins_are_parted_by_the_place_of_the_bar() -> None:
    left, right = [at(0.0, 0.5, 2.0), at(20.0, 0.3)], [at(60.0, 0.7)]
    first, second = basins([*right, *left, at(40.0, 0.1, meets=False)])
    assert (first["worlds"], first["misfit"], first["hidden_s"]) == (2, 0.3, [0.0, 2.0])
    assert first["parameters"]["bar.x"] == [CENTRE[BAR], CENTRE[BAR] + 20.0]
    assert (second["worlds"], second["misfit"]) == (1, 0.7)


def test_a_longer_bar_hides_fire_5_for_longer(world: Setup) -> None:
    given = dict(zip(NAMES, sample_of(world), strict=True))
    longer = tuple({**given, "bar.y_low": 40.0, "bar.y_high": 560.0}.values())
    behind = world_of(longer, load_scenario(BASE).setup())
    alone = milestones(behind, DURATION)
    assert sight_of_last(alone, behind) == (0.0, 0.0, 0.0)
    assert hidden_time(alone, behind) > hidden_time(milestones(world, DURATION), world) + 1.0
