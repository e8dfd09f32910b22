"""A scenario that asks for something odd runs all the same, and safely; what cannot run is in test_scenario_errors."""

from typing import Any

import pytest

from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import parse_scenario

TEAM = "robots: {start_m: [[700, 300], [670, 350], [730, 350]]}\n"
ONE = "robots: {start_m: [[700, 300]]}\n"
IN_A_POLYGON = (
    "fires: [{at_m: [350, 350], radius_m: 20}]\n"
    "obstacles: {polygons: [{points_m: [[300, 300], [400, 300], [400, 400], [300, 400]]}]}"
)


def report_of(text: str, duration: float) -> Any:
    scenario = parse_scenario("version: 1\narena: {size_m: [1200, 700]}\n" + text, "t.yaml")
    return run_headless(Session(scenario, []), duration)


@pytest.mark.parametrize(
    "text",
    [
        TEAM,
        TEAM + "fires: []\npath: {circle: {at_m: [700, 350], radius_m: 60}}",
        TEAM + "path: {circle: {at_m: [700, 100], radius_m: 250}}",
        TEAM + "path: {line: {at_m: [700, 300], angle_deg: 20}}",
        TEAM + "path: {sketch: {points_m: [[700, 300], [900, 500], [1100, 800], [1100, 900]]}}",
        TEAM + "links: []\nfires: [{at_m: [500, 250], radius_m: 20}]",
        TEAM + "fires: [{at_m: [350, 350], radius_m: 20}]\nobstacles: {circles: [{at_m: [350, 350], radius_m: 60}]}",
        TEAM + IN_A_POLYGON,
        TEAM + "fires: [{at_m: [500, 250], radius_m: 20}, {at_m: [500, 250], radius_m: 20}]",
        ONE + "path: {circle: {at_m: [570, 350], radius_m: 100}}",
    ],
    ids=[
        "nothing to do",
        "no fires",
        "a circle through two walls",
        "a line through a wall",
        "a sketch that leaves the arena",
        "no links at all",
        "a fire inside a circle",
        "a fire inside a polygon",
        "two fires on one spot",
        "one robot on a path",
    ],
)
def test_an_odd_scenario_runs_without_a_violation(text: str) -> None:
    report = report_of(text, 15.0)
    assert report["infeasible_ticks"] == 0
    assert report["min_clearance_margin_m"] is None or report["min_clearance_margin_m"] >= 0.0


def test_one_robot_extinguishes_a_fire_alone() -> None:
    assert report_of(ONE + "fires: [{at_m: [500, 250], radius_m: 20}]", 60.0)["extinguished"] == [1]


@pytest.mark.parametrize(
    ("obstacle", "name"),
    [
        ("circles: [{at_m: [340, 350], radius_m: 60}]", "circle 1"),
        ("bars: [{from_m: [300, 350], to_m: [400, 350], half_width_m: 30}]", "bar 1"),
        ("polygons: [{points_m: [[300, 300], [400, 300], [400, 400], [300, 400]]}]", "polygon 1"),
    ],
)
def test_a_fire_inside_an_obstacle_is_a_warning(obstacle: str, name: str) -> None:
    fires = "fires: [{at_m: [100, 100], radius_m: 20}, {at_m: [350, 350], radius_m: 20}]\n"
    text = f"version: 1\narena: {{size_m: [1200, 700]}}\n{TEAM}{fires}duration_s: 10\nobstacles: {{{obstacle}}}"
    (warning,) = parse_scenario(text, "t.yaml").warnings
    assert warning == f"fire 2 lies inside {name}; no robot sees it until it has grown out of it"
    assert parse_scenario(text.replace("[350, 350], radius_m: 20", "[350, 350], radius_m: 70"), "t.yaml").warnings == ()
