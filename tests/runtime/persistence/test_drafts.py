"""The edited world is kept in a draft; one that is saved, dismissed or undone is gone, one that is left is offered."""

import os
from pathlib import Path

import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import LoadScenario, OperatorCommand, Pick, Redo, ResetRun, Undo
from higvf_console.core.edits import AddEntity
from higvf_console.runtime.persistence.drafts import Drafts
from higvf_console.runtime.session import Session
from higvf_console.scenario.kept import draft_file, left_drafts, recent_files
from higvf_console.scenario.scenario import Scenario, load_scenario, parse_scenario
from tests.fake_interfaces import FakeConsole
from tests.scenario.test_kept_texts import gone_process

CIRCLE = AddEntity("circle", floats([300.0, 300.0]))


class Desk:
    """A session with its draft, looked at after each command."""

    def __init__(self, scenario: Scenario, folder: Path) -> None:
        self.session = Session(scenario, [FakeConsole()])
        self.drafts = Drafts(self.session, folder)
        self.file = draft_file(folder, os.getpid())

    def give(self, *commands: OperatorCommand) -> None:
        for command in commands:
            self.session.pointer.push(command)
            self.session.tick()
        self.drafts.keep()

    def circles(self) -> int:
        return len(parse_scenario(self.file.read_text(), "draft.yaml").obstacles.circles)


@pytest.fixture
def desk(team: Scenario, tmp_path: Path) -> Desk:
    return Desk(team, tmp_path)


def leave(desk: Desk) -> Path:
    """The console ends and leaves its draft; returns the file."""
    left = draft_file(desk.drafts.folder, gone_process())
    desk.file.replace(left)
    return left


def test_a_world_that_was_not_edited_is_not_kept(desk: Desk) -> None:
    desk.give(Pick(1), ResetRun())
    assert not desk.file.exists()


def test_the_draft_is_the_edited_world_at_its_start(desk: Desk) -> None:
    desk.give(CIRCLE)
    kept = parse_scenario(desk.file.read_text(), "draft.yaml").setup()
    assert kept.world.circles.tolist() == desk.session.setup.world.circles.tolist()
    assert kept.start.motion.position.tobytes() == desk.session.setup.start.motion.position.tobytes()
    assert kept.start.motion.fire_radius.tolist() == [20.0]


def test_it_is_written_again_only_after_another_edit(desk: Desk) -> None:
    desk.give(CIRCLE)
    desk.file.write_text("not written again")
    desk.give(Pick(1))
    assert desk.file.read_text() == "not written again"
    desk.give(AddEntity("circle", floats([900.0, 600.0])))
    assert desk.circles() == 2


def test_edits_that_are_undone_leave_no_draft_and_come_back_with_it(desk: Desk) -> None:
    desk.give(CIRCLE)
    desk.give(Undo())
    assert not desk.file.exists()
    desk.give(Redo())
    assert desk.circles() == 1


def test_a_saved_world_has_no_draft_until_it_is_edited_again(desk: Desk) -> None:
    desk.give(CIRCLE)
    desk.drafts.saved(desk.session.setup)
    desk.give(Pick(1))
    assert not desk.file.exists()
    desk.give(AddEntity("circle", floats([900.0, 600.0])))
    assert desk.circles() == 2


def test_the_draft_stays_when_another_scenario_is_loaded(desk: Desk, team: Scenario) -> None:
    desk.give(CIRCLE)
    desk.give(LoadScenario(team.text, "team.yaml"))
    assert desk.circles() == 1


def test_a_draft_that_was_left_is_offered_and_taken_over(desk: Desk, team: Scenario) -> None:
    desk.give(CIRCLE)
    left = leave(desk)
    again = Desk(team, desk.drafts.folder)
    draft = again.drafts.take()
    assert draft is not None
    assert draft.file == left
    assert (again.drafts.offered, left.exists(), again.circles()) == (None, False, 1)
    again.give(LoadScenario(draft.text, "draft.yaml"))
    assert again.circles() == 1  # until it is saved, though nothing was edited since
    assert [recent.title for recent in recent_files(again.drafts.folder)] == ["team"]
    again.drafts.saved(again.session.setup)
    assert left_drafts(again.drafts.folder) == []


def test_a_draft_that_is_dismissed_is_gone_and_the_next_one_is_offered(desk: Desk, team: Scenario) -> None:
    for _ in range(2):
        desk.give(AddEntity("circle", floats([300.0 + 300.0 * len(desk.session.setup.world.circles), 600.0])))
        leave(desk)
    drafts = Desk(team, desk.drafts.folder).drafts
    first = drafts.offered
    drafts.dismiss()
    assert first is not None
    assert not first.file.exists()
    assert drafts.offered is not None
    drafts.dismiss()
    assert drafts.offered is None


def test_own_files_are_remembered_and_shipped_ones_are_not(desk: Desk) -> None:
    shipped = load_scenario("empty")
    desk.give(Pick(1))
    desk.give(LoadScenario(shipped.text, "empty.yaml"))
    assert [recent.title for recent in recent_files(desk.drafts.folder)] == ["team"]


def test_a_folder_that_cannot_be_written_is_reported_once(
    team: Scenario, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").write_text("")
    desk = Desk(team, tmp_path / "file")
    desk.give(CIRCLE)
    desk.give(Pick(1))
    assert caplog.text.count("is not kept") == 1
