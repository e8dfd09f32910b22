"""Runs without a session equal headless sessions bit for bit, with and without an operator."""

from pathlib import Path

import numpy as np
import pytest

from higvf_console.channels.channels import open_interface
from higvf_console.core.interface import InputSpec
from higvf_console.lab.fit.firefighting import (
    Branch,
    milestones,
    result,
    run_branch,
    run_firefighting,
    state_before_departure,
)
from higvf_console.lab.fit.table2 import SCENARIO, open_strokes, run_columns
from higvf_console.lab.reproduce.paper import COLUMNS
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, load_scenario
from higvf_console.sim.simulation import roll


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario(SCENARIO)


@pytest.mark.parametrize("column", COLUMNS)
def test_a_run_is_the_headless_session_to_the_last_bit(column: str, scenario: Scenario) -> None:
    setup, branch = scenario.setup(), open_strokes(scenario).get(column)
    operator = None if branch is None else branch.operator
    run = run_firefighting(setup, scenario.duration, operator)
    branched = run_columns(setup, scenario.duration, open_strokes(scenario))[column]
    session = Session(scenario, [] if operator is None else [operator])
    report = run_headless(session)
    assert list(run.order) == report["extinguished"]
    assert run.loss_area.tolist() == report["loss_area_m2"]
    assert (run.ticks, run.min_clearance) == (report["ticks"], report["min_clearance_margin_m"])
    assert (branched.order, branched.loss_area.tolist(), branched.ticks) == (
        run.order,
        run.loss_area.tolist(),
        run.ticks,
    )
    assert branched.min_clearance == run.min_clearance


def test_an_operator_serves_many_runs(scenario: Scenario) -> None:
    branch, setup = open_strokes(scenario)["change_priority"], scenario.setup()
    alone = milestones(setup, scenario.duration)
    first, again = (run_branch(alone, branch, setup, scenario.duration) for _ in range(2))
    assert first.loss_area.tobytes() == again.loss_area.tobytes()
    assert first.order == again.order


def test_an_operator_whose_fire_never_goes_out_never_acts(scenario: Scenario) -> None:
    setup, branch = scenario.setup(), open_strokes(scenario)["find_hidden"]
    alone = milestones(setup, 20.0)
    assert branch.fire not in alone[-1].order
    assert run_branch(alone, branch, setup, 20.0).loss_area.tobytes() == result(alone).loss_area.tobytes()


def test_an_operator_who_acts_at_the_start_is_no_branch(scenario: Scenario, tmp_path: Path) -> None:
    script = tmp_path / "early.yaml"
    script.write_text("- {at_s: 0, do: stroke, robot: 1, points_m: [[600, 300], [500, 300]]}\n")
    operator = open_interface(InputSpec("script", str(script), {}, {}, scenario.arena, 3))
    setup = scenario.setup()
    with pytest.raises(ValueError, match="acts at the start, before fire 4 is out"):
        run_branch(milestones(setup, 1.0), Branch(operator, 3), setup, 1.0)


def test_the_skipped_wait_leaves_the_state_that_a_roll_reaches(scenario: Scenario) -> None:
    setup = scenario.setup()
    skipped = state_before_departure(setup)
    assert skipped.motion.tick > 100
    rolled, _ = roll(setup.start, setup.world, setup.params, skipped.motion.tick)
    for one, other in zip(rolled.motion, skipped.motion, strict=True):
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()


def test_a_team_out_of_its_formation_does_not_wait(scenario: Scenario) -> None:
    setup = scenario.setup()
    other_shape = setup._replace(world=setup.world._replace(formation=2.0 * setup.world.formation))
    assert state_before_departure(other_shape) is setup.start


def test_a_run_ends_with_its_duration_with_fires_left(scenario: Scenario) -> None:
    run = run_firefighting(scenario.setup(), 20.0)
    assert run.ticks == 1000
    assert len(run.order) < 5


def test_a_run_ends_early_when_a_fire_passes_its_limit(scenario: Scenario) -> None:
    setup = scenario.setup()
    whole = run_firefighting(setup, scenario.duration)
    ended = run_firefighting(setup, scenario.duration, limits=0.5 * whole.loss_area)
    assert ended.ticks < whole.ticks
    assert (ended.loss_area > 0.5 * whole.loss_area).any()
