"""A simulated team that an overhead camera sees: poses are tracked while it is disarmed, and no control tick waits."""

import time
from collections.abc import Iterator
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.events import Severity
from higvf_console.core.team import Poses, never_seen
from higvf_console.runtime.recording import Recorder, read_recording, replay
from higvf_console.runtime.session import Session
from higvf_console.runtime.teams import open_driver, rules_of, team_spec
from higvf_console.scenario.scenario import load_scenario
from higvf_console.team.driver import TeamDriver
from higvf_console.team.opening import open_team

CAMERA = "camera=assets/recordings/epucks-overhead.mp4:size_m=0.08,height_m=0.05"
PATIENCE = 20.0  # [s]


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Session]:
    monkeypatch.chdir(tmp_path)  # shipped files are found from anywhere
    scenario = load_scenario("epucks")
    driver = open_driver("simulated", CAMERA, scenario, scenario.setup(0), monotonic)
    session = Session(scenario, [], team=driver)
    yield session
    session.close()


def test_a_disarmed_team_is_where_the_camera_sees_it(session: Session) -> None:
    start = session.snapshot.state.motion.position.copy()
    end, ticks = monotonic() + PATIENCE, 0
    while np.abs(session.snapshot.state.motion.position - start).max() < 0.1 and monotonic() < end:
        session.tick()
        session.picture()
        ticks += 1
        time.sleep(0.01)
    moved = session.snapshot.state.motion.position - start
    assert (moved[:, 0] > 0.02).all() and ticks > 20
    assert session.has_picture and session.picture() is not None
    loud = [event.text for event in session.snapshot.events if event.severity is Severity.ALARM]
    assert not loud


def test_no_control_tick_waits_for_a_frame(session: Session) -> None:
    """A tick asks for poses as often as it likes: it gets the last ones while the next frame is looked at."""
    session.tick()
    team = session.snapshot.team
    assert team is not None and not team.track.seen.any()  # the first frame is not waited for
    end, stamps = monotonic() + PATIENCE, [0.0]
    ticks_between = 0
    while len(stamps) < 6 and monotonic() < end:
        session.tick()
        team = session.snapshot.team
        assert team is not None
        newest = float(team.track.measured_at.max())
        if newest > stamps[-1]:
            stamps.append(newest)
        else:
            ticks_between += 1
    assert len(stamps) == 6 and ticks_between > 5  # more ticks than frames


class Talking:
    """A source of poses that sees nobody, and says so once."""

    name = "talking"

    def __init__(self) -> None:
        self._left = ["The lamp is out."]

    def poses(self, now: float) -> Poses:  # noqa: ARG002
        return never_seen(5)

    def notices(self) -> tuple[str, ...]:
        taken, self._left = tuple(self._left), []
        return taken

    def close(self) -> None:
        pass


def test_what_a_source_of_poses_tells_is_reported_once() -> None:
    scenario = load_scenario("epucks")
    setup = scenario.setup(0)
    spec, options = team_spec("simulated", "--team", scenario, setup)
    driver = TeamDriver(open_team(spec), 5, rules_of(spec, options), None, spec.period, Talking())
    session = Session(scenario, [], team=driver)
    for _ in range(3):
        session.tick()
    session.close()
    assert [event.text for event in session.snapshot.events if event.kind == "team"].count("The lamp is out.") == 1
    assert not session.has_picture and session.picture() is None


def test_a_recorded_run_repeats_without_the_camera(tmp_path: Path) -> None:
    scenario = load_scenario("epucks")
    driver = open_driver("simulated", CAMERA, scenario, scenario.setup(0), monotonic)
    recorder = Recorder(tmp_path / "run.jsonl", scenario, 0, {}, driver.rules)
    session = Session(scenario, [], recorder=recorder, team=driver)
    for _ in range(80):
        session.tick()
        time.sleep(0.01)
    session.close()
    result = replay(read_recording(tmp_path / "run.jsonl"))
    assert result.agrees and result.ticks == 80


def test_a_headless_run_has_no_time_for_a_camera() -> None:
    scenario = load_scenario("epucks")
    with pytest.raises(InputError, match="tells poses in real time, which a headless run does not keep"):
        open_driver("simulated", CAMERA, scenario, scenario.setup(0), None)
