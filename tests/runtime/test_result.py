"""The result of a run: each fire's loss beside the run without an operator, the order, and what the operator did."""

import json
from threading import Event as Signal

import numpy as np

from higvf_console.analysis.baseline import Baseline, compute_baseline
from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    AskReset,
    EmergencyStop,
    OperatorCommand,
    Pause,
    Pick,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    Undo,
)
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.phase import EndReason
from higvf_console.runtime.report import watched_report
from higvf_console.runtime.result import run_result
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, parse_scenario
from tests.fake_interfaces import FakeConsole

TWO_FIRES = """
version: 1
name: two
arena: {size_m: [600, 300]}
robots: {start_m: [[100, 150], [100, 200]]}
fires: [{at_m: [500, 250], radius_m: 5, growth_m_per_s: 0.1}, {at_m: [180, 175], radius_m: 20, growth_m_per_s: 0.1}]
duration_s: 30
"""
TWO = parse_scenario(TWO_FIRES, "two.yaml")


def give(session: Session, *commands: OperatorCommand) -> None:
    for command in commands:
        session.pointer.push(command)
        session.tick()


def baseline_of(scenario: Scenario) -> Baseline:
    found = compute_baseline(scenario.setup(), scenario.duration, Signal())
    assert found is not None
    return found


def test_a_run_that_nobody_touched_is_the_run_without_an_operator() -> None:
    session = Session(TWO, [])
    run_headless(session)
    result = run_result(session.snapshot, baseline_of(TWO))
    assert result.reason is EndReason.ALL_FIRES_OUT
    assert result.without is not None
    assert result.without.loss_area.tolist() == result.loss_area.tolist()
    assert result.without.order == result.order == (1, 0)
    assert abs(result.without.time - result.time) < 1e-9
    assert result.actions == ()


def test_runs_with_fires_left_are_compared_at_the_same_time() -> None:
    session = Session(TWO, [])
    session.tick()
    now = session.snapshot._replace(time=2.0)
    loss = floats([[1, 1], [2, 1], [3, 1], [4, 1]])
    burning = np.array([[True, True], [True, True], [True, False], [False, False]])
    result = run_result(now, Baseline(floats([1, 2, 3, 4]), loss.sum(axis=1), loss, burning))
    assert result.without is not None
    assert (result.without.time, result.without.order) == (2.0, ())
    assert result.without.loss_area.tolist() == [2.0, 1.0]


def test_a_baseline_of_another_world_is_not_compared_with() -> None:
    session = Session(TWO, [])
    other = baseline_of(TWO)
    alone = other._replace(by_fire=other.by_fire[:, :1], burning=other.burning[:, :1])
    assert run_result(session.snapshot, alone).without is None


def test_the_actions_are_those_of_this_run_that_stand_and_every_stop() -> None:
    session = Session(TWO, [FakeConsole()])
    give(session, Pause(), EmergencyStop(), AskReset(), ResetEmergencyStop(), ResetRun())
    give(session, Pick(1), Undo(), EmergencyStop(), AskReset(), ResetEmergencyStop(), Resume())
    texts = [entry.text for entry in run_result(session.snapshot, None).actions]
    assert texts == ["STOP: all robots stand still.", "The team resumes."]


def test_the_report_of_a_console_has_what_a_headless_one_has_and_the_comparison() -> None:
    session = Session(TWO, [FakeConsole()])
    session.baseline = baseline_of(TWO)
    give(session, Pick(1))
    early = watched_report(session)
    assert early["ended"] is None
    assert early["actions"] == [{"time": 0.0, "text": "Robot 2 is now the influenced robot."}]
    headless = run_headless(session)
    report = watched_report(session)
    for key in set(headless) - {"tick_ms", "digest", "ticks", "duration_s"}:
        assert report[key] == headless[key], key
    assert set(report) - set(headless) == {"without_operator", "actions"}
    assert report["without_operator"]["extinguished"] == [2, 1]
    json.dumps(report, allow_nan=False)
