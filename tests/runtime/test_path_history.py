"""What an undo and a redo make of a path that the team has followed on since."""

import numpy as np
import pytest

from higvf_console.control.guidance.paths import path_points
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.commands import (
    MovePathPoint,
    NextTask,
    OperatorCommand,
    Redo,
    ReversePath,
    ShapePath,
    StrokeEnd,
    Undo,
)
from higvf_console.core.state import PathStatus
from higvf_console.runtime.run import Run
from tests.teams import stroke
from tests.world.editing.actions import edited_run, give, go

WAY = stroke([(700.0, 300.0), (500.0, 450.0), (300.0, 450.0), (200.0, 600.0)])
REPAIRS = [
    ShapePath(pace=0.9), ShapePath(ending="hold"), ReversePath(),
    MovePathPoint(floats([300.0, 450.0]), floats([300.0, 480.0])),
]  # fmt: skip


def place_on_path(run: Run) -> Floats:
    """Where the path has been followed to (2,) [m]."""
    return path_points(run.state.intent.path, floats([run.state.motion.path_parameter]))[0]


@pytest.mark.parametrize("repair", REPAIRS, ids=["pace", "ending", "reverse", "bend"])
def test_without_a_repair_the_team_goes_on_from_where_it_has_come_to(repair: OperatorCommand) -> None:
    run = edited_run()
    give(run, *WAY)
    go(run, 100)
    path, was = run.state.intent.path, place_on_path(run)
    give(run, repair)
    go(run, 150)
    place = place_on_path(run)
    for command in (Undo(), Redo()):
        give(run, command)
        assert np.hypot(*(place_on_path(run) - place)) < 40.0 < np.hypot(*(place_on_path(run) - was))
    give(run, Undo())
    assert run.state.intent.path is path


def test_undoing_a_repair_does_not_revive_a_path_that_is_finished_nor_give_time_back() -> None:
    run = edited_run()
    give(run, *WAY[:2], StrokeEnd(duration=6.0))
    go(run, 50)
    give(run, ShapePath(pace=0.9))
    go(run, 200)
    left = run.state.motion.path_left
    give(run, Undo())
    assert run.state.motion.path_left == left == pytest.approx(1.0)
    give(run, Redo())
    go(run, 60)
    assert run.state.motion.path_status == PathStatus.FINISHED
    give(run, Undo())
    assert run.state.motion.path_status == PathStatus.FINISHED


def test_undoing_what_revived_a_path_finishes_it_again() -> None:
    run = edited_run()
    give(run, *WAY)
    go(run, 20)
    give(run, NextTask(), ReversePath())
    assert run.state.motion.path_status == PathStatus.FOLLOWING
    go(run, 20)
    give(run, Undo())
    assert run.state.motion.path_status == PathStatus.FINISHED


def test_a_stroke_done_again_is_followed_from_where_it_was_left() -> None:
    run = edited_run()
    give(run, *WAY)
    go(run, 150)
    left = run.state.motion.path_parameter
    assert left > 50.0
    give(run, Undo())
    go(run, 10)
    give(run, Redo())
    assert run.state.motion.path_parameter == left
