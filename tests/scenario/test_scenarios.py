"""What a scenario file means, and that every shipped one can be run."""

import math
import re
import shutil
from pathlib import Path as FilePath

import numpy as np
import pytest

from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import PathKind, PathStatus
from higvf_console.scenario import scenario as scenario_module
from higvf_console.scenario.scenario import load_scenario, parse_scenario, scenario_names
from higvf_console.scenario.sections import FilterKind

BASE = """
version: 1
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350], [730, 350]]}
"""

SHIPPED = {
    "firefighting",
    "circle-inside",
    "circle-inside-corrected",
    "circle-outside",
    "circle-outside-corrected",
    "circle-obstacles",
    "barrier-gaze",
    "swarm",
    "empty",
    "circle-irregular",
    "building",
    "unicycles",
    "moving-obstacles",
}


def test_the_promised_scenarios_are_shipped() -> None:
    assert set(scenario_names()) >= SHIPPED


@pytest.mark.parametrize("name", scenario_names())
def test_a_shipped_scenario_loads_without_a_warning_and_sets_up(name: str) -> None:
    scenario = load_scenario(name)
    setup = scenario.setup(seed=3)
    assert scenario.name == name
    assert scenario.description
    assert scenario.warnings == ()
    assert len(setup.start.motion.position) == len(setup.world.formation)


def test_firefighting_is_table_1() -> None:
    setup = load_scenario("firefighting").setup()
    np.testing.assert_array_equal(setup.start.motion.position, [[700, 300], [670, 350], [730, 350]])
    fires = [[500, 250], [300, 450], [170, 120], [650, 600], [1100, 300]]
    np.testing.assert_array_equal(setup.world.fire_position, fires)
    np.testing.assert_array_equal(setup.start.motion.fire_radius, [20, 30, 50, 10, 40])
    np.testing.assert_array_equal(setup.world.fire_growth, np.ones(5))
    circles = [[300, 200, 20], [670, 450, 20], [480, 400, 20], [150, 450, 20], [650, 140, 20]]
    np.testing.assert_array_equal(setup.world.circles, circles)


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others() -> None:
    scenario = load_scenario("swarm")
    first, again, other = (scenario.setup(seed).start.motion.position for seed in (1, 1, 2))
    assert first.tobytes() == again.tobytes()
    assert first.tobytes() != other.tobytes()


def test_a_grid_is_square_and_centred() -> None:
    text = BASE.replace("{start_m: [[700, 300], [670, 350], [730, 350]]}", "{count: 9, spacing_m: 40}")
    position = parse_scenario(text, "t.yaml").setup().start.motion.position
    np.testing.assert_array_equal(position[0], [560, 310])
    np.testing.assert_array_equal(position[-1], [640, 390])
    np.testing.assert_array_equal(position[4], [600, 350])


def test_a_grid_stands_where_it_is_told_to() -> None:
    text = BASE.replace(
        "{start_m: [[700, 300], [670, 350], [730, 350]]}", "{count: 2, spacing_m: 40, centre_m: [99, 50]}"
    )
    position = parse_scenario(text, "t.yaml").setup().start.motion.position
    np.testing.assert_array_equal(position, [[79, 50], [119, 50]])


def test_walls_enclose_the_arena_and_can_be_left_out() -> None:
    world = parse_scenario(BASE, "t.yaml").setup().world
    for point, inside in (
        ((600, 350), True),
        ((-1, 350), False),
        ((1201, 350), False),
        ((600, -1), False),
        ((600, 701), False),
    ):
        assert bool((world.walls[:, :2] @ point >= world.walls[:, 2]).all()) is inside
    open_text = BASE.replace("[1200, 700]}", "[1200, 700], walls: false}")
    assert parse_scenario(open_text, "t.yaml").setup().world.walls.shape == (0, 3)


def test_links_count_from_one_and_are_stored_both_ways() -> None:
    world = parse_scenario(BASE + "links: [[1, 2], [3, 2], [2, 1]]", "t.yaml").setup().world
    np.testing.assert_array_equal(world.link_start, [0, 1, 3, 4])
    np.testing.assert_array_equal(world.link_to, [1, 0, 2, 1])


def test_without_links_the_communication_range_decides() -> None:
    world = parse_scenario(BASE, "t.yaml").setup().world
    assert world.link_start.shape == (0,)


@pytest.mark.parametrize(
    ("line", "cause"),
    [("links: [[1, 2]]", "links"), ("parameters: {formation: {communication_range: 40}}", "communication_range")],
)
def test_a_team_in_parts_is_a_warning(line: str, cause: str) -> None:
    (warning,) = parse_scenario(BASE + line, "t.yaml").warnings
    assert "groups that cannot communicate" in warning
    assert cause in warning


def test_a_fire_that_outgrows_its_stand_off_is_a_warning() -> None:
    fires = "fires: [{at_m: [100, 100], radius_m: 30}, {at_m: [300, 100], radius_m: 30, growth_m_per_s: 5}]"
    (warning,) = parse_scenario(BASE + fires, "t.yaml").warnings
    assert warning.startswith("fire 2 can grow to 630 m, where its barrier holds robots 4")
    assert warning.endswith("stand_off is 25 m")


def test_settings_of_an_interface_that_is_not_installed_are_a_warning() -> None:
    (warning,) = parse_scenario(BASE + "inputs: {gazee: {}}", "t.yaml").warnings
    assert warning.startswith("inputs.gazee: no such interface is installed (did you mean 'gaze'?); installed: bci, ")


@pytest.mark.parametrize(
    ("robots", "sentence"),
    [
        ("turn_rate_limit: 2", "robots.turn_rate_limit has no effect on single integrators"),
        ("look_ahead: 1", "obstacle_clearance is 12 m, enlarged to 13 m by look_ahead 1 m"),
        ("look_ahead: 1, turn_rate_limit: 3", "look_ahead and turn_rate_limit let unicycles go 3 m/s; cruise_speed is"),
    ],
)
def test_what_unicycles_make_of_other_tunables_is_a_warning(robots: str, sentence: str) -> None:
    boundaries = ", boundaries: {repulsive_margin: 13}" if "turn" not in robots else ""
    text = BASE + f"parameters: {{robots: {{{robots}}}{boundaries}}}"
    (warning,) = parse_scenario(text, "t.yaml").warnings
    assert warning.startswith(sentence)


def test_unicycles_start_with_their_bodies_at_the_given_points_and_in_the_given_heading() -> None:
    text = "{start_m: [[700, 300], [670, 350], [730, 350]], heading_deg: 90}\nparameters: {robots: {look_ahead: 2}}"
    motion = parse_scenario(re.sub("robots: .*", f"robots: {text}", BASE), "t.yaml").setup().start.motion
    assert motion.heading == pytest.approx(np.full(3, np.pi / 2))
    np.testing.assert_allclose(motion.position, [[700, 302], [670, 352], [730, 352]])


def test_barriers_are_judged_at_the_speed_that_unicycles_can_go() -> None:
    fast = BASE + "parameters: {blending: {cruise_speed: 400}, robots: {"
    with pytest.raises(ScenarioError, match="pair barriers do not hold"):
        parse_scenario(fast + "look_ahead: 0}}", "t.yaml")
    parse_scenario(fast + "look_ahead: 0.5}}", "t.yaml")


def test_the_seed_of_a_run_is_that_of_its_errors_and_losses() -> None:
    scenario = load_scenario("unicycles")
    assert [scenario.setup(seed).params.robots.seed for seed in (0, 5, 2**53 + 1)] == [0.0, 5.0, 1.0]


def test_the_speed_limit_follows_the_cruise_speed_unless_it_is_given() -> None:
    def limit(parameters: str) -> float:
        return parse_scenario(f"{BASE}parameters: {parameters}", "t.yaml").params.safety.speed_limit

    assert limit("{blending: {cruise_speed: 80}}") == 120.0
    assert limit("{blending: {cruise_speed: 80}, safety: {speed_limit: 95}}") == 95.0
    assert limit("{}") == 90.0


def test_whole_numbers_become_floats_for_the_kernels() -> None:
    params = parse_scenario(BASE + "parameters: {safety: {robot_clearance: 20}}", "t.yaml").params
    assert isinstance(params.safety.robot_clearance, float)


def test_numbers_may_be_written_as_in_yaml_1_2() -> None:
    scenario = parse_scenario(BASE + "duration_s: 1e2\nparameters: {perception: {perception_range: .inf}}", "t.yaml")
    assert scenario.duration == 100.0
    assert math.isinf(scenario.params.perception.perception_range)


def test_on_and_off_stay_words_for_the_adapters() -> None:
    scenario = parse_scenario(BASE + "inputs: {emg: {labels: {on: pause, off: resume}}}", "t.yaml")
    assert scenario.inputs["emg"]["labels"] == {"on": "pause", "off": "resume"}


def test_a_given_path_is_followed_by_the_influenced_robot_from_where_it_stands() -> None:
    text = BASE + "path: {circle: {at_m: [570, 350], radius_m: 100}, direction: backward}\ninfluenced: 2"
    start = parse_scenario(text, "t.yaml").setup().start
    assert start.intent.path.kind == PathKind.CIRCLE
    assert start.intent.path.direction == -1.0
    assert start.intent.influenced == 1
    assert start.motion.path_status == PathStatus.FOLLOWING
    assert start.motion.path_parameter == 0.0  # robot 2 stands at angle 0


@pytest.mark.parametrize(
    ("path", "length"),
    [
        ("{line: {at_m: [0, 0], angle_deg: 45}}", math.inf),
        ("{ellipse: {at_m: [600, 350], half_axes_m: [100, 100]}}", 200 * math.pi),
        ("{sketch: {points_m: [[100, 100], [200, 100], [300, 100]]}}", 200.0),
        ("{sketch: {points_m: [[100, 100], [200, 100], [200, 200], [100, 200]], closed: true}}", 400.0),
    ],
)
def test_a_path_can_be_a_line_an_ellipse_or_a_sketch(path: str, length: float) -> None:
    scenario = parse_scenario(f"{BASE}path: {path}", "t.yaml")
    assert scenario.path.length == pytest.approx(length, rel=0.1)


def test_shipped_strokes_name_their_robot_by_index() -> None:
    (stroke,) = parse_scenario(
        BASE + "strokes: [{name: over, robot: 3, points_m: [[1, 1], [2, 2], [9, 9]]}]", "t.yaml"
    ).strokes
    assert (stroke.name, stroke.robot, stroke.points.shape) == ("over", 2, (3, 2))


def test_the_filter_is_distributed_unless_the_file_says_otherwise() -> None:
    assert parse_scenario(BASE, "t.yaml").filter is FilterKind.DISTRIBUTED
    assert parse_scenario(BASE + "filter: centralised", "t.yaml").filter is FilterKind.CENTRALISED


def test_a_scenario_is_named_by_its_file_unless_it_names_itself(tmp_path: FilePath) -> None:
    (tmp_path / "mine.yaml").write_text(BASE)
    assert load_scenario(tmp_path / "mine.yaml").name == "mine"
    assert load_scenario(str(tmp_path / "mine.yaml")).name == "mine"
    assert parse_scenario(BASE + "name: other", "mine.yaml").name == "other"


def test_a_wheel_without_a_checkout_has_its_scenarios_inside(
    tmp_path: FilePath, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "site-packages" / "higvf_console"
    (package / "scenario").mkdir(parents=True)
    shutil.copytree(scenario_module.data_folder() / "scenarios", package / "scenarios")
    (package / "scenarios" / "empty.yaml").rename(package / "scenarios" / "bare.yaml")
    monkeypatch.setattr(scenario_module, "__file__", str(package / "scenario" / "scenario.py"))
    assert "bare" in scenario_names()
    assert load_scenario("bare").name == "bare"


def test_names_of_version_0_1_mean_the_same_and_the_present_ones_are_named() -> None:
    values = ("reactive_margin: 41", "2.5", "9", "printed")
    former = "parameters: {{rings: {{{}}}, path: {{patience: {}}}, safety: {{pair_rate: {}}}}}\nforms: {{fire_row: {}}}"
    today = (
        "parameters: {{boundaries: {{{}}}, path: {{progress_timeout: {}}}, safety: {{pair_gain: {}}}}}\n"
        "forms: {{fire_constraint: {}}}"
    )
    old = parse_scenario(BASE + former.format(*values), "t.yaml")
    new = parse_scenario(BASE + today.format(*values), "t.yaml")
    assert old.params == new.params
    assert new.warnings == ()
    assert old.warnings == (
        "t.yaml: parameters.rings: renamed; write parameters.boundaries",
        "t.yaml: parameters.path.patience: renamed; write parameters.path.progress_timeout",
        "t.yaml: parameters.safety.pair_rate: renamed; write parameters.safety.pair_gain",
        "t.yaml: forms.fire_row: renamed; write forms.fire_constraint",
    )
