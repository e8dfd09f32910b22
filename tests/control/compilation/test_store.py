"""The files of the compile cache: whatever is wrong with their folder is reported in a line, and never raised."""

import errno
import os
import threading
from pathlib import Path

import pytest

from higvf_console.control.compilation.store import Store

PAYLOAD = bytes(range(256)) * 400


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "caches" / "digest"


def reports(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in caplog.records]


def test_a_store_touches_nothing_before_it_is_written_to(folder: Path) -> None:
    assert Store(lambda: folder).read("a") is None
    assert not folder.parent.exists()


def test_what_was_written_is_read_by_the_next_process(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    Store(lambda: folder).write("a", PAYLOAD)
    assert Store(lambda: folder).read("a") == PAYLOAD
    assert [file.name for file in folder.iterdir()] == ["a"]
    assert reports(caplog) == []


@pytest.mark.parametrize("damaged", [b"", b"\x00" * 10, b"\x80\x05N.", None], ids=["empty", "short", "pickle", "cut"])
def test_a_damaged_file_is_reported_removed_and_made_anew(
    damaged: bytes | None, folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    Store(lambda: folder).write("a", PAYLOAD)
    file = folder / "a"
    file.write_bytes(file.read_bytes()[:-1] if damaged is None else damaged)
    store = Store(lambda: folder)
    assert store.read("a") is None
    assert reports(caplog) == [
        f"The compile cache file {file} cannot be used (its checksum is wrong); compiling it anew."
    ]
    assert not file.exists()
    store.write("a", PAYLOAD)
    assert store.read("a") == PAYLOAD


def test_a_folder_that_is_a_file_is_reported_once(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder.parent.mkdir()
    folder.write_text("not a folder")
    store = Store(lambda: folder)
    for _ in range(2):
        assert store.read("a") is None
        store.write("a", PAYLOAD)
    assert reports(caplog) == [
        f"The compile cache {folder} cannot be used ({os.strerror(errno.ENOTDIR)}); compiling without it."
    ]
    assert folder.read_text() == "not a folder"


def test_a_parent_that_is_a_file_is_reported_once(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder.parent.write_text("not a folder")
    store = Store(lambda: folder)
    assert store.read("a") is None
    store.write("a", PAYLOAD)
    assert len(reports(caplog)) == 1


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EROFS, errno.EACCES, errno.EDQUOT])
def test_a_folder_that_takes_no_file_is_reported_once_and_left_clean(
    code: int, folder: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: Path, __: bytes) -> int:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(Path, "write_bytes", fail)
    store = Store(lambda: folder)
    store.write("a", PAYLOAD)
    store.write("b", PAYLOAD)
    assert not store.writable()
    assert reports(caplog) == [
        f"The compile cache {folder} cannot be used ({os.strerror(code)}); compiling without it."
    ]
    assert list(folder.iterdir()) == []


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write everywhere")
def test_a_read_only_folder_is_read_without_a_word(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    Store(lambda: folder).write("a", PAYLOAD)
    folder.chmod(0o555)
    store = Store(lambda: folder)
    assert store.read("a") == PAYLOAD
    assert reports(caplog) == []
    store.write("b", PAYLOAD)
    assert len(reports(caplog)) == 1


def test_writers_at_once_never_let_a_reader_see_half_a_file(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    contents = [bytes([k]) * 200_000 for k in range(4)]
    Store(lambda: folder).write("a", contents[0])

    def write(content: bytes) -> None:
        store = Store(lambda: folder)
        for _ in range(30):
            store.write("a", content)

    writers = [threading.Thread(target=write, args=(content,)) for content in contents]
    for writer in writers:
        writer.start()
    store = Store(lambda: folder)
    while any(writer.is_alive() for writer in writers):
        assert store.read("a") in contents
    assert reports(caplog) == []
    assert [file.name for file in folder.iterdir()] == ["a"]


def test_a_new_folder_replaces_those_that_nobody_has_used_for_weeks(folder: Path) -> None:
    old, recent = folder.parent / "old", folder.parent / "recent"
    for other in (old, recent):
        other.mkdir(parents=True)
        (other / "a").write_bytes(b"")
    os.utime(old, (0.0, 0.0))
    Store(lambda: folder).write("a", PAYLOAD)
    assert sorted(other.name for other in folder.parent.iterdir()) == ["digest", "recent"]


def test_a_folder_in_use_stays(folder: Path) -> None:
    Store(lambda: folder).write("a", PAYLOAD)
    os.utime(folder, (0.0, 0.0))
    assert Store(lambda: folder).read("a") == PAYLOAD
    Store(lambda: folder.parent / "next").write("a", PAYLOAD)
    assert folder.exists()
