"""A console that was killed comes up stopped, with its run as it was; one that ended as it should leaves nothing."""

import os
import threading
from pathlib import Path

import pytest

from higvf_console.core.commands import EmergencyStop, Pick, ResetRun
from higvf_console.core.errors import ScenarioError
from higvf_console.runtime.persistence.checkpoints import Checkpoints, left_checkpoints, restored
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import load_scenario
from tests.fake_interfaces import FakeConsole


def session_at_work(ticks: int, *, waits: bool = False) -> Session:
    session = Session(load_scenario("firefighting"), [FakeConsole()], attended=True, waits=waits)
    for _ in range(ticks):
        session.tick()
    return session


def kept(session: Session, folder: Path) -> Path:
    Checkpoints(session, folder).keep()
    (file,) = left_checkpoints(folder)
    return file


def test_a_killed_run_goes_on_bit_for_bit_once_the_stop_is_reset(tmp_path: Path) -> None:
    session = session_at_work(150)
    session.pointer.push(Pick(2))
    session.tick()
    found = restored(kept(session, tmp_path))
    assert found.ticks == session.ticks == 151
    again = Session(load_scenario("firefighting"), [FakeConsole()], attended=True, interrupted=found)
    now = again.snapshot.state
    assert (now.intent.stopped, now.intent.influenced, again.interrupted) == (True, 2, pytest.approx(3.02))
    assert now.motion.position.tobytes() == session.snapshot.state.motion.position.tobytes()
    assert again.snapshot.events[-1].text.startswith("The console was killed at 3.0 s")
    for _ in range(20):
        again.tick()
    assert again.snapshot.state.motion.position.tobytes() == now.motion.position.tobytes()


def test_a_restored_run_can_be_started_anew_and_stays_stopped(tmp_path: Path) -> None:
    found = restored(kept(session_at_work(100), tmp_path))
    again = Session(load_scenario("firefighting"), [FakeConsole()], interrupted=found)
    again.pointer.push(ResetRun())
    again.tick()
    assert (again.snapshot.time, again.snapshot.state.intent.stopped) == (pytest.approx(0.02), True)


def test_a_stop_is_on_disk_at_once_and_motion_each_second(tmp_path: Path) -> None:
    session = session_at_work(10)
    checkpoints = Checkpoints(session, tmp_path)
    checkpoints.keep()
    (file,) = left_checkpoints(tmp_path)
    session.tick()
    checkpoints.keep()
    assert restored(file).ticks == 10
    session.pointer.push(EmergencyStop())
    session.tick()
    checkpoints.keep()
    assert restored(file).ticks == 12
    assert restored(file).run_state.state.intent.stopped


def test_a_run_that_has_not_begun_or_has_ended_as_it_should_leaves_nothing(tmp_path: Path) -> None:
    Checkpoints(session_at_work(5, waits=True), tmp_path).keep()
    assert left_checkpoints(tmp_path) == []
    checkpoints, stopping = Checkpoints(session_at_work(5), tmp_path), threading.Event()
    checkpoints.keep()
    stopping.set()
    checkpoints.run(stopping)
    assert list((tmp_path / "checkpoints").iterdir()) == []


@pytest.mark.parametrize("part", ["state", "world"])
def test_a_damaged_file_is_refused_in_one_line(part: str, tmp_path: Path) -> None:
    file = kept(session_at_work(5), tmp_path)
    damaged = next((tmp_path / "checkpoints").glob(f"*.{part}"))
    damaged.write_bytes(damaged.read_bytes()[:-1])
    with pytest.raises(ScenarioError, match=r"damaged$"):
        restored(file)


def test_one_of_another_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = kept(session_at_work(5), tmp_path)

    def version(_: str) -> str:
        return "9.9"

    monkeypatch.setattr("higvf_console.runtime.persistence.checkpoints.version", version)
    with pytest.raises(ScenarioError, match=r"of version .*; this is 9\.9$"):
        restored(file)


def test_nobody_else_can_read_it_and_a_running_console_keeps_its_own(tmp_path: Path) -> None:
    file = kept(session_at_work(5), tmp_path)
    assert {path.stat().st_mode & 0o777 for path in file.parent.iterdir()} == {0o600}
    running = file.with_name(f"{os.getppid()}.state")
    file.rename(running)
    assert left_checkpoints(tmp_path) == []
