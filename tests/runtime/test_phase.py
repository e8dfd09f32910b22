"""A run begins when it is started, ends as its scenario says, and can be continued or run again."""

from pathlib import Path
from typing import Any

import pytest

from higvf_console.core.commands import (
    ContinueRun,
    EmergencyStop,
    Freeze,
    LoadScenario,
    OperatorCommand,
    Pick,
    ResetRun,
    StartRun,
    Step,
    Undo,
)
from higvf_console.core.edits import ChangeEntity, DeleteEntity
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.phase import EndReason, Phase, RunPhase, after_period
from higvf_console.runtime.recording import Recorder, read_recording, replay
from higvf_console.runtime.run import Run
from higvf_console.runtime.session import Session
from higvf_console.scenario.ends import Ends, EndWhen
from higvf_console.scenario.scenario import Scenario, parse_scenario
from tests.fake_interfaces import FakeConsole

PERIOD = 0.02  # [s]
EASY = """
version: 1
name: easy
arena: {size_m: [400, 300]}
robots: {start_m: [[100, 150], [100, 200]]}
fires: [{at_m: [170, 175], radius_m: 5, growth_m_per_s: 0}]
duration_s: 20
"""


def easy(more: str = "") -> Scenario:
    return parse_scenario(EASY + more, "easy.yaml")


def attended(scenario: Scenario, *, waits: bool = True, recorder: Recorder | None = None) -> Session:
    return Session(scenario, [FakeConsole()], recorder=recorder, attended=True, waits=waits)


def give(session: Session, *commands: OperatorCommand, ticks: int = 1) -> Session:
    for command in commands:
        session.pointer.push(command)
    for _ in range(ticks):
        session.tick()
    return session


def phase_of(session: Session) -> Phase:
    return session.snapshot.phase.phase


def texts(session: Session, kind: str) -> list[str]:
    return [event.text for event in session.snapshot.events if event.kind == kind]


def test_the_clock_waits_for_the_start_whatever_else_is_done() -> None:
    session = give(attended(easy()), Pick(1), Step(), ResetRun(), ticks=5)
    assert (phase_of(session), session.ticks, session.snapshot.time) == (Phase.READY, 0, 0.0)
    assert texts(session, "refused") == ["No step: start the run, or continue one that has ended, first."]
    give(session, StartRun(), ticks=3)
    assert (phase_of(session), session.ticks) == (Phase.RUNNING, 3)


def test_a_stop_before_the_start_stays_latched_after_it() -> None:
    session = give(attended(easy()), EmergencyStop(), StartRun(), ticks=20)
    assert session.snapshot.state.intent.stopped
    assert (session.snapshot.state.motion.position == session.setup.start.motion.position).all()


def test_a_second_start_and_a_continuation_of_a_run_that_goes_on_are_refused() -> None:
    session = give(attended(easy()), StartRun(), StartRun(), ContinueRun())
    assert texts(session, "refused") == ["Not done: the run has begun already.", "Not done: the run has not ended."]


def ended(scenario: Scenario) -> Session:
    session = attended(scenario, waits=False)
    while phase_of(session) is Phase.RUNNING:
        give(session)
    return session


def test_the_clock_stands_when_all_fires_are_out_and_goes_on_when_it_is_continued() -> None:
    session = ended(easy())
    ticks = session.ticks
    assert session.snapshot.phase.reason is EndReason.ALL_FIRES_OUT
    assert texts(session, "run") == ["The run has ended: all fires are out."]
    assert give(session, ticks=5).ticks == ticks
    give(session, ContinueRun(), ticks=5)
    assert (phase_of(session), session.ticks) == (Phase.CONTINUED, ticks + 5)


def test_a_run_can_be_run_again_after_its_end() -> None:
    session = give(ended(easy()), ResetRun(), ticks=3)
    assert (phase_of(session), session.snapshot.time) == (Phase.RUNNING, pytest.approx(3 * PERIOD))
    give(session, Undo())
    assert phase_of(session) is Phase.ENDED


def test_the_clock_of_who_watches_nothing_does_not_stand() -> None:
    session = Session(easy(), [])
    while phase_of(session) is not Phase.ENDED:
        session.tick()
    ticks = session.ticks
    session.tick()
    assert session.ticks == ticks + 1


@pytest.mark.parametrize(("ends", "reason"), [("", "duration"), ("ends: {when: never}\n", None)])
def test_time_ends_a_run_that_is_watched_unless_it_never_ends(ends: str, reason: str | None) -> None:
    scenario = parse_scenario(EASY.replace("duration_s: 20", "duration_s: 0.2") + ends, "easy.yaml")
    session = give(attended(scenario, waits=False), ticks=15)
    assert session.snapshot.phase.reason == reason
    assert session.ticks == (10 if reason else 15)


def test_a_loaded_scenario_waits_if_it_is_to() -> None:
    session = give(attended(easy()), StartRun(), LoadScenario(EASY, "easy.yaml", waits=True), ticks=4)
    assert (phase_of(session), session.ticks) == (Phase.READY, 0)
    give(session, StartRun(), LoadScenario(EASY, "easy.yaml"), ticks=4)
    assert (phase_of(session), session.ticks) == (Phase.RUNNING, 4)


def test_a_fire_that_is_removed_does_not_burn_but_no_fires_at_all_are_no_end() -> None:
    session = give(attended(easy(), waits=False), DeleteEntity("fire", 0), ticks=5)
    assert phase_of(session) is Phase.RUNNING


def test_an_undone_edit_leaves_the_phase_as_it_is() -> None:
    session = give(attended(easy()), ChangeEntity("fire", 0, "radius", 8.0), StartRun(), ticks=0)
    give(session, Undo())
    assert phase_of(session) is Phase.RUNNING


def test_an_end_waits_for_the_time_after_it_and_begins_anew_when_its_condition_is_lost() -> None:
    motion = easy().setup().start.motion
    out = motion._replace(fire_burning=~motion.fire_burning)
    ends, phase = Ends(EndWhen.ALL_FIRES_OUT, 0.06), RunPhase()
    held: list[bool] = []
    for now in (out, out, motion, out, out, out, out):
        phase = after_period(phase, now, ends, 100.0, PERIOD)
        held.append(phase.phase is Phase.ENDED)
    assert held == [False] * 6 + [True]


def report(more: str) -> dict[str, Any]:
    return run_headless(Session(easy(more), []))


def test_headless_ends_as_the_scenario_says_and_reports_why() -> None:
    plain, later, endless = (
        report(""),
        report("ends: {when: all_fires_out, after_s: 1}\n"),
        report("ends: {when: never}\n"),
    )
    assert [run["ended"] for run in (plain, later, endless)] == ["all_fires_out", "all_fires_out", "duration"]
    assert later["ticks"] == plain["ticks"] + 50
    assert endless["duration_s"] == 20.0
    path = "path: {sketch: {points_m: [[100, 150], [130, 120], [160, 60]]}}\nends: {when: path_finished}\n"
    assert report(path)["ended"] == "path_finished"


def test_a_recording_of_a_run_that_waited_was_ended_and_continued_replays(tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    scenario = easy()
    session = give(attended(scenario, recorder=Recorder(file, scenario, 0)), Pick(1), ticks=7)
    give(session, StartRun())
    while phase_of(session) is Phase.RUNNING:
        give(session)
    give(session, ticks=3)
    give(session, ContinueRun(), ticks=60)
    give(session, LoadScenario(EASY, "easy.yaml", waits=True), Freeze(False), ticks=3)
    give(session, StartRun(), ticks=60)
    session.close()
    repeated = replay(read_recording(file))
    assert repeated.agrees
    assert repeated.ticks == session.ticks


def test_a_run_without_a_scenario_ends_when_its_fires_are_out() -> None:
    run = Run(easy().setup())
    while run.phase.phase is Phase.RUNNING:
        run.step()
    assert run.phase.reason is EndReason.ALL_FIRES_OUT
