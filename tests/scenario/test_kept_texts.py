"""Files in the user's state folder: written as a whole, drafts of consoles that are gone, own files opened lately."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from higvf_console.scenario.kept import (
    LONGEST_TEXT,
    MOST_RECENT,
    Recent,
    draft_file,
    left_drafts,
    recent_files,
    remember,
    state_folder,
    write_whole,
)


def gone_process() -> int:
    """The number of a process that has ended."""
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def test_the_state_folder_is_that_of_the_desktop_s_rules(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", "/somewhere")
    assert state_folder() == Path("/somewhere/higvf")
    monkeypatch.delenv("XDG_STATE_HOME")
    assert state_folder() == Path.home() / ".local" / "state" / "higvf"


def test_a_write_that_fails_leaves_the_former_file_and_nothing_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "new" / "draft.yaml"
    write_whole(file, "before")

    def fail(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OSError, match="No space left"):
        write_whole(file, "after")
    assert file.read_text() == "before"
    assert list(file.parent.iterdir()) == [file]


def test_drafts_of_consoles_that_run_are_left_alone(tmp_path: Path) -> None:
    write_whole(draft_file(tmp_path, os.getpid()), "mine")
    write_whole(draft_file(tmp_path, os.getppid()), "another's")
    assert left_drafts(tmp_path) == []
    process = gone_process()
    write_whole(draft_file(tmp_path, process), "left")
    assert [(draft.file.stem, draft.text) for draft in left_drafts(tmp_path)] == [(str(process), "left")]


def test_the_latest_draft_comes_first(tmp_path: Path) -> None:
    for process, saved in ((gone_process(), 100), (gone_process(), 300), (gone_process(), 200)):
        file = draft_file(tmp_path, process)
        write_whole(file, str(saved))
        os.utime(file, (saved, saved))
    assert [draft.text for draft in left_drafts(tmp_path)] == ["300", "200", "100"]


def opened(name: str, text: str = "version: 1") -> Recent:
    return Recent(name, f"{name}.yaml", text)


def test_a_file_that_is_opened_again_is_listed_once_with_its_latest_text(tmp_path: Path) -> None:
    for recent in (opened("a"), opened("b"), opened("a", "version: 1 # changed")):
        remember(tmp_path, recent)
    assert recent_files(tmp_path) == [opened("a", "version: 1 # changed"), opened("b")]


def test_only_so_many_are_remembered_and_none_that_is_too_long(tmp_path: Path) -> None:
    for number in range(MOST_RECENT + 3):
        remember(tmp_path, opened(str(number)))
    remember(tmp_path, opened("long", "#" * (LONGEST_TEXT + 1)))
    assert [recent.title for recent in recent_files(tmp_path)] == [str(10 - number) for number in range(MOST_RECENT)]


@pytest.mark.parametrize("damaged", ["", "{", "[1]", '[{"title": "a"}]'])
def test_a_damaged_list_is_reported_and_begun_anew(
    damaged: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "recent.json").write_text(damaged)
    assert recent_files(tmp_path) == []
    assert "recent.json cannot be read" in caplog.text
    remember(tmp_path, opened("a"))
    assert recent_files(tmp_path) == [opened("a")]
