"""What each edit does to a run, and what it refuses."""

import math

import numpy as np
import pytest

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import OperatorCommand, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.edits import (
    AddEntity,
    AddOutlines,
    ChangeEntity,
    DeleteEntity,
    Edit,
    EntityKind,
    LinkByRange,
    MoveEntity,
    SetArena,
    SetParameters,
    ToggleLink,
)
from higvf_console.core.state import ACTING, PathStatus
from higvf_console.runtime.history import History
from higvf_console.runtime.run import Run
from higvf_console.scenario.scenario import load_scenario
from higvf_console.world.build import build_world
from higvf_console.world.editing.entities import NUMBERS, EntityRef, centres, entity_at, how_many, numbers_of
from tests.teams import stroke
from tests.world.editing.actions import HAIR, assert_same, edited_run, give, refused, shortfalls


def numbers(run: Run, thing: EntityKind, row: int) -> dict[str, float]:
    return numbers_of(EntityRef(thing, row), run.setup.layout, run.state.motion)


def at(x: float, y: float) -> Floats:
    return floats([x, y])


@pytest.mark.parametrize("thing", ["robot", "fire", "circle", "bar"])
def test_a_thing_is_added_where_it_is_wanted_and_is_the_last_of_its_kind(thing: str) -> None:
    run = edited_run(ticks=5)
    kind = EntityKind(thing)
    before = how_many(kind, run.setup.layout)
    events = give(run, AddEntity(thing, at(1000.0, 150.0)))
    assert not refused(events)
    assert how_many(kind, run.setup.layout) == before + 1
    new = numbers(run, kind, before)
    assert (new["x"], new["y"]) == pytest.approx((1000.0, 150.0))
    for _ in range(50):
        run.step()


@pytest.mark.parametrize("thing", ["fire", "circle", "bar"])
def test_what_is_dropped_on_a_robot_is_held_at_the_nearest_safe_place_and_that_is_said(thing: str) -> None:
    run = edited_run()
    events = give(run, AddEntity(thing, at(700.0, 310.0)))
    assert "held at the nearest safe place" in events[0].text
    assert shortfalls(run).max() <= HAIR


@pytest.mark.parametrize("place", [(300.0, 200.0), (900.0, 300.0), (700.0, 300.0), (510.0, 550.0), (-50.0, 300.0)])
def test_a_robot_dropped_on_something_is_held_beside_it(place: tuple[float, float]) -> None:
    run = edited_run()
    give(run, MoveEntity("robot", 3, floats(place)))
    assert shortfalls(run).max() <= HAIR
    assert np.hypot(*(run.state.motion.position[3] - place)) < 150.0


def test_a_robot_held_beside_a_lone_circle_is_at_the_place_nearest_to_where_it_was_dropped() -> None:
    run = edited_run()
    give(run, MoveEntity("robot", 3, at(310.0, 200.0)))
    x, y = run.state.motion.position[3]
    assert math.dist((x, y), (300.0, 200.0)) == pytest.approx(32.0, abs=1e-3)
    assert (x, y) == pytest.approx((332.0, 200.0), abs=0.5)


@pytest.mark.parametrize(
    ("thing", "name", "value"),
    [
        ("circle", "radius", 33.0), ("circle", "x", 320.0), ("bar", "length", 90.0), ("bar", "half width", 9.0),
        ("bar", "angle", 45.0), ("bar", "y", 333.0), ("polygon", "size", 60.0), ("polygon", "angle", -30.0),
        ("fire", "radius", 31.0), ("fire", "growth", 2.5), ("fire", "needs", 3.0), ("fire", "x", 450.0),
        ("robot", "x", 640.0),
    ],
)  # fmt: skip
def test_a_number_of_a_thing_is_what_it_was_set_to_and_the_others_are_as_they_were(
    thing: str, name: str, value: float
) -> None:
    run = edited_run(ticks=2)
    row = {"polygon": 1, "robot": 3}.get(thing, 0)
    before = numbers(run, EntityKind(thing), row)
    assert not refused(give(run, ChangeEntity(thing, row, name, value)))
    after = numbers(run, EntityKind(thing), row)
    assert after == pytest.approx({**before, name: value})


def test_every_kind_of_thing_has_the_numbers_that_are_listed() -> None:
    run = edited_run()
    for thing, known in NUMBERS.items():
        assert set(numbers(run, thing, 0)) == set(known) - {"speed"}, "which only moving obstacles have"


def test_the_last_robot_stays() -> None:
    run = edited_run()
    give(run, DeleteEntity("robot", 0), DeleteEntity("robot", 0), DeleteEntity("robot", 0))
    before = run.run_state
    events = give(run, DeleteEntity("robot", 0))
    assert events[0].text == "Not done: robot 1 is the last one; a team has at least one robot."
    assert run.setup is before.setup
    assert run.state is before.state
    for _ in range(20):
        run.step()


def test_a_fire_that_needs_more_robots_than_are_left_needs_all_of_them() -> None:
    run = edited_run()
    give(run, DeleteEntity("robot", 0), DeleteEntity("robot", 0))
    assert run.setup.world.fire_needs.tolist() == [2, 2]


@pytest.mark.parametrize("status", ACTING)
def test_whoever_is_influenced_when_that_robot_is_deleted_the_human_intention_is_over(status: PathStatus) -> None:
    run = edited_run()
    give(run, *stroke([(700.0, 300.0), (500.0, 450.0), (200.0, 500.0)], 2))
    run.step()
    run.state = run.state._replace(motion=run.state.motion._replace(path_status=int(status)))
    give(run, DeleteEntity("robot", 2))
    assert (run.state.intent.influenced, run.state.motion.path_status) == (0, PathStatus.FINISHED)
    for _ in range(20):
        run.step()


def test_the_influenced_robot_keeps_its_path_under_its_new_number() -> None:
    run = edited_run()
    give(run, *stroke([(700.0, 300.0), (500.0, 450.0), (200.0, 500.0)], 2))
    run.step()
    give(run, DeleteEntity("robot", 0))
    assert (run.state.intent.influenced, run.state.motion.path_status) == (1, PathStatus.FOLLOWING)


def test_robots_whose_target_is_deleted_choose_another_and_the_others_keep_theirs() -> None:
    run = edited_run(ticks=3)
    targets = run.state.motion.target.tolist()
    assert set(targets) == {0, 1}
    give(run, DeleteEntity("fire", 0))
    assert run.state.motion.target.tolist() == [target - 1 for target in targets]  # -1 is no fire
    run.step()
    assert run.state.motion.target.tolist() == [0, 0, 0, 0]
    assert run.setup.world.fire_position.tolist() == [[900.0, 600.0]]


def test_a_fire_that_is_out_can_be_moved_and_deleted() -> None:
    run = edited_run()
    while run.state.motion.fire_burning[0]:
        run.step()
    give(run, MoveEntity("fire", 0, run.state.motion.position[0]))
    assert not run.state.motion.fire_burning[0]
    assert not refused(give(run, DeleteEntity("fire", 0)))
    assert run.state.motion.fire_burning.tolist() == [True]
    for _ in range(20):
        run.step()


def test_a_robot_that_joins_a_team_with_given_links_has_none_until_it_is_given_some() -> None:
    run = edited_run("linked")
    give(run, AddEntity("robot", at(640.0, 380.0)))
    assert run.setup.layout.links == ((0, 1), (1, 2), (2, 3))
    run.step()
    assert run.trace.component[4] == 4
    give(run, ToggleLink(4, 1))
    run.step()
    assert run.trace.component[4] == 0


def test_links_follow_their_robots_when_one_is_deleted() -> None:
    run = edited_run("linked")
    give(run, DeleteEntity("robot", 0))
    assert run.setup.layout.links == ((0, 1), (1, 2))


def test_a_link_is_toggled_against_the_links_in_force() -> None:
    run = edited_run()
    give(run, ToggleLink(3, 1))
    assert run.setup.layout.links == ((0, 1), (0, 2), (0, 3), (1, 2), (2, 3))
    give(run, ToggleLink(1, 3))
    assert run.setup.layout.links == ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
    give(run, LinkByRange())
    assert len(run.setup.world.link_start) == 0


def test_a_unicycle_is_moved_by_its_centre_and_turns_about_it() -> None:
    run = edited_run("unicycles", ticks=10)
    give(run, MoveEntity("robot", 0, at(400.0, 350.0)))
    assert centres(run.setup.layout, run.state.motion)[0] == pytest.approx([400.0, 350.0])
    give(run, ChangeEntity("robot", 0, "heading", 120.0))
    assert centres(run.setup.layout, run.state.motion)[0] == pytest.approx([400.0, 350.0])
    ahead = run.state.motion.position[0] - (400.0, 350.0)
    assert ahead == pytest.approx([6.0 * math.cos(math.radians(120.0)), 6.0 * math.sin(math.radians(120.0))])


REFUSALS = [
    (AddEntity("polygon", at(1.0, 1.0)), "a polygon needs an outline: draw one"),
    (MoveEntity("circle", 7, at(1.0, 1.0)), "there is no circle 8: there are circles 1 to 2"),
    (DeleteEntity("fire", -1), "there is no fire 0"),
    (ChangeEntity("circle", 0, "length", 3.0), "circle 1 has no number 'length'; it has x, y, radius"),
    (ChangeEntity("circle", 0, "radius", 0.0), "radius of circle 1: 0 is not from 0.1 to 100000 m"),
    (ChangeEntity("circle", 0, "radius", math.nan), "radius of circle 1: nan is not from 0.1"),
    (ChangeEntity("circle", 1, "radius", 100.0), "robot 2 would be inside circle 2; 12 m is the least"),
    (ChangeEntity("fire", 0, "needs", 2.5), "needs of fire 1: 2.5 is not a whole number within the team of 4"),
    (ChangeEntity("fire", 0, "needs", 9.0), "needs of fire 1: 9 is not a whole number within the team of 4"),
    (ChangeEntity("robot", 0, "heading", 3.0), "the robots have no heading: they are no unicycles"),
    (ToggleLink(1, 1), "robot 2 cannot be linked to itself"),
    (ToggleLink(1, 9), "there is no robot 10: there are robots 1 to 4"),
    (SetArena(floats([5.0, 0.0, 5.0, 9.0]), walls=True), "an arena of 0 m x 9 m has no inside"),
    (SetArena(floats([690.0, 0.0, 1200.0, 700.0]), walls=True), "robot 4 would be outside the walls; move it first"),
    (SetParameters({"safety.robot_clearence": 3.0}), "(did you mean 'safety.robot_clearance'?)"),
    (SetParameters({"safety.robot_clearance": 0.0}), "robot_clearance: 0.0 is not a number from 0.1"),
    (SetParameters({"safety.control_period": 0.05}), "safety.control_period is fixed during a run"),
    (SetParameters({"safety.pair_gain": 900.0}), "pair_gain"),
    (SetParameters({"safety.robot_clearance": 90.0}), "robots 1 and 2 start 58.31 m apart; robot_clearance is 90 m"),
    (SetParameters({"formation.formation_rate": 50.0}), "lower formation_rate (50 1/s)"),
    (SetParameters({"boundaries.repulsive_margin": 30.0}), "boundaries.reactive_margin (25 m) must be above"),
    (AddOutlines(()), "there is no outline"),
    (AddOutlines((floats([[0, 0], [10, 10], [10, 0], [0, 10]]),)), "crosses or touches itself"),
    (AddOutlines((floats([[690, 290], [710, 290], [700, 320]]),)), "robot 1 would be inside the obstacle"),
    (AddOutlines((floats([[706, 285], [716, 285], [716, 315], [706, 315]]),)), "too near to robot 1: 6.0 m from it"),
    (AddOutlines((floats([[550, 490], [560, 490], [560, 700]]),)), "cross or touch"),
    (SetArena(floats([0.0, 0.0, math.inf, 9.0]), walls=False), "(inf, 9) is no place: coordinates are numbers from"),
    (AddOutlines((floats([[0, 0], [math.nan, 10], [10, 0]]),)), "(nan, 10) is no place"),
    (Edit(), "Edit is no edit that this console knows"),
]  # fmt: skip


@pytest.mark.parametrize(("command", "message"), REFUSALS)
def test_a_refused_edit_changes_nothing_and_names_value_place_and_choices(
    command: OperatorCommand, message: str
) -> None:
    run = edited_run()
    before = run.run_state
    (event,) = run.apply(command)
    assert event.kind == "refused"
    assert message in event.text
    assert run.run_state.setup is before.setup
    assert run.run_state.state is before.state
    assert run.history == History()


@pytest.mark.parametrize("place", [(math.nan, 100.0), (math.inf, 100.0), (1e300, 100.0)])
@pytest.mark.parametrize("thing", ["robot", "fire", "circle", "bar"])
def test_a_place_that_is_none_is_refused(thing: str, place: tuple[float, float]) -> None:
    for command in (AddEntity(thing, floats(place)), MoveEntity(thing, 0, floats(place))):
        run = edited_run()
        before = run.run_state
        assert refused(run.apply(command))
        assert run.state is before.state


def test_an_edit_before_the_first_step_changes_the_start_and_a_later_one_does_not() -> None:
    run = edited_run()
    give(run, MoveEntity("robot", 3, at(300.0, 600.0)))
    assert run.setup.start.motion.position[3].tolist() == [300.0, 600.0]
    assert run.setup.world.formation[3].tolist() == [300.0, 600.0]
    run.step()
    give(run, MoveEntity("robot", 3, at(200.0, 600.0)))
    assert run.setup.start.motion.position[3].tolist() == [300.0, 600.0]


def test_a_start_that_would_not_be_safe_any_more_is_moved_to_the_nearest_safe_place() -> None:
    run = edited_run(ticks=100)
    start = run.setup.start.motion.position.copy()
    give(run, AddEntity("circle", start[0]))
    moved = run.setup.start.motion.position
    assert np.hypot(*(moved[0] - run.setup.world.circles[-1, :2])) >= run.setup.world.circles[-1, 2] + 12.0 - HAIR


def test_a_stroke_becomes_an_obstacle_by_its_outline() -> None:
    run = edited_run()
    angle = np.linspace(0.0, 2.0 * math.pi, 50)
    points = floats(np.stack([1000.0 + 60.0 * np.cos(angle), 150.0 + 40.0 * np.sin(angle)], axis=1))
    drawn = StrokePoints(points)
    events = give(run, StrokeBegin(), drawn, StrokeEnd(use="obstacle"))
    assert events[0].text == "Polygon 3 is added."
    assert numbers(run, EntityKind.POLYGON, 2)["size"] == pytest.approx(60.0, abs=3.0)
    assert len(run.state.pointer_state.stroke) == 0
    events = give(run, StrokeBegin(), StrokePoints(points[:2]), StrokeEnd(use="obstacle"))
    assert events[0].text == "No obstacle: the stroke encloses nothing: draw round the obstacle."
    assert len(run.history.done) == 1


def test_a_thing_is_found_under_a_point_robots_before_fires_before_obstacles() -> None:
    run = edited_run()
    layout, motion = run.setup.layout, run.state.motion
    assert entity_at(at(701.0, 300.0), layout, motion, 10.0) == EntityRef(EntityKind.ROBOT, 0)
    assert entity_at(at(510.0, 250.0), layout, motion, 5.0) == EntityRef(EntityKind.FIRE, 0)
    assert entity_at(at(290.0, 195.0), layout, motion, 5.0) == EntityRef(EntityKind.CIRCLE, 0)
    assert entity_at(at(905.0, 300.0), layout, motion, 5.0) == EntityRef(EntityKind.BAR, 0)
    assert entity_at(at(510.0, 560.0), layout, motion, 5.0) == EntityRef(EntityKind.POLYGON, 1)
    assert entity_at(at(200.0, 200.0), layout, motion, 5.0) is None


@pytest.mark.parametrize("name", ["building", "unicycles", "swarm"])
def test_shipped_worlds_can_be_edited(name: str) -> None:
    scenario = load_scenario(name)
    run = Run(scenario.setup(0), scenario.filter, scenario)
    run.step()
    middle = run.state.motion.position.mean(axis=0)
    for command in (
        AddEntity("robot", middle), AddEntity("circle", middle), MoveEntity("robot", 0, middle + 50.0),
        DeleteEntity("fire", 0), DeleteEntity("robot", 1), ToggleLink(0, 1),
    ):  # fmt: skip
        assert not refused(run.apply(command)), command
        assert shortfalls(run).max() <= HAIR
        run.step()
        assert run.trace.clearance.min() > -1e-6 or run.trace.infeasible.any()


@pytest.mark.parametrize(
    "command",
    [
        AddEntity("robot", at(1000.0, 100.0)), DeleteEntity("fire", 1), ToggleLink(0, 1),
        SetArena(floats([0, 0, 1250, 700]), walls=False),
        SetParameters({"safety.obstacle_clearance": 8.0}), AddEntity("circle", at(1000.0, 100.0)),
    ],
)  # fmt: skip
def test_a_world_that_was_edited_is_the_world_that_is_made_of_what_it_came_to(command: OperatorCommand) -> None:
    run = edited_run("unicycles", ticks=3)
    assert not refused(give(run, command))
    assert_same(run.setup.world, build_world(run.setup.layout))


def test_a_stroke_before_the_first_step_is_no_part_of_the_start_when_the_world_is_edited() -> None:
    run = edited_run()
    give(run, *stroke([(700.0, 300.0), (500.0, 450.0), (200.0, 500.0)]), AddEntity("circle", at(1000.0, 100.0)))
    assert run.state.motion.path_status == PathStatus.FOLLOWING
    assert run.setup.start.motion.path_status == PathStatus.NONE


def test_what_is_wrong_already_is_no_licence_for_tunables_that_are_wrong_too() -> None:
    run = edited_run(ticks=3)
    grown = run.state.motion.fire_radius + 60.0
    run.state = run.state._replace(motion=run.state.motion._replace(fire_radius=grown))
    assert not refused(run.apply(SetParameters({"blending.cruise_speed": 40.0})))
    for values in ({"safety.pair_gain": 900.0}, {"fires.stand_off": 5.0}, {"formation.formation_rate": 50.0}):
        assert refused(run.apply(SetParameters(values))), values
