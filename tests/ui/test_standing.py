"""A team that stands still is explained: not yet under way, at the end of its path, at odds, or too few at a fire."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from higvf_console.core.arrays import ints
from higvf_console.core.state import NOBODY, PathStatus
from higvf_console.runtime.phase import Phase, RunPhase
from higvf_console.runtime.run import Run
from higvf_console.runtime.snapshot import Snapshot
from higvf_console.team.state import Arming, opened
from higvf_console.ui.standing import standing_text
from tests.teams import team

SETUP = team(fires=[(300, 350, 20), (300, 600, 20)])
STATE, TRACE = SETUP.start, Run(SETUP).trace


def shown(*, time: float = 20.0, crew: tuple[int, int] = (0, 0), paused: bool = False, **motion: Any) -> Snapshot:
    given = SimpleNamespace(
        state=STATE._replace(motion=STATE.motion._replace(**motion), intent=STATE.intent._replace(paused=paused)),
        setup=SETUP,
        trace=TRACE._replace(crew=ints(crew)),
        time=time,
        frozen=False,
        phase=RunPhase(),
        team=None,
    )
    return cast(Snapshot, given)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (
            {"target": ints([0, 0, 1])},
            "The team disagrees: robots 1 and 2 want fire 1; robot 3 wants fire 2.",
        ),
        ({"target": ints([0, 1, NOBODY])}, "robot 3 wants no fire"),
        ({"target": ints([0, 0, 0]), "crew": (2, 0)}, "The team puts out fire 1."),
        ({"target": ints([0, NOBODY, NOBODY]), "crew": (1, 0)}, "Robot 1 wants fire 1, which takes 2 robots; 1 there."),
        ({"target": ints([NOBODY] * 3)}, "No robot sees a fire"),
        ({"path_status": int(PathStatus.HOLDING)}, "waits at the end of its path"),
        ({"fire_burning": np.array([False, False])}, "No fire burns"),
    ],
)
def test_a_standing_team_is_explained(given: dict[str, Any], text: str) -> None:
    assert text in standing_text(shown(**given))


def test_before_it_sets_out_the_seconds_are_counted_down() -> None:
    fires = SETUP.params.fires._replace(start_delay=6.0)
    late = SETUP._replace(layout=SETUP.layout._replace(params=SETUP.params._replace(fires=fires)))
    given = cast(Any, shown(time=2.2))
    given.setup = late
    assert standing_text(given) == "The team sets out in 4 s."


def test_what_moves_or_has_a_mode_that_says_it_is_not_explained() -> None:
    assert standing_text(shown(velocity=np.full((3, 2), 10.0))) == ""
    assert standing_text(shown(paused=True)) == ""
    for phase in (Phase.READY, Phase.ENDED):
        given = cast(Any, shown())
        given.phase = RunPhase(phase)
        assert standing_text(given) == ""


def test_a_team_that_is_not_armed_is_told_of_by_the_mode_alone() -> None:
    given = cast(Any, shown(target=ints([0, 0, 1])))
    given.team = opened(3)
    assert standing_text(given) == ""
    given.team = opened(3)._replace(arming=Arming.ARMED)
    assert "disagrees" in standing_text(given)
