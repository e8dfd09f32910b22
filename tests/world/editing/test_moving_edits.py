"""Edits of moving obstacles: a course goes with its obstacle, and nothing jumps but what is moved."""

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.edits import AddEntity, ChangeEntity, DeleteEntity, Edit, EntityKind, MoveEntity, SetParameters
from higvf_console.core.errors import ScenarioError
from higvf_console.core.state import SimState
from higvf_console.world.editing.edit import Edited, edited
from higvf_console.world.editing.entities import EntityRef, entity_at, numbers_of
from higvf_console.world.obstacles import Course, Obstacles, course_along
from higvf_console.world.setup import Setup
from tests.moving import with_obstacles
from tests.teams import team

TICK, PERIOD = 150, 0.02  # 3 s into the run
WAY = course_along([(300.0, 300.0), (300.0, 500.0)], 20.0, loop=True)
ACROSS = course_along([(600.0, 200.0), (800.0, 200.0)], 10.0, loop=False)
CIRCLE, BAR = EntityRef(EntityKind.CIRCLE, 1), EntityRef(EntityKind.BAR, 0)
MOVERS = pytest.mark.parametrize("entity", [CIRCLE, BAR])


def site() -> Setup:
    """A still circle, a moving circle, a moving bar."""
    circles = floats([[900.0, 600.0, 20.0], [300.0, 300.0, 20.0]])
    bars = floats([[600.0, 150.0, 600.0, 250.0, 6.0]])
    return with_obstacles(team(), Obstacles(circles, bars, (), (None, WAY), (ACROSS,)))


def later(setup: Setup, tick: int = TICK) -> SimState:
    return setup.start._replace(motion=setup.start.motion._replace(tick=tick))


def after(command: Edit, tick: int = TICK) -> Edited:
    setup = site()
    return edited(setup, later(setup, tick), command)


def middle(setup: Setup, entity: EntityRef, tick: int) -> list[float]:
    numbers = numbers_of(entity, setup.layout, later(setup, tick).motion)
    return [numbers["x"], numbers["y"]]


def course(setup: Setup, entity: EntityRef) -> Course:
    obstacles = setup.layout.obstacles
    found = (obstacles.circle_courses if entity.kind is EntityKind.CIRCLE else obstacles.bar_courses)[entity.row]
    assert found is not None
    return found


def test_a_moving_obstacle_is_where_it_has_come_to() -> None:
    assert middle(site(), CIRCLE, TICK) == pytest.approx([300.0, 360.0])
    assert middle(site(), BAR, TICK) == pytest.approx([630.0, 200.0])
    assert numbers_of(CIRCLE, site().layout, later(site()).motion)["speed"] == 20.0
    assert "speed" not in numbers_of(EntityRef(EntityKind.CIRCLE, 0), site().layout, later(site()).motion)


def test_a_hand_grips_a_moving_obstacle_where_it_is_and_not_where_it_started() -> None:
    setup = site()
    assert entity_at(floats([300.0, 360.0]), setup.layout, later(setup).motion, 2.0) == CIRCLE
    assert entity_at(floats([300.0, 300.0]), setup.layout, later(setup).motion, 2.0) is None


@MOVERS
@pytest.mark.parametrize("tick", [0, TICK])
def test_a_moved_obstacle_goes_on_along_its_course_from_there(entity: EntityRef, tick: int) -> None:
    setup = after(MoveEntity(entity.kind, entity.row, floats([500.0, 450.0])), tick).setup
    assert middle(setup, entity, tick) == pytest.approx([500.0, 450.0])
    moved = np.subtract(middle(setup, entity, tick + 100), middle(site(), entity, tick + 100))
    assert moved == pytest.approx(np.subtract([500.0, 450.0], middle(site(), entity, tick)))
    assert course(setup, entity) == course(site(), entity)


@pytest.mark.parametrize(("entity", "name"), [(CIRCLE, "radius"), (BAR, "length"), (BAR, "angle"), (BAR, "half width")])
def test_a_resized_or_turned_obstacle_moves_on_as_before(entity: EntityRef, name: str) -> None:
    setup = after(ChangeEntity(entity.kind, entity.row, name, 30.0)).setup
    numbers = numbers_of(entity, setup.layout, later(setup).motion)
    assert numbers[name] == pytest.approx(30.0)
    for tick in (TICK, TICK + 100):
        assert middle(setup, entity, tick) == pytest.approx(middle(site(), entity, tick))


@MOVERS
def test_another_speed_leaves_an_obstacle_where_it_is_now(entity: EntityRef) -> None:
    setup = after(ChangeEntity(entity.kind, entity.row, "speed", 4.0)).setup
    assert middle(setup, entity, TICK) == pytest.approx(middle(site(), entity, TICK))
    gone = np.subtract(middle(setup, entity, TICK + 100), middle(setup, entity, TICK))
    assert np.hypot(*gone) == pytest.approx(8.0)


@MOVERS
def test_a_deleted_obstacle_takes_its_course_and_no_other_with_it(entity: EntityRef) -> None:
    setup = after(DeleteEntity(entity.kind, entity.row)).setup
    kept = [name for _, name in setup.layout.obstacles.movers()]
    assert kept == [course(site(), BAR if entity == CIRCLE else CIRCLE)]


def test_the_course_of_an_obstacle_stays_with_it_when_one_before_it_is_deleted() -> None:
    setup = after(DeleteEntity("circle", 0)).setup
    now = EntityRef(EntityKind.CIRCLE, 0)
    assert course(setup, now) == WAY
    assert middle(setup, now, TICK) == pytest.approx([300.0, 360.0])


def test_an_added_obstacle_stands_still() -> None:
    setup = after(AddEntity("circle", floats([1000.0, 100.0]))).setup
    assert len(setup.layout.obstacles.movers()) == 2
    assert middle(setup, EntityRef(EntityKind.CIRCLE, 2), TICK + 500) == [1000.0, 100.0]


def test_a_still_obstacle_has_no_speed_to_change() -> None:
    with pytest.raises(ScenarioError, match="circle 1 does not move: give it a path or a velocity"):
        after(ChangeEntity("circle", 0, "speed", 5.0))


def test_a_robot_cannot_be_put_where_a_moving_obstacle_is_now() -> None:
    setup = after(MoveEntity("robot", 0, floats([300.0, 360.0]))).setup
    result = after(MoveEntity("robot", 0, floats([300.0, 360.0])))
    gap = np.hypot(*(result.state.motion.position[0] - middle(setup, CIRCLE, TICK))) - 20.0
    assert gap >= 12.0 - 1e-5
    assert "held at the nearest safe place" in result.text


def test_circulation_round_moving_obstacles_is_kept_by_an_edit_of_something_else_and_not_of_them() -> None:
    setup = site()
    state = later(setup)
    sides = state.motion.circulation.copy()
    assert sides.shape == (3, 3)
    sides[:, 1:] = 2
    state = state._replace(motion=state.motion._replace(circulation=sides))
    kept = edited(setup, state, AddEntity("fire", floats([1100.0, 100.0]))).state.motion.circulation
    assert kept.tolist() == [[0, 0, 2, 2]] * 3
    moved = edited(setup, state, MoveEntity("circle", 1, floats([500.0, 600.0]))).state.motion.circulation
    assert moved.tolist() == [[0, 0, 0]] * 3


def test_an_edit_warns_of_what_robots_can_no_longer_yield_to_and_only_once() -> None:
    fast = after(ChangeEntity("bar", 0, "speed", 95.0))
    assert fast.warnings == (
        "bar 1 moves at 95 m/s; robots, whose speed limit is 90 m/s, cannot always keep clear of it",
    )
    again = edited(fast.setup, fast.state, ChangeEntity("circle", 1, "radius", 30.0))
    assert again.warnings == ()
    slowed = after(SetParameters({"safety.speed_limit": 15.0, "blending.cruise_speed": 10.0}))
    assert [warning.split(";")[0] for warning in slowed.warnings] == ["circle 2 moves at 20 m/s"]
