"""A path that waits, and a proposal, are for a robot, whatever number that has."""

from higvf_console.core.commands import Confirm, OperatorCommand, ProposePick, StrokeEnd, Undo
from higvf_console.core.edits import DeleteEntity
from higvf_console.core.state import NOBODY, PathKind
from tests.teams import stroke
from tests.world.editing.actions import edited_run, give

WAY = [(700.0, 300.0), (500.0, 450.0), (300.0, 450.0), (200.0, 600.0)]


def waits_for(robot: int) -> list[OperatorCommand]:
    return [*stroke(WAY)[:2], StrokeEnd(robot=robot, preview=True)]


def test_a_path_that_waits_stays_that_of_its_robot_when_another_is_deleted() -> None:
    run = edited_run()
    robot = run.state.motion.position[2].copy()
    give(run, *waits_for(2), DeleteEntity("robot", 0), Confirm())
    assert run.state.intent.influenced == 1
    assert (run.state.motion.position[1] == robot).all()


def test_it_goes_with_its_robot_and_comes_back_with_it() -> None:
    run = edited_run()
    give(run, *waits_for(2))
    path = run.state.pointer_state.pending
    give(run, DeleteEntity("robot", 2))
    assert run.state.pointer_state.pending.kind == PathKind.NONE
    give(run, Undo())
    assert run.state.pointer_state.pending is path
    assert run.state.pointer_state.pending_robot == 2


def test_undoing_a_deletion_gives_what_began_to_wait_since_its_robot_back() -> None:
    run = edited_run()
    give(run, *waits_for(1), DeleteEntity("robot", 0), *waits_for(2))
    run.step()
    run.history = run.history._replace(done=run.history.done[:-1])  # the path stays, the deletion goes
    give(run, Undo())
    assert run.state.pointer_state.pending_robot == 3


def test_a_proposal_is_of_its_robot_too_and_goes_with_it() -> None:
    run = edited_run()
    give(run, ProposePick(2), DeleteEntity("robot", 0))
    assert run.state.pointer_state.proposed == 1
    give(run, DeleteEntity("robot", 1))
    assert run.state.pointer_state.proposed == NOBODY
