"""What a run is judged by: burnt area, clearance of the bodies, and how long a robot has been stalled."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats, bools, floats, ints
from higvf_console.core.state import NOBODY
from higvf_console.sim.metrics import clearances, loss_area, stalls
from higvf_console.world.setup import Setup
from tests.teams import team

PARAMS = Parameters()
R_R, R_O = PARAMS.safety.robot_clearance, PARAMS.safety.obstacle_clearance

pytestmark = pytest.mark.usefixtures("plain_kernels")


def judged(body: list[tuple[float, float]], setup: Setup, burning: bool = True) -> tuple[list[float], list[float]]:
    motion = setup.start.motion
    fires = bools([burning] * len(motion.fire_radius))
    nearest, barrier = clearances(floats(body), motion.fire_radius, fires, setup.world, PARAMS.safety)
    return nearest.tolist(), barrier.tolist()


def test_the_loss_of_a_fire_is_the_area_of_its_largest_circle() -> None:
    motion = team(fires=[(900.0, 350.0, 20.0), (500.0, 350.0, 1.0)]).start.motion
    assert loss_area(motion) == pytest.approx([400.0 * math.pi, math.pi])


def test_far_from_everything_the_clearance_is_infinite() -> None:
    assert judged([(100.0, 100.0), (900.0, 600.0)], team()) == ([math.inf] * 2, [math.inf] * 2)


@pytest.mark.parametrize("gap", [3.0, 0.0, -4.0])
def test_two_robots_are_as_far_apart_as_their_centres_are_beyond_their_clearance(gap: float) -> None:
    nearest, barrier = judged([(100.0, 100.0), (100.0 + R_R + gap, 100.0)], team())
    assert nearest == pytest.approx([gap, gap])
    assert barrier == pytest.approx([((R_R + gap) / R_R) ** 2 - 1.0] * 2)


@pytest.mark.parametrize("gap", [3.0, -4.0])
def test_an_obstacle_counts_from_its_surface(gap: float) -> None:
    for setup in (team(circles=[(500.0, 300.0, 40.0)]), team(bars=[(500.0, 300.0, 500.0, 500.0, 40.0)])):
        nearest, barrier = judged([(500.0 - 40.0 - R_O - gap, 300.0)], setup)
        assert nearest == pytest.approx([gap])
        assert barrier == pytest.approx([((40.0 + R_O + gap) / (40.0 + R_O)) ** 2 - 1.0])


def test_a_fire_counts_while_it_burns() -> None:
    setup, place = team(fires=[(500.0, 300.0, 20.0)]), [(500.0, 300.0 + 20.0 + R_O - 2.0)]
    assert judged(place, setup)[0] == pytest.approx([-2.0])
    assert judged(place, setup, burning=False) == ([math.inf], [math.inf])


def test_the_nearest_of_several_dangers_counts() -> None:
    setup = team(circles=[(500.0, 300.0, 40.0), (600.0, 300.0, 40.0)])
    nearest, _ = judged([(545.0, 300.0)], setup)
    assert nearest == pytest.approx([5.0 - R_O])


def test_a_wall_counts_for_the_barrier_alone() -> None:
    setup = team()
    walled = setup._replace(world=setup.world._replace(walls=floats([(1.0, 0.0, 0.0)])))
    nearest, barrier = judged([(0.5 * R_O, 300.0)], walled)
    assert (nearest, barrier) == ([math.inf], [-0.5])


def stalled(
    velocity: Floats, wish: Floats, *, active: int = 1, crew: int = 0, at: tuple[float, float] = (100.0, 100.0),
    target: int = 0, steered: bool = False, was: float = 1.0,
) -> float:  # fmt: skip
    """How long one robot has been stalled [s] that had been for `was`; the fire (500, 300) takes two robots."""
    setup = team([at], fires=[(500.0, 300.0, 20.0)])
    motion = setup.start.motion._replace(stalled=floats([was]))
    plan: Any = SimpleNamespace(nominal=wish, target=ints([target]), steered=bools([steered]))
    found = stalls(motion, plan, velocity, ints([active]), ints([crew]), setup.world, PARAMS)
    return float(found[0])


STILL, WISH = np.zeros((1, 2)), floats([(60.0, 0.0)])
LONGER = 1.0 + PARAMS.safety.control_period


def test_a_robot_that_wants_to_move_and_is_held_is_stalled() -> None:
    assert stalled(STILL, WISH) == pytest.approx(LONGER)


@pytest.mark.parametrize(
    "other",
    [
        {"velocity": WISH, "wish": WISH},
        {"velocity": STILL, "wish": STILL},
        {"velocity": STILL, "wish": WISH, "active": 0},
    ],
    ids=["it moves", "it wants nothing", "nothing holds it"],
)
def test_a_robot_that_moves_or_is_not_held_is_not_stalled_and_begins_anew(other: dict[str, Any]) -> None:
    assert stalled(**other) == 0.0


def test_a_robot_at_work_on_its_fire_is_not_stalled_unless_it_is_steered() -> None:
    beside = (500.0, 300.0 - 20.0 - PARAMS.fires.stand_off)
    assert stalled(STILL, WISH, at=beside) == 0.0
    assert stalled(STILL, WISH, crew=2) == 0.0, "its fire is being put out by others"
    assert stalled(STILL, WISH, at=beside, steered=True) == pytest.approx(LONGER)
    assert stalled(STILL, WISH, at=beside, target=NOBODY) == pytest.approx(LONGER)
