"""Moving obstacles in scenario files: read, refused with the value, the place and the choices, and written back."""

import numpy as np
import pytest

from higvf_console.control.guidance.obstacles import world_at
from higvf_console.core.errors import ScenarioError
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import Scenario, load_scenario, parse_scenario
from higvf_console.scenario.writer import scenario_yaml

BASE = """
version: 1
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350], [730, 350]]}
"""
CIRCLE = "obstacles: {circles: [{at_m: [100, 100], radius_m: 20, %s}]}"
BAR = "obstacles: {bars: [{from_m: [100, 90], to_m: [100, 130], half_width_m: 5, %s}]}"


def read(line: str) -> Scenario:
    return parse_scenario(BASE + line, "t.yaml")


def places(scenario: Scenario, *times: float) -> list[list[float]]:
    return [scenario.obstacles.at(time).circles[0, :2].tolist() for time in times]


def test_a_path_starts_at_the_obstacle_and_ends_at_its_last_point() -> None:
    scenario = read(CIRCLE % "path_m: [[100, 200], [150, 200]], speed_m_per_s: 10")
    assert places(scenario, 0.0, 5.0, 12.0, 99.0) == [[100, 100], [100, 150], [120, 200], [150, 200]]


def test_a_loop_returns_to_where_it_started() -> None:
    scenario = read(CIRCLE % "path_m: [[100, 200]], speed_m_per_s: 10, loop: true")
    assert places(scenario, 5.0, 15.0, 20.0, 25.0) == [[100, 150], [100, 150], [100, 100], [100, 150]]


def test_a_velocity_goes_straight_on() -> None:
    assert places(read(CIRCLE % "velocity_m_per_s: [3, -4]"), 10.0) == [[130, 60]]


def test_the_middle_of_a_bar_follows_the_path_and_the_bar_does_not_turn() -> None:
    scenario = read(BAR % "path_m: [[200, 110]], speed_m_per_s: 10")
    assert scenario.obstacles.at(3.0).bars[0].tolist() == [130, 90, 130, 130, 5]


MISTAKES = {
    "no speed": ("path_m: [[1, 2]]", "circles[1]: the key 'speed_m_per_s' is missing; path_m needs path_m and speed"),
    "no path": ("speed_m_per_s: 5", "circles[1]: the key 'path_m' is missing; speed_m_per_s needs path_m and speed"),
    "loop alone": ("loop: true", "circles[1]: the key 'path_m' is missing; loop needs path_m and speed_m_per_s"),
    "both": (
        "velocity_m_per_s: [1, 2], loop: true",
        "circles[1]: loop, velocity_m_per_s: give path_m and speed_m_per_s, or velocity_m_per_s, not both",
    ),
    "too fast": (
        "path_m: [[1, 2]], speed_m_per_s: 101",
        "circles[1].speed_m_per_s: 101 is not a number from 0 to 100 m/s",
    ),
    "no points": ("path_m: [], speed_m_per_s: 5", "circles[1].path_m: 0 points are too few; give at least 1"),
    "nowhere": (
        "path_m: [[100, 100]], speed_m_per_s: 5",
        "circles[1].path_m: all points of the path are in one place, (100, 100) m; give one that leads away",
    ),
    "no velocity": ("velocity_m_per_s: [0, 0]", "velocity_m_per_s: [0, 0] is 0 m/s; give more than 0 and at most 100"),
    "a fast diagonal": ("velocity_m_per_s: [80, 80]", "[80, 80] is 113.137 m/s; give more than 0 and at most 100 m/s"),
    "a speed for a velocity": ("velocity_m_per_s: 5", "velocity_m_per_s: 5 is not a velocity [vx, vy] in m/s"),
    "no flag": ("path_m: [[1, 2]], speed_m_per_s: 5, loop: 1", "circles[1].loop: 1 is not true or false"),
    "a slip": ("path: [[1, 2]]", "circles[1].path: unknown key (did you mean 'path_m'?)"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_with_its_place_and_what_would_do(mistake: str) -> None:
    line, message = MISTAKES[mistake]
    with pytest.raises(ScenarioError) as caught:
        read(CIRCLE % line)
    assert message in str(caught.value)
    assert str(caught.value).startswith("t.yaml: obstacles.circles[1]")


def test_what_comes_as_fast_as_robots_can_yield_is_warned_of_by_name() -> None:
    limit = "\nparameters: {safety: {speed_limit: 40}, blending: {cruise_speed: 30}}"
    circle = read(CIRCLE % "velocity_m_per_s: [40, 0]" + limit)
    bar = read(BAR % "path_m: [[200, 110]], speed_m_per_s: 55.5" + limit)
    slow = "\nparameters: {safety: {speed_limit: 5}, fires: {stand_off: 60}}"
    fire = read("fires: [{at_m: [100, 100], radius_m: 200, growth_m_per_s: 6}]" + slow)
    assert circle.warnings == (
        "circle 1 moves at 40 m/s; robots, whose speed limit is 40 m/s, cannot always keep clear of it",
    )
    assert bar.warnings[0].startswith("bar 1 moves at 55.5 m/s; robots, whose speed limit is 40 m/s")
    assert "fire 1 grows at 6 m/s; robots, whose speed limit is 5 m/s, cannot always keep clear of it" in fire.warnings
    assert read(CIRCLE % "velocity_m_per_s: [39, 0]" + limit).warnings == ()


@pytest.mark.parametrize("ticks", [0, 7, 1234])
def test_a_run_among_moving_obstacles_is_written_as_one_that_goes_on_the_same_way(ticks: int) -> None:
    scenario = load_scenario("moving-obstacles")
    run = Run(scenario.setup(0), scenario.filter, scenario)
    motion = run.state.motion._replace(tick=ticks)
    text = scenario_yaml(run.setup, run.state._replace(motion=motion), scenario)
    again = parse_scenario(text, "again.yaml").setup(0)
    period = run.setup.params.safety.control_period
    for later in (0, 1, 250, 3000):
        now, then = (
            world_at(world, tick, period) for world, tick in ((run.setup.world, ticks + later), (again.world, later))
        )
        np.testing.assert_allclose(now.capsules, then.capsules, atol=1e-6)
        np.testing.assert_allclose(now.capsule_velocity, then.capsule_velocity, atol=1e-6)
    if ticks == 0:
        assert run.setup.world.capsules.tobytes() == again.world.capsules.tobytes()


def test_an_obstacle_at_the_end_of_its_path_is_written_as_one_that_stands_still() -> None:
    scenario = read(CIRCLE % "path_m: [[100, 200]], speed_m_per_s: 50")
    run = Run(scenario.setup(0), scenario.filter, scenario)
    state = run.state._replace(motion=run.state.motion._replace(tick=500))
    again = parse_scenario(scenario_yaml(run.setup, state, scenario), "again.yaml")
    assert again.obstacles.circles.tolist() == [[100.0, 200.0, 20.0]]
    assert again.obstacles.movers() == []
