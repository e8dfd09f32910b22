"""A simulated team that an overhead camera sees: poses are tracked while it is disarmed, and no control tick waits."""

import time
from collections.abc import Iterator
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from higvf_console.core.errors import InputError
from higvf_console.core.events import Severity
from higvf_console.runtime.session import Session
from higvf_console.runtime.teams import open_driver
from higvf_console.scenario.scenario import load_scenario

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


def test_a_headless_run_has_no_time_for_a_camera() -> None:
    scenario = load_scenario("epucks")
    with pytest.raises(InputError, match="tells poses in real time, which a headless run does not keep"):
        open_driver("simulated", CAMERA, scenario, scenario.setup(0), None)
