"""Every way in which a scenario file can be wrong is told in one sentence: file, key path, value, choices."""

import re
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import PathEnding
from higvf_console.scenario.scenario import load_scenario, parse_scenario, scenario_names

BASE = """
version: 1
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350], [730, 350]]}
"""

# What is added to (or replaces a line of) the base, and what the message must say.
MISTAKES = {
    "unknown section": (
        "firez: []", "t.yaml: firez: unknown key (did you mean 'fires'?); value []; known keys: version,"
    ),
    "unknown key": (
        "fires: [{at_m: [1, 2], radius_m: 3, groth_m_per_s: 1}]",
        "fires[1].groth_m_per_s: unknown key (did you mean 'growth_m_per_s'?); value 1; known keys: at_m, radius_m",
    ),
    "missing key": ("fires: [{at_m: [1, 2]}]", "fires[1]: the key 'radius_m' is missing"),
    "missing section": ("robots: {}", "robots: the key 'count' is missing; known keys: "),
    "wrong version": ("version: 2", "version: 2 is not a version that this console reads; known versions: 1"),
    "boolean version": ("version: true", "version: True is not a version"),
    "number as text": (
        "fires: [{at_m: [1, 2], radius_m: wide}]", "fires[1].radius_m: 'wide' is not a number from 0.001 to 1e+06 m"
    ),
    "boolean as number": ("duration_s: true", "duration_s: True is not a number"),
    "too many digits": (f"duration_s: {'9' * 5000}", "line 5: '99999"),
    "a tag that does not fit": ("duration_s: !!int soon", "t.yaml: line 5: 'soon' cannot be read as 'int'"),
    "a tag of nothing": ('duration_s: !!int ""', "line 5: '' cannot be read as 'int'"),
    "nested without end": (f"title: {'[' * 2000}", "t.yaml: brackets are nested over 100 deep"),
    "beyond all numbers": (f"duration_s: {10**400}", "is not a number from 0.001 to 1e+06 s"),
    "not a number": ("duration_s: .nan", "duration_s: nan is not a number"),
    "a parameter by both its names": (
        "parameters: {safety: {pair_rate: 1, pair_gain: 1}}",
        "safety.pair_gain: pair_rate is the former name of pair_gain, which is given too; remove pair_rate",
    ),
    "a group by both its names": (
        "parameters: {boundaries: {}, rings: {}}",
        "parameters.rings: rings is the former name of boundaries, which is given too; remove rings",
    ),
    "octal is text": ("duration_s: 010", "duration_s: '010' is not a number"),
    "number out of range": ("duration_s: -3", "duration_s: -3 is not a number from 0.001 to 1e+06 s"),
    "parameter out of range": (
        "parameters: {safety: {control_period: 2}}",
        "t.yaml: parameters.safety.control_period: 2 is not a number from 0.001 to 0.1 s",
    ),
    "unknown parameter": (
        "parameters: {blending: {cruisespeed: 2}}",
        "parameters.blending.cruisespeed: unknown key (did you mean 'cruise_speed'?)",
    ),
    "unknown parameter group": ("parameters: {saftey: {}}", "parameters.saftey: unknown key (did you mean 'safety'?)"),
    "point of three": ("fires: [{at_m: [1, 2, 3], radius_m: 3}]", "[1].at_m: [1, 2, 3] is not a point [x, y]"),
    "section as list": ("parameters: []", "parameters: [] is not a section with the keys path, boundaries,"),
    "list as section": ("fires: {}", "fires: {} is not a list"),
    "text wanted": ("title: 5", "title: 5 is not a text"),
    "flag wanted": ("arena: {size_m: [1200, 700], walls: off}", "arena.walls: 'off' is not true or false"),
    "unknown word": ("filter: fast", "filter: 'fast' is not one of distributed, centralised"),
    "key twice": ("title: a\ntitle: b", "line 6: key 'title' is given twice"),
    "not YAML": ("title: [", "t.yaml: line 5: did not find expected node content"),
    "key that is no text": ("1: 2", "line 5: key 1 is not text"),
    "empty arena": ("arena: {x_min: 0, y_min: 0, x_max: 0, y_max: 9}", "arena: an arena of 0 m x 9 m has no area"),
    "arena twice": ("arena: {size_m: [1, 2], x_min: 0}", "arena: give size_m, or x_min, y_min, x_max and y_max,"),
    "half an arena": ("arena: {x_min: 0, y_min: 0, x_max: 0}", "arena: the key 'y_max' is missing"),
    "no robots": ("robots: {start_m: []}", "robots.start_m: 0 points are too few; give at least 1"),
    "count of zero": (
        "robots: {count: 0, spacing_m: 40}", "count: 0 is not a number of robots, a whole number from 1 to 100000"
    ),
    "robots twice": ("robots: {start_m: [[1, 2]], count: 3}", "robots: give start_m, or count and spacing_m, not both"),
    "robots overlap": (
        "robots: {start_m: [[700, 300], [710, 300]]}",
        "robots: robots 1 and 2 start 10.00 m apart; robot_clearance is 25 m",
    ),
    "robots on one spot": ("robots: {start_m: [[700, 300], [700, 300]]}", "robots 1 and 2 start 0.000 m apart"),
    "grid too tight": ("robots: {count: 9, spacing_m: 20}", "start 20.00 m apart; robot_clearance is 25 m"),
    "robot outside": (
        "robots: {start_m: [[700, 300], [1300, 350]]}",
        "robots: robot 2 at (1300, 350) is -100.00 m from the arena's wall; obstacle_clearance is 12 m",
    ),
    "robot at the wall": ("robots: {start_m: [[700, 5]]}", "robot 1 at (700, 5) is 5.00 m from the arena's wall"),
    "robot in a circle": (
        "obstacles: {circles: [{at_m: [0, 0], radius_m: 1}, {at_m: [670, 380], radius_m: 20}]}",
        "robot 2 at (670, 350) is 10.00 m from circle 2; obstacle_clearance is 12 m",
    ),
    "robot in a bar": (
        "obstacles: {bars: [{from_m: [0, 360], to_m: [900, 360], half_width_m: 6}]}",
        "robot 2 at (670, 350) is 4.00 m from bar 1",
    ),
    "robot at a polygon's edge": (
        "obstacles: {polygons: [{points_m: [[0, 0], [9, 0], [9, 9]]}, "
        "{points_m: [[600, 360], [690, 360], [640, 390]]}]}",
        "robot 2 at (670, 350) is 10.00 m from polygon 2",
    ),
    "robot deep inside a polygon": (
        "obstacles: {polygons: [{points_m: [[500, 100], [900, 100], [900, 600], [500, 600]]}]}",
        "robot 1 at (700, 300) is -200.00 m from polygon 1; obstacle_clearance is 12 m",
    ),
    "polygon of two points": (
        "obstacles: {polygons: [{points_m: [[1, 1], [9, 9], [9, 9], [1, 1]]}]}",
        "obstacles.polygons[1].points_m: a polygon needs at least 3 distinct points; this one has 2",
    ),
    "polygon that crosses itself": (
        "obstacles: {polygons: [{points_m: [[0, 0], [90, 90], [90, 0], [0, 90]]}]}",
        "polygons[1].points_m: the polygon crosses or touches itself: edge 1 from (0, 0) to (90, 90) and "
        "edge 3 from (90, 0) to (0, 90)",
    ),
    "flat polygon": (
        "obstacles: {polygons: [{points_m: [[0, 0], [90, 0], [50, 1e-9]]}]}",
        "polygons[1].points_m: the polygon has an area of 4.5e-08 m^2; give it at least 1e-06 m^2",
    ),
    "endless polygon": (
        f"obstacles: {{polygons: [{{points_m: {[[k, k * k] for k in range(501)]}}}]}}",
        "polygons[1].points_m: the polygon has 501 edges; at most 500 are possible",
    ),
    "too many polygons": (
        f"obstacles: {{polygons: {[{'points_m': [[9, 9], [19, 9], [9, 19]]}] * 167}}}",
        "obstacles: polygons and masks have 501 edges together, at most 500 are possible; give polygons fewer points",
    ),
    "polygon as a bar": (
        "obstacles: {polygons: [{points_m: [[0, 0], [9, 0], [9, 9]], half_width_m: 1}]}",
        "obstacles.polygons[1].half_width_m: unknown key; value 1; known keys: points_m",
    ),
    "polygon of words": (
        "obstacles: {polygons: [{points_m: [[0, 0], [90, x], [0, 60]]}]}",
        "t.yaml: obstacles.polygons[1].points_m[2][2]: 'x' is not a number",
    ),
    "mask of a number": (
        "obstacles: {masks: [{image: 5, at_m: [0, 0], metres_per_pixel: 1}]}",
        "t.yaml: obstacles.masks[1].image: 5 is not a text",
    ),
    "mask with an endless name": (
        f"obstacles: {{masks: [{{image: {'a' * 5000}, at_m: [0, 0], metres_per_pixel: 1}}]}}", "File name too long"
    ),
    "mask without a scale": (
        "obstacles: {masks: [{image: plan.png, at_m: [0, 0]}]}",
        "obstacles.masks[1]: the key 'metres_per_pixel' is missing; known keys: image, at_m, metres_per_pixel,",
    ),
    "mask without its image": (
        "obstacles: {masks: [{image: plan.png, at_m: [0, 0], metres_per_pixel: 2}]}",
        "t.yaml: obstacles.masks[1].image: no image 'plan.png' in ",
    ),
    "threshold beyond white": (
        "obstacles: {masks: [{image: plan.png, at_m: [0, 0], metres_per_pixel: 2, threshold: 256}]}",
        "masks[1].threshold: 256 is not a number from 0 to 255",
    ),
    "neither dark nor bright": (
        "obstacles: {masks: [{image: plan.png, at_m: [0, 0], metres_per_pixel: 2, obstacle: red}]}",
        "masks[1].obstacle: 'red' is not one of dark, bright",
    ),
    "robot in a fire": ("fires: [{at_m: [700, 310], radius_m: 20}]", "robot 1 at (700, 300) is -10.00 m from fire 1"),
    "too many needed": (
        "fires: [{at_m: [100, 100], radius_m: 20, robots_needed: 4}]",
        "fires[1].robots_needed: 4 is not within the team of 3, a whole number from 1 to 3",
    ),
    "link to itself": ("links: [[1, 1]]", "links[1]: [1, 1] is not a link between two robots, such as [1, 2]"),
    "link to nobody": ("links: [[1, 2], [2, 4]]", "links[2][2]: 4 is not a robot's number, a whole number from 1 to 3"),
    "formation of two": ("formation_m: [[0, 0], [1, 1]]", "formation_m: 2 points for 3 robots; give one for each"),
    "two paths": ("path: {circle: {}, line: {}}", "path: give exactly one of: line, circle, ellipse, sketch"),
    "a path that is none": (
        "path: {sketch: {points_m: [[1, 1], [1, 1], [1, 1]]}}",
        "path.sketch: a stroke needs at least 3 distinct points; this one has 1",
    ),
    "flat ellipse": (
        "path: {ellipse: {at_m: [1, 1], half_axes_m: [1, 0]}}", "path.ellipse: an ellipse's half axes must be positive"
    ),
    "unknown direction": (
        "path: {circle: {at_m: [1, 1], radius_m: 9}, direction: -1}",
        "path.direction: -1 is not one of forward, backward",
    ),
    "nobody influenced": ("influenced: 4", "influenced: 4 is not a robot's number, a whole number from 1 to 3"),
    "stroke of two": ("strokes: [{name: a, points_m: [[1, 1], [2, 2]]}]", "strokes[1].points_m: 2 points are too few"),
    "settings as text": ("inputs: {emg: loud}", "inputs.emg: 'loud' is not a mapping"),
    "boundaries the wrong way": (
        "parameters: {boundaries: {reactive_margin: 14}}",
        "parameters.boundaries: reactive_margin is 14 m and must be above repulsive_margin, 14 m",
    ),
    "too fast for the control period": (
        "parameters: {blending: {cruise_speed: 400}}",
        "t.yaml: parameters.safety: pair barriers do not hold between two control steps: dt * rate * h_near^2 = ",
    ),
    "stand-off inside the barrier": (
        "fires: [{at_m: [100, 100], radius_m: 32}]\nparameters: {fires: {stand_off: 13}}",
        "parameters.fires.stand_off: 13 m is too near to fire 1 (32 m, growing 1 m/s), whose barrier holds robots 14.",
    ),
    "unicycles that cannot turn": (
        "parameters: {robots: {look_ahead: 2, turn_rate_limit: 0}}",
        "parameters.robots.turn_rate_limit: unicycles that cannot turn cannot follow a velocity; give more than 0",
    ),
    "more noise than the barriers bear": (
        "parameters: {robots: {position_noise: 4}}",
        "parameters.robots.position_noise: 4 m exceeds 3.29 m, up to which the barriers keep the true clearances",
    ),
    "loss above one": ("parameters: {robots: {packet_loss: 1.5}}", "robots.packet_loss: 1.5 is not a number from"),
    "a seed of its own": ("parameters: {robots: {seed: 3}}", "parameters.robots.seed: unknown key"),
    "unicycles that overlap": (
        "parameters: {robots: {look_ahead: 20, position_noise: 1}}",
        "start 58.31 m apart; robot_clearance is 25 m, enlarged to 67 m by look_ahead 20 m and position_noise 1 m",
    ),
    "a look-ahead point in a circle": (
        "parameters: {robots: {look_ahead: 6}}\nobstacles: {circles: [{at_m: [700, 270], radius_m: 14}]}",
        "is 16.59 m from circle 1; obstacle_clearance is 12 m, enlarged to 18 m by look_ahead 6 m",
    ),
    "stand-off inside the enlarged barrier": (
        "fires: [{at_m: [100, 100], radius_m: 32}]\nparameters: {robots: {look_ahead: 12}}",
        "parameters.fires.stand_off: 25 m is too near to fire 1 (32 m, growing 1 m/s), whose barrier holds robots 27.",
    ),
    "stiff formation": (
        "parameters: {formation: {formation_rate: 25}}",
        "control_period x formation_rate x 2 x 2 links of one robot is 2 and must stay below 2",
    ),
}  # fmt: skip


def with_line(line: str) -> str:
    """The base with `line` in place of the line of the same key, or added."""
    key = line.partition(":")[0]
    text, replaced = re.subn(rf"(?m)^{key}:.*$", lambda _: line, BASE)
    return text if replaced else BASE + line


@pytest.mark.parametrize(("line", "sentence"), MISTAKES.values(), ids=MISTAKES.keys())
def test_a_mistake_is_told_in_one_sentence(line: str, sentence: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        parse_scenario(with_line(line), "t.yaml")
    message = str(caught.value)
    assert message.startswith("t.yaml")
    assert sentence in message
    assert message.count("t.yaml") == 1
    assert "\n" not in message


def test_of_a_long_value_the_beginning_is_told() -> None:
    tenfold = ", ".join(f"&a{k} [{f'*a{k - 1}, ' * 10}]" for k in range(1, 5))
    bomb = f"firez: [&a0 [x], {tenfold}]"
    with pytest.raises(ScenarioError, match=r"firez: unknown key .* value \[\[") as caught:
        parse_scenario(with_line(bomb), "t.yaml")
    assert len(str(caught.value)) < 1000


def test_an_unknown_scenario_is_answered_with_the_names() -> None:
    with pytest.raises(ScenarioError, match="did you mean 'firefighting'") as caught:
        load_scenario("firefihgting")
    assert all(name in str(caught.value) for name in scenario_names())


def test_a_missing_file_and_a_file_of_bytes_are_scenario_errors(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"none\.yaml: No such file"):
        load_scenario(tmp_path / "none.yaml")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ScenarioError, match=r"bytes\.yaml: not UTF-8 text"):
        load_scenario(tmp_path / "bytes.yaml")
    (tmp_path / "null.yaml").write_bytes(b"version: \x00")
    with pytest.raises(ScenarioError, match=r"null\.yaml: unacceptable character"):
        load_scenario(tmp_path / "null.yaml")


def test_a_jitter_that_makes_robots_overlap_is_refused_with_the_seed_that_does_it() -> None:
    text = with_line("robots: {count: 9, spacing_m: 30, jitter_m: 8}")
    with pytest.raises(ScenarioError, match="apart; robot_clearance is 25 m"):
        for seed in range(20):
            parse_scenario(text, "t.yaml").setup(seed)


@pytest.mark.parametrize("text", ["", "\n\n", "# nothing yet\n"])
def test_an_empty_file_is_called_empty(text: str) -> None:
    with pytest.raises(ScenarioError, match=r"none\.yaml: the file is empty"):
        parse_scenario(text, "none.yaml")


def test_each_unicycle_is_given_a_heading_or_all_the_same() -> None:
    start = "version: 1\narena: {size_m: [900, 500]}\nrobots: {start_m: [[100, 100], [200, 200]], heading_deg: "
    assert np.degrees(parse_scenario(start + "[10, -20]}\n", "t.yaml").robots.heading) == pytest.approx([10, -20])
    assert np.degrees(parse_scenario(start + "30}\n", "t.yaml").robots.heading) == pytest.approx([30, 30])
    with pytest.raises(
        ScenarioError, match=r"robots\.heading_deg: 1 headings for 2 robots; give one for all robots, or one for each"
    ):
        parse_scenario(start + "[10]}\n", "t.yaml")


@pytest.mark.parametrize(
    ("way", "message"),
    [
        ("ending: stop", r"path\.ending: 'stop' is not one of release, hold, loop"),
        ("pace: 9", r"path\.pace: 9 is not a number from 0.2 to 1.5"),
        ("duration_s: -1", r"path\.duration_s: -1 is not a number"),
    ],
)
def test_how_a_path_is_followed_is_checked(way: str, message: str) -> None:
    start = "version: 1\narena: {size_m: [900, 500]}\nrobots: {start_m: [[100, 100]]}\n"
    path = "path: {circle: {at_m: [400, 250], radius_m: 100}, "
    with pytest.raises(ScenarioError, match=message):
        parse_scenario(start + path + way + "}\n", "t.yaml")
    scenario = parse_scenario(start + path + "ending: loop, pace: 0.5, duration_s: 9}\n", "t.yaml")
    assert (scenario.path.ending, scenario.path.pace, scenario.path.duration) == (PathEnding.LOOP, 0.5, 9.0)
    assert scenario.setup().start.motion.path_left == 9.0


@pytest.mark.parametrize(
    ("section", "count", "sentence"),
    [
        ("obstacles: {{circles: [{}]}}", 20_001, "obstacles.circles: 20001 entries; give at most 20000"),
        ("fires: [{}]", 1001, "fires: 1001 entries; give at most 1000"),
        ("strokes: [{}]", 100_001, "strokes: 100001 entries; give at most 100000"),
    ],
)
def test_lists_that_no_run_could_bear_are_refused(section: str, count: int, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        parse_scenario(with_line(section.format(", ".join(["0"] * count))), "t.yaml")
