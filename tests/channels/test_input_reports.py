"""What interfaces tell of themselves is shown and written down, and never touches the run."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from higvf_console.channels.attention_report import attention_section, coarse
from higvf_console.channels.input_reports import calibrations_of
from higvf_console.core.arrays import floats
from higvf_console.core.reports import AttentionReport, CalibrationReport, CaptureReport, DecisionReport, DwellReport
from higvf_console.core.viewport import Arena
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.recording import Recorder, read_recording, replay
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario
from tests.fake_interfaces import FakeInterface

HEAT = np.arange(12.0).reshape(3, 4)
ATTENTION = AttentionReport(
    heat=HEAT,
    extent=Arena(0, 0, 4, 3),
    degree=1.0,
    fires=floats([1.25, 0]),
    robots=floats([0.5]),
    elsewhere=3.0,
    fixation_rate=2.5,
    fixation_duration=0.3,
    transition_entropy=float("nan"),
)
SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
EYE = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
CALIBRATION = CalibrationReport(
    file="c.yaml",
    made="2026-03-02",
    screen_px=(1920.0, 1080.0),
    points_px=SQUARE,
    points_m=SQUARE,
    homography=EYE,
    residual_px=4.2,
    residual_m=1.5,
)


class Telling(FakeInterface):
    """Tells everything there is to tell."""

    def __init__(self, name: str = "gaze") -> None:
        super().__init__(name)
        self.calibration: CalibrationReport | None = CALIBRATION
        self.asked: list[str] = []

    def attention_report(self) -> AttentionReport | None:
        self.asked.append("attention")
        return ATTENTION

    def dwell_report(self) -> DwellReport | None:
        self.asked.append("dwell")
        return DwellReport(0.5, floats([], 0, 2))

    def decision_report(self, now: float) -> DecisionReport:
        return DecisionReport(
            label=f"at {now:.1f}",
            confidence=None,
            stage="passed",
            votes=1,
            votes_needed=1,
            of=1,
            threshold=0,
            support=1,
            enter=0,
            leave=0,
            active="",
            refractory=0,
            passed=1,
            proposed=0,
            unknown=0,
            held=(),
        )

    def calibration_report(self) -> CalibrationReport | None:
        return self.calibration

    def capture_report(self) -> CaptureReport:
        return CaptureReport("")

    def begin_capture(self) -> None: ...

    def cancel_capture(self) -> None: ...


class Failing(Telling):
    """Breaks when it is asked what was looked at."""

    def attention_report(self) -> AttentionReport | None:
        self.asked.append("attention")
        raise RuntimeError("no eyes")


def ticked(session: Session, times: int = 100) -> Session:
    for _ in range(times):
        session.tick()
    return session


def test_counting_is_asked_twice_a_second_and_the_button_each_tick(team: Scenario) -> None:
    gaze = Telling()
    session = Session(team, [gaze])
    gaze.asked.clear()
    inputs = ticked(session).snapshot.inputs
    assert gaze.asked.count("attention") == 4
    assert gaze.asked.count("dwell") == 100
    assert inputs.attention is ATTENTION
    assert inputs.dwell and inputs.dwell.progress == 0.5
    assert session.calibrated is gaze
    assert [(name, report.label) for name, report in session.input_reports.decisions] == [("gaze", "at 2.0")]


def test_an_interface_that_tells_nothing_is_asked_nothing(team: Scenario) -> None:
    session = ticked(Session(team, [FakeInterface("plan")]))
    assert session.snapshot.inputs == ((None, None, None, (), ()))
    assert session.calibrated is None


def test_a_report_that_fails_silences_its_interface_and_not_its_commands(team: Scenario) -> None:
    gaze = Failing()
    session = ticked(Session(team, [gaze]))
    assert gaze.asked.count("attention") == 1
    assert session.snapshot.inputs.attention is None
    assert len(gaze.contexts) == 100, "it is polled as before"


def test_a_session_tells_its_interfaces_what_there_is_to_look_at(team: Scenario) -> None:
    gaze = Telling()
    session = ticked(Session(team, [gaze]), 3)
    targets, motion = gaze.contexts[-1].targets, session.snapshot.state.motion
    assert targets.fires is session.setup.world.fire_position
    assert targets.fire_radius.shape == motion.fire_radius.shape
    assert targets.robots.shape == motion.position.shape


def test_reports_leave_the_run_as_it_is(team: Scenario) -> None:
    digests = {run_headless(Session(team, [kind]), 2.0)["digest"] for kind in (FakeInterface("gaze"), Telling())}
    assert len(digests) == 1


def test_a_headless_report_has_attention_and_calibration(team: Scenario) -> None:
    report: Any = run_headless(Session(team, [Telling()]), 1.0)
    assert json.loads(json.dumps(report, allow_nan=False))["calibrations"]["gaze"]["residual_px"] == 4.2
    attention = report["attention"]
    assert (attention["fires_s"], attention["robots_s"], attention["elsewhere_s"]) == ([1.25, 0.0], [0.5], 3.0)
    assert attention["transition_entropy"] is None
    assert attention["heat_map"]["to_m"] == [4, 3]
    assert attention_section(None) is None


@pytest.mark.parametrize("most", [1, 3, 4, 50])
def test_a_coarse_heat_map_has_the_same_time(most: int) -> None:
    assert coarse(HEAT, most).sum() == HEAT.sum()
    assert coarse(HEAT, most).shape[1] <= most
    assert coarse(HEAT, 50) is not HEAT


def test_a_recording_has_the_calibration_in_its_header_and_every_new_one(team: Scenario, tmp_path: Path) -> None:
    gaze = Telling()
    recorder = Recorder(tmp_path / "run.jsonl", team, 0, calibrations_of([gaze]))
    session = ticked(Session(team, [gaze], recorder=recorder), 30)
    gaze.calibration = CALIBRATION._replace(residual_m=0.5)
    ticked(session, 70)
    session.close()
    lines = [json.loads(line) for line in (tmp_path / "run.jsonl").read_text().splitlines()]
    assert lines[0]["calibrations"]["gaze"]["file"] == "c.yaml"
    (new,) = [line for line in lines if "calibration" in line]
    assert (new["calibration"], new["residual_m"]) == ("gaze", 0.5)
    assert 30 <= new["tick"] <= 55
    assert [event.text for event in session.snapshot.events if "anew" in event.text] == [
        "Input 'gaze' is calibrated anew: off by 4 px, 0.5 m."
    ]
    assert replay(read_recording(tmp_path / "run.jsonl")).agrees
