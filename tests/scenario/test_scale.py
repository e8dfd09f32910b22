"""Body and speed limit set the scale: the same motion in a smaller arena, and numbers that do not fit are told."""

from typing import Any

import numpy as np
import pytest
import yaml

from higvf_console.control.guidance.paths import SHORTEST_PATH
from higvf_console.control.parameters import GROUPS, Parameters, defaults_at
from higvf_console.core.errors import PathError, ScenarioError
from higvf_console.core.quantity import quantities
from higvf_console.core.reading.document import yaml_text
from higvf_console.core.scale import BODY_RADIUS, SPEED_LIMIT, USUAL_SCALE, Scale
from higvf_console.library.paths import sketch_path
from higvf_console.library.setups import make_parameters
from higvf_console.scenario.scenario import Scenario, data_folder, load_scenario, parse_scenario
from higvf_console.scenario.writer import scenario_yaml
from higvf_console.sim.simulation import advance

TABLE = Scale(0.055, 0.2)
SMALL = 1 / 256  # a power of two, so that every length and speed is scaled without rounding


def scaled(value: Any, factor: float, *, length: bool = False) -> Any:
    """A part of a scenario file whose lengths and growths are multiplied."""
    if isinstance(value, dict):
        return {key: scaled(part, factor, length="_m" in key) for key, part in value.items()}
    if isinstance(value, list):
        return [scaled(part, factor, length=length) for part in value]
    return factor * value if length and isinstance(value, int | float) else value


def content_of(name: str) -> Any:
    """The sections of a shipped scenario."""
    return yaml.safe_load((data_folder() / "scenarios" / f"{name}.yaml").read_text())


def parsed(content: Any) -> Scenario:
    return parse_scenario(yaml_text(content), "scaled.yaml")


def test_without_a_body_defaults_and_ranges_are_the_usual_ones() -> None:
    assert defaults_at(USUAL_SCALE) == Parameters()
    assert load_scenario("firefighting").params == Parameters()


def test_a_team_of_another_scale_moves_alike() -> None:
    content = content_of("firefighting")
    stroke = content["strokes"][1]["points_m"]
    content["path"] = {"sketch": {"points_m": stroke}}
    small = scaled(content, SMALL)
    small["robots"] |= {"radius_m": SMALL * BODY_RADIUS, "speed_limit_m_per_s": SMALL * SPEED_LIMIT}
    large, small = parsed(content).setup(), parsed(small).setup()
    assert small.params.scale.time == 1.0
    states = [large.start, small.start]
    for _ in range(400):
        states = [
            advance(state, setup.world, setup.params)[0] for state, setup in zip(states, (large, small), strict=True)
        ]
    assert states[0].motion.path_parameter > 100.0
    np.testing.assert_allclose(states[1].motion.position, SMALL * states[0].motion.position, rtol=1e-6)
    assert states[1].motion.path_status == states[0].motion.path_status


@pytest.mark.parametrize("group", GROUPS)
def test_every_default_lies_in_its_range_at_every_scale(group: str) -> None:
    for scale in (TABLE, Scale(0.3, 1.5), Scale(0.1, 10.0), Scale(400.0, 900.0)):
        part = getattr(defaults_at(scale), group)
        for name, meaning in quantities(type(part)).items():
            allowed = meaning.at(scale)
            assert allowed.low <= getattr(part, name) <= allowed.high, (scale, name)


def test_a_small_and_fast_robot_is_controlled_more_often() -> None:
    assert defaults_at(TABLE).safety.control_period == 0.02
    assert defaults_at(Scale(0.1, 10.0)).safety.control_period == pytest.approx(0.02 * (0.1 / 12) / (10 / 90))


@pytest.mark.parametrize("name", ["robotarium", "warehouse", "epucks"])
def test_a_shipped_scenario_of_another_scale_fits_its_arena_and_is_saved_as_it_is(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.warnings == ()
    setup = scenario.setup()
    for rounded in (False, True):
        again = parse_scenario(scenario_yaml(setup, setup.start, scenario, rounded=rounded), f"{name}.yaml")
        assert again.params == scenario.params
        assert again.robots.scale == scenario.robots.scale


@pytest.mark.parametrize(
    ("robots", "error"),
    [
        ({"radius_m": 0.055}, "give speed_limit_m_per_s too"),
        ({"speed_limit_m_per_s": 0.2}, "give radius_m too"),
        ({"radius_m": 0, "speed_limit_m_per_s": 0.2}, "robots.radius_m: 0 is not a number from 0.001 to 1000 m"),
    ],
)
def test_half_a_body_is_refused(robots: dict[str, float], error: str) -> None:
    content = content_of("robotarium")
    for key in ("radius_m", "speed_limit_m_per_s"):
        del content["robots"][key]
    content["robots"] |= robots
    with pytest.raises(ScenarioError, match=error):
        parsed(content)


def test_a_range_is_that_of_the_scale() -> None:
    content = content_of("robotarium")
    content["parameters"] = {"fires": {"stand_off": 0.15}}
    assert parsed(content).params.fires.stand_off == 0.15
    content["parameters"] = {"fires": {"stand_off": 25}}
    with pytest.raises(ScenarioError, match=r"stand_off: 25 is not a number from 0\.000458333 to 2\.29167 m"):
        parsed(content)


def test_numbers_that_do_not_fit_the_arena_are_told_by_name() -> None:
    content = content_of("robotarium")
    for key in ("radius_m", "speed_limit_m_per_s"):
        del content["robots"][key]
    content["parameters"] = {
        "safety": {"robot_clearance": 0.12, "obstacle_clearance": 0.1, "speed_limit": 2.0, "pair_gain": 5,
                   "obstacle_gain": 5},
        "boundaries": {"reactive_margin": 1.2, "repulsive_margin": 0.5},
    }  # fmt: skip
    told = "; ".join(parsed(content).warnings)
    for name in ("fires.stand_off is 25 m", "boundaries.reactive_margin is 1.2 m", "path.capture_distance is 40 m",
                 "blending.cruise_speed is 60 m/s", "fire 1 is held from the start: 3 robots"):  # fmt: skip
        assert name in told
    assert "safety.robot_clearance" not in told
    assert "give robots.radius_m and speed_limit_m_per_s" in told


def test_the_library_makes_parameters_and_paths_at_a_scale() -> None:
    params = make_parameters(body_radius=0.055, speed_limit=0.2, fires={"stand_off": 0.2})
    assert params == defaults_at(TABLE)._replace(fires=params.fires)
    short = [[0.0, 0.0], [0.05, 0.01], [0.1, 0.0]]
    assert sketch_path(short, body_radius=0.055).length == pytest.approx(0.1, rel=0.1)
    with pytest.raises(PathError, match=f"at least {SHORTEST_PATH:g} m long"):
        sketch_path(short)
