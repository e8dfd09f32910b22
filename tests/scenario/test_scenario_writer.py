"""What is written of a run starts the same run again."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from higvf_console.control.forms import FORMS
from higvf_console.control.guidance.paths import EVERYWHERE, nearest, path_points
from higvf_console.core.arrays import floats
from higvf_console.core.commands import OperatorCommand, Pick, Prioritise, ShapePath
from higvf_console.core.edits import (
    AddEntity,
    ChangeEntity,
    DeleteEntity,
    EntityKind,
    LinkByRange,
    MoveEntity,
    SetArena,
    SetParameters,
    ToggleLink,
)
from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import Motion, PathEnding, PathKind, PathStatus
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import Scenario, load_scenario, parse_scenario, scenario_names
from higvf_console.scenario.writer import rounded_lengths, scenario_yaml
from higvf_console.world.setup import Setup
from tests.teams import stroke

SMALL = tuple(name for name in scenario_names() if name != "swarm")


def run_of(scenario: Scenario, *commands: OperatorCommand, ticks: int = 0) -> Run:
    run = Run(scenario.setup(7), scenario.filter, scenario)
    for command in commands:
        run.apply(command)
    for _ in range(ticks):
        run.step()
    return run


def written(run: Run) -> Scenario:
    return parse_scenario(scenario_yaml(run.setup, run.state, run.scenario), "again.yaml")


def same_bytes(first: Any, second: Any) -> None:
    for name, a, b in zip(first._fields, first, second, strict=True):
        assert np.asarray(a).tobytes() == np.asarray(b).tobytes(), name


def assert_same_start(run: Run, again: Setup) -> None:
    """World (of what burns), parameters, positions and fires, bit for bit; courses and unicycles up to rounding."""
    burning = run.state.motion.fire_burning
    world = run.setup.world
    fires = {name: getattr(world, name)[burning] for name in ("fire_position", "fire_growth", "fire_needs")}
    courses = {name: getattr(again.world, name) for name in ("mover", "course")}
    for name, course in courses.items():
        np.testing.assert_allclose(course, getattr(world, name), rtol=1e-12, atol=1e-9)
    same_bytes(world._replace(**fires, **courses), again.world)
    params = run.setup.params
    assert again.params._replace(robots=again.params.robots._replace(seed=params.robots.seed)) == params
    motion, start = run.state.motion, again.start.motion
    assert start.fire_radius.tobytes() == motion.fire_radius[burning].tobytes()
    if params.robots.look_ahead > 0.0:
        np.testing.assert_allclose(start.position, motion.position, atol=1e-9)
        np.testing.assert_allclose(np.cos(start.heading - motion.heading), 1.0, atol=1e-12)
    else:
        assert start.position.tobytes() == motion.position.tobytes()
    assert again.arena == run.setup.arena
    assert [chain.tobytes() for chain in again.layout.obstacles.polygons] == [
        chain.tobytes() for chain in run.setup.layout.obstacles.polygons
    ]
    assert again.start.intent.influenced == run.state.intent.influenced


@pytest.mark.parametrize("name", scenario_names())
def test_a_shipped_scenario_starts_the_same_run_when_it_is_written_and_read(name: str) -> None:
    scenario = load_scenario(name)
    run = run_of(scenario)
    again = written(run)
    assert_same_start(run, again.setup(7))
    for kept in ("name", "title", "description", "walls", "links", "filter", "inputs", "limits", "demo", "duration"):
        assert getattr(again, kept) == getattr(scenario, kept), kept
    assert [(s.name, s.robot, s.points.tolist()) for s in again.strokes] == [
        (s.name, s.robot, s.points.tolist()) for s in scenario.strokes
    ]


@pytest.mark.parametrize("name", ["firefighting", "building", "unicycles", "circle-obstacles"])
def test_a_run_that_has_gone_on_starts_again_from_where_it_is(name: str) -> None:
    run = run_of(load_scenario(name), ticks=150)
    assert_same_start(run, written(run).setup(7))


def test_fires_that_are_out_are_left_out(team: Scenario) -> None:
    run = run_of(team)
    while run.state.motion.fire_burning.any():
        run.step()
    assert written(run).fires == ()


SCENE = """
version: 1
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350], [730, 350], [640, 300]]}
fires: [{at_m: [500, 250], radius_m: 20}, {at_m: [900, 600], radius_m: 30, robots_needed: 3}]
obstacles:
  circles: [{at_m: [300, 200], radius_m: 20}]
  bars: [{from_m: [900, 230], to_m: [900, 400], half_width_m: 6}]
  polygons: [{points_m: [[100, 100], [200, 100], [200, 200], [100, 200]],
              free_m: [[[120, 120], [120, 150], [150, 150], [150, 120]]]}]
"""
PLACES = st.tuples(st.floats(60.0, 1140.0), st.floats(60.0, 640.0)).map(floats)
KINDS = st.sampled_from(["robot", "fire", "circle", "bar", "polygon"])
NUMBERS = st.sampled_from(["x", "y", "radius", "growth", "needs", "length", "half width", "angle", "size"])
PARAMETERS = st.one_of(
    st.floats(30.0, 80.0).map(lambda speed: {"blending.cruise_speed": speed}),
    st.floats(2.0, 11.0).map(lambda rate: {"safety.pair_gain": rate}),
    st.floats(1.0, 9.0).map(lambda factor: {"perception.priority": factor}),
)
EDITS = st.one_of(
    st.builds(AddEntity, kind=KINDS, point=PLACES),
    st.builds(MoveEntity, kind=KINDS, index=st.integers(0, 3), point=PLACES),
    st.builds(
        ChangeEntity, kind=KINDS, index=st.integers(0, 3), name=NUMBERS, value=st.floats(0.3, 180.0)
    ),
    st.builds(DeleteEntity, kind=KINDS, index=st.integers(0, 3)),
    st.builds(ToggleLink, first=st.integers(0, 3), second=st.integers(0, 3)),
    st.builds(LinkByRange),
    st.builds(SetArena, sides=st.just(floats([-10.5, 0.0, 1300.25, 720.0])), walls=st.booleans()),
    st.builds(SetParameters, values=PARAMETERS),
    st.builds(Pick, robot=st.integers(0, 3)),
)  # fmt: skip


@settings(max_examples=40)
@given(edits=st.lists(EDITS, max_size=6), ticks=st.sampled_from([0, 3]))
def test_an_edited_world_is_read_as_it_was_written(edits: list[OperatorCommand], ticks: int) -> None:
    run = run_of(parse_scenario(SCENE, "scene.yaml"), *edits, ticks=ticks)
    assert_same_start(run, written(run).setup(7))


def test_walls_from_an_image_become_polygons_with_their_free_areas() -> None:
    scenario = load_scenario("building")
    text = scenario_yaml(*run_state(run_of(scenario)), scenario)
    assert "masks" not in text
    assert len(parse_scenario(text, "again.yaml").obstacles.polygons) == len(scenario.obstacles.polygons)


def run_state(run: Run) -> tuple[Setup, Any]:
    return run.setup, run.state


def test_lengths_are_saved_in_millimetres_for_people_unless_no_run_could_start_from_them(team: Scenario) -> None:
    run = run_of(team, MoveEntity(EntityKind.FIRE, 0, floats([500.0, 249.9999868017535])), ticks=3)
    text = scenario_yaml(run.setup, run.state, team, rounded=True)
    assert parse_scenario(text, "again.yaml").fires[0].position == (500.0, 250.0)
    again = parse_scenario(text, "again.yaml").setup(7).start.motion
    assert (again.position == np.round(run.state.motion.position, 3)).all()
    tiny = {"arena": {"x_min": 0.00004}, "fires": [{"at_m": [1.23456, 2], "growth_m_per_s": 0.12345}], "seed": 1.23456}
    assert rounded_lengths(tiny, 3) == {
        "arena": {"x_min": 0.0}, "fires": [{"at_m": [1.235, 2], "growth_m_per_s": 0.12345}], "seed": 1.23456,
    }  # fmt: skip
    touching = "[[700, 300.0006], [712.5, 321.65124]]"  # half a millimetre nearer, and they were too near
    lines = f"version: 1\narena: {{size_m: [1200, 700]}}\nrobots: {{start_m: {touching}}}\n"
    close = run_of(parse_scenario(lines, "close.yaml"))
    assert "300.0006" in scenario_yaml(close.setup, close.state, None, rounded=True)


def test_free_areas_are_read_and_wrong_ones_refused() -> None:
    scenario = parse_scenario(SCENE, "scene.yaml")
    assert [len(chain) for chain in scenario.obstacles.polygons] == [4, 4]
    for area, reason in (
        ("[[120, 120], [120, 250], [150, 250]]", "lies inside the polygon"),
        ("[[100, 120], [120, 150], [150, 120]]", "touch"),
        ("[[120, 120], [121, 121]]", "at least 3"),
    ):
        wrong = SCENE.replace("[[120, 120], [120, 150], [150, 150], [150, 120]]", area)
        with pytest.raises(ScenarioError, match=rf"obstacles.polygons\[1\]\.free_m.*{reason}"):
            parse_scenario(wrong, "scene.yaml")


def test_an_open_path_is_written_from_where_it_is_left_to_follow(team: Scenario) -> None:
    line = [(700.0, 300.0), (500.0, 500.0), (200.0, 500.0)]
    run = run_of(team, *stroke(line), ShapePath(ending="hold", pace=0.5, duration=30.0), ticks=200)
    old, new = run.state.intent.path, written(run).setup().start.intent.path
    assert run.state.motion.path_status == PathStatus.FOLLOWING
    assert (new.ending, new.pace, new.direction) == (PathEnding.HOLD, 0.5, 1.0)
    assert new.duration == run.state.motion.path_left < 27.0
    assert new.length == pytest.approx(old.length - run.state.motion.path_parameter, rel=1e-3)
    assert off_path(new, old) < 0.05


@pytest.mark.parametrize("shape", ["open", "closed"])
def test_a_path_that_starts_again_is_written_as_a_whole(team: Scenario, shape: str) -> None:
    angles = np.linspace(0.0, 2.0 * math.pi if shape == "closed" else 3.0, 30)
    line = floats(np.stack([700.0 - 200.0 * (1.0 - np.cos(angles)), 300.0 + 200.0 * np.sin(angles)], axis=1))
    run = run_of(team, *stroke(line), ShapePath(ending="loop"), ticks=100)
    old, new = run.state.intent.path, written(run).setup().start.intent.path
    assert (new.closed, new.ending) == (shape == "closed", PathEnding.LOOP)
    assert new.length == pytest.approx(old.length, rel=1e-3)
    assert off_path(new, old) < 0.05


def off_path(new: Any, old: Any) -> float:
    points = path_points(new, floats(np.linspace(0.0, new.length, 50)))
    return max(math.dist(point, nearest(old, 0.0, EVERYWHERE, *point)[1:3]) for point in points.tolist())


def test_a_path_that_is_over_is_not_written(team: Scenario) -> None:
    run = run_of(team, *stroke([(700.0, 300.0), (690.0, 310.0), (680.0, 320.0)]), ticks=200)
    assert run.state.motion.path_status == PathStatus.FINISHED
    assert written(run).path.kind == PathKind.NONE


def test_a_line_and_a_backward_circle_come_back() -> None:
    for path in (
        "{line: {at_m: [1, 2], angle_deg: 30}}",
        "{circle: {at_m: [600, 300], radius_m: 50.5}, direction: backward}",
    ):
        run = run_of(parse_scenario(SCENE + f"path: {path}\n", "scene.yaml"))
        old, new = run.state.intent.path, written(run).path
        assert (new.kind, new.direction) == (old.kind, old.direction)
        np.testing.assert_allclose(new.shape, old.shape, rtol=1e-15)


def test_forms_of_the_equations_come_back_by_name_or_one_by_one(team: Scenario) -> None:
    printed = team.with_forms(FORMS["printed"])
    assert written(run_of(printed)).params.forms == FORMS["printed"]
    mixed = team.with_forms(FORMS["corrected"]._replace(bump=1.0))
    assert written(run_of(mixed)).params.forms == mixed.params.forms


def test_words_that_look_like_numbers_come_back_as_text() -> None:
    for title in ("1e3", "on", "12:30", "0x10", "null", "# 1", "1_000", "Grüße: 'x'"):
        scenario = parse_scenario(SCENE + f"title: {quoted(title)}\n", "scene.yaml")
        assert written(run_of(scenario)).title == title


def quoted(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"


def test_a_stroke_for_a_robot_that_is_gone_is_for_whoever_is_influenced() -> None:
    scenario = parse_scenario(SCENE + "strokes: [{name: a, robot: 4, points_m: [[0, 0], [9, 9], [20, 0]]}]\n", "s.yaml")
    run = run_of(scenario, DeleteEntity("robot", 3))
    assert written(run).strokes[0].robot is None


def test_every_unicycle_has_its_own_heading() -> None:
    run = run_of(load_scenario("unicycles"), ChangeEntity("robot", 1, "heading", -31.4))
    again = written(run).setup()
    np.testing.assert_allclose(np.degrees(again.start.motion.heading), [90.0, -31.4, 90.0], rtol=1e-14)


def test_a_run_without_a_scenario_can_be_written_too(team: Scenario) -> None:
    run = Run(team.setup())
    assert_same_start(run, parse_scenario(scenario_yaml(run.setup, run.state, None), "again.yaml").setup())


def test_priorities_are_not_of_the_scenario(team: Scenario) -> None:
    run = run_of(team, Prioritise(fires=(0,)))
    assert len(run.state.intent.priority) == 1
    assert len(written(run).setup().start.intent.priority) == 0


def test_what_no_run_can_start_from_is_refused_with_the_reason(team: Scenario) -> None:
    run = run_of(team)
    too_near = run.state.motion.position.copy()
    too_near[1] = too_near[0] + 5.0
    state = run.state._replace(motion=run.state.motion._replace(position=too_near))
    with pytest.raises(ScenarioError, match=r"cannot be a scenario's start: .*robots 1 and 2 start 7\.07 m apart"):
        scenario_yaml(run.setup, state, team)


def test_robots_at_their_clearance_to_the_last_bit_can_be_written(team: Scenario) -> None:
    run = run_of(team)
    position = run.state.motion.position.copy()
    position[1] = position[0] + (25.0 - 1e-9, 0.0)
    motion: Motion = run.state.motion._replace(position=position)
    assert_same_start_position(scenario_yaml(run.setup, run.state._replace(motion=motion), team), motion)


def assert_same_start_position(text: str, motion: Motion) -> None:
    assert parse_scenario(text, "again.yaml").setup().start.motion.position.tobytes() == motion.position.tobytes()


def test_a_team_whose_links_are_all_parted_stays_so(team: Scenario) -> None:
    run = run_of(parse_scenario(team.text + "links: [[1, 2], [2, 3]]\n", "team.yaml"))
    for pair in ((0, 1), (1, 2)):
        run.apply(ToggleLink(*pair))
    assert len(run.setup.world.link_to) == 0
    assert written(run).links == ()
