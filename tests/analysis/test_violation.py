"""A violated clearance is reported with the hazard and the missing distance."""

import numpy as np
import pytest

from higvf_console.analysis.violation import violation_text
from higvf_console.control.parameters import Parameters, RobotParameters
from higvf_console.core.arrays import floats
from higvf_console.core.commands import EmergencyStop
from higvf_console.runtime.run import Run
from higvf_console.world.obstacles import course_along
from higvf_console.world.setup import Setup
from tests.moving import moving_circle
from tests.teams import team

FAR = (900.0, 600.0)


def text(setup: Setup, at: tuple[float, float], tick: int = 0, burning: bool = True) -> str:
    motion = setup.start.motion
    position = motion.position.copy()
    position[0] = at
    burns = np.full(len(motion.fire_burning), burning)
    return violation_text(0, motion._replace(position=position, tick=tick, fire_burning=burns), setup)


@pytest.mark.parametrize(
    ("at", "words"),
    [
        ((331.6, 100.0), "is inside fire 1's safety distance by 0.4 m"),
        ((100.0, 221.5), "is inside circle 1's safety distance by 0.5 m"),
        ((100.0, 400.0), "is inside bar 1's safety distance by 16.0 m"),
        ((624.97, 600.0), "is inside robot 2's safety distance by 3 cm"),
        ((624.999, 600.0), "is inside robot 2's safety distance by 1 mm"),
    ],
)
def test_the_nearest_hazard_is_named_with_the_missing_distance(at: tuple[float, float], words: str) -> None:
    setup = team(
        robots=[FAR, (600.0, 600.0)],
        fires=[(300.0, 100.0, 20.0)],
        circles=[(100.0, 200.0, 10.0)],
        bars=[(50.0, 400.0, 150.0, 400.0, 4.0)],
    )
    assert text(setup, at) == words


def test_an_extinguished_fire_is_no_hazard() -> None:
    setup = team(robots=[FAR], fires=[(300.0, 100.0, 20.0), (400.0, 100.0, 50.0)])
    assert "fire 2" in text(setup, (345.0, 100.0))
    setup = team(robots=[FAR], fires=[(300.0, 100.0, 20.0)], circles=[(330.0, 130.0, 20.0)])
    assert "circle 1" in text(setup, (310.0, 110.0), burning=False)


def test_a_moving_obstacle_counts_where_it_is_now() -> None:
    setup = moving_circle(course_along([(300.0, 300.0), (400.0, 300.0)], 50.0, loop=False), robots=[FAR])
    assert text(setup, (400.0, 331.5), tick=100) == "is inside circle 1's safety distance by 0.5 m"


def test_the_body_of_a_unicycle_counts_and_not_its_controlled_point() -> None:
    params = Parameters(robots=RobotParameters(look_ahead=5.0))
    setup = team(robots=[FAR], fires=[(300.0, 100.0, 20.0)], params=params)  # heads to the right: its body is behind
    assert text(setup, (336.0, 100.0)) == "is inside fire 1's safety distance by 1.0 m"


def test_a_run_reports_which_fire_grew_to_a_stopped_robot() -> None:
    run = Run(team(robots=[(100.0, 100.0)], fires=[(134.0, 100.0, 20.0)], growth=2.0))
    run.apply(EmergencyStop())
    events = [event.text for _ in range(60) for event in run.step() if event.kind == "clearance"]
    assert events == ["Robot 1 is inside fire 1's safety distance by 4 cm."]
    assert floats(run.trace.barrier)[0] < 0.0
