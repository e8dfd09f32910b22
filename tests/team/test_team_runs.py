"""The rules of a team that is not integrated here, each in a run with a simulated team that breaks them."""

import math
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.commands import (
    Arm,
    AskArm,
    AskReset,
    Disarm,
    EmergencyStop,
    Freeze,
    LoadScenario,
    OperatorCommand,
    ReleaseRobot,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    SetSpeed,
    Step,
    StopRobot,
)
from higvf_console.core.edits import AddEntity, EntityKind, SetParameters
from higvf_console.core.events import Severity
from higvf_console.core.team import VALID_FOR, Poses, RobotLink
from higvf_console.runtime.recording import read_recording, replay
from higvf_console.team.state import Arming
from tests.rehearsal import PERIOD, THREE, Rehearsal

STILL = 1e-6  # [m]


def test_nothing_moves_before_the_team_is_armed() -> None:
    run = Rehearsal()
    assert run.moved(2.0) == 0.0
    assert run.session.snapshot.team is not None
    assert run.team.arming is Arming.DISARMED
    run.give(Arm())
    assert "Not done: the check comes first." in run.texts()
    assert run.moved(1.0) == 0.0


def test_an_armed_team_puts_the_fire_out_where_the_plant_is_and_violates_nothing() -> None:
    run = Rehearsal().arm()
    while run.session.snapshot.state.motion.fire_burning.any() and run.session.snapshot.time < 200.0:
        run.beat()
    now = run.session.snapshot
    assert now.extinguished == (0,)
    assert now.infeasible_ticks == 0
    assert now.min_clearance > 0.0
    centres = now.state.motion.position - 0.024 * np.column_stack(
        (np.cos(now.state.motion.heading), np.sin(now.state.motion.heading))
    )
    assert np.abs(centres - run.plant.truth.position).max() < 0.005


def test_robots_that_drive_on_in_silence_are_not_armed() -> None:
    run = Rehearsal("watchdog=0")
    run.last(0.5)
    run.give(AskArm())
    run.last(4.0)
    assert run.team.arming is Arming.DISARMED
    (told,) = run.texts(Severity.ALARM)
    assert told == "Not armed: robots 1, 2 and 3 did not stand when nothing was sent any more."


def test_a_robot_that_does_not_move_in_the_check_is_named() -> None:
    run = Rehearsal("dead=2")
    run.plant.relink = lambda links: tuple(RobotLink(link.acknowledged) for link in links)
    seen = run.plant.truth.position[1].copy()

    def still_seen(poses: Poses, now: float) -> Poses:
        position, heading, at = (part.copy() for part in poses)
        position[1], heading[1], at[1] = seen, 0.0, now
        return Poses(position, heading, at)

    run.plant.meddle = still_seen
    run.last(0.5)
    run.give(AskArm())
    run.last(2.0)
    assert run.texts(Severity.ALARM) == ["Not armed: robot 2 did not move in the check."]


def test_stop_stands_within_two_beats_sends_zeros_until_reset_and_its_lamps_follow() -> None:
    run = Rehearsal("latency_s=0.04").arm()
    run.last(3.0)
    stops = run.plant.stops
    run.plant.sent.clear()
    run.give(EmergencyStop())
    assert run.plant.stops == stops + 1
    assert not run.team.acknowledged.any()
    run.last(0.1)
    assert all(not command.velocity.any() and not command.forward.any() for command in run.plant.sent)
    assert len(run.plant.sent) == 6
    assert run.team.acknowledged.all()
    assert not run.team.track.stands().any()
    run.last(0.4)
    assert run.team.track.stands().all()
    assert run.moved(1.0) < STILL
    run.give(AskReset())
    run.give(ResetEmergencyStop())
    run.give(Resume())
    assert run.moved(1.0) > 0.01
    assert run.plant.stops == stops + 1


def test_stop_ends_the_check_at_once_and_no_check_begins_under_stop() -> None:
    run = Rehearsal()
    run.last(0.5)
    run.give(AskArm())
    run.last(0.2)
    run.plant.sent.clear()
    run.give(EmergencyStop())
    assert run.team.arming is Arming.DISARMED
    run.last(0.5)
    assert not any(command.turn.any() or command.forward.any() for command in run.plant.sent)
    assert len(run.plant.sent) == 26
    run.give(AskArm())
    assert run.texts()[-1] == "Not done: STOP is active, and the check moves every robot: reset it first."
    assert run.team.arming is Arming.DISARMED


def test_a_robot_that_is_stopped_is_not_moved_by_the_check() -> None:
    run = Rehearsal()
    run.last(0.5)
    run.give(AskArm())
    run.give(StopRobot(1))
    assert run.team.arming is Arming.DISARMED
    run.last(1.0)
    run.give(AskArm())
    assert run.texts()[-1] == "Not done: robot 2 must be released first, for the check moves every robot."


def test_the_engine_fails_and_the_robots_stand() -> None:
    run = Rehearsal().arm()
    run.last(2.0)
    run.halt(RuntimeError("broken"))
    assert run.moved(0.1) < 0.01  # what was on its way
    assert run.moved(1.0) < STILL


def test_a_frozen_clock_lets_the_robots_stand_and_a_step_drives_for_one_period() -> None:
    run = Rehearsal().arm()
    run.last(3.0)
    run.give(Freeze(True))
    run.last(0.1)
    assert run.moved(1.0) < STILL
    run.give(Step())
    assert 0.0 < run.moved(0.2) < 0.12 * 2 * PERIOD
    run.give(SetSpeed(2.0))
    assert run.session.snapshot.speed == 1.0
    assert "The clock cannot run at 2 times real time: the robots of a team drive in real time." in [
        event.text for event in run.session.snapshot.events
    ]


def test_one_robot_is_stopped_stays_stopped_and_the_others_keep_clear_of_it() -> None:
    run = Rehearsal().arm()
    run.last(4.0)
    run.give(StopRobot(1))
    run.last(0.5)
    at = run.plant.truth.position[1].copy()
    closest = math.inf
    for _ in range(1200):
        run.beat()
        gap = np.hypot(*(run.plant.truth.position[[0, 2]] - at).T).min()
        closest = min(closest, float(gap))
    assert np.abs(run.plant.truth.position[1] - at).max() < STILL
    assert closest > 2 * 0.037
    run.give(EmergencyStop())
    run.give(AskReset())
    run.give(ResetEmergencyStop())
    run.give(Resume())
    run.last(1.0)
    assert np.abs(run.plant.truth.position[1] - at).max() < STILL
    run.give(ReleaseRobot(1))
    run.last(3.0)
    assert np.abs(run.plant.truth.position[1] - at).max() > 0.01


@pytest.mark.parametrize("command", [StopRobot(3), ReleaseRobot(-1), ReleaseRobot(0)])
def test_what_cannot_be_stopped_or_released_is_refused(command: StopRobot | ReleaseRobot) -> None:
    run = Rehearsal().arm()
    run.give(command)
    (told,) = [text for text in run.texts() if text.startswith("Not done: ")]
    words = {
        3: "there is no robot 4: the team has robots 1 to 3",
        -1: "there is no robot 0",
        0: "robot 1 is not stopped",
    }
    assert words[command.robot] in told


def test_a_dead_robot_disarms_the_team_which_does_not_resume_by_itself() -> None:
    run = Rehearsal("dead=3,dead_at_s=6").arm()
    run.last(6.0)
    assert run.team.arming is Arming.DISARMED
    assert run.texts(Severity.ALARM) == ["The team is disarmed: the link to robot 3 is broken."]
    assert run.moved(2.0) < STILL
    run.give(AskArm())
    assert run.texts()[-1] == "Not done: robot 3 cannot be seen."


def test_a_robot_that_drives_on_after_stop_is_told() -> None:
    run = Rehearsal("deaf=1,deaf_at_s=6").arm()
    run.last(4.0)
    run.give(EmergencyStop())
    run.last(2.0)
    assert run.texts(Severity.ALARM) == ["Robot 1 drives on, though it was told to stand."]
    assert run.team.disobedient.tolist() == [True, False, False]


def test_robots_that_are_seen_again_after_a_loss_are_not_taken_for_disobedient() -> None:
    run = Rehearsal().arm()
    run.last(3.0)
    since, last = run.team.now, run.plant.poses(run.team.now)

    def blind(poses: Poses, now: float) -> Poses:
        return last if now < since + 3.0 else poses

    run.plant.meddle = blind
    run.last(5.0)
    assert run.texts(Severity.ALARM) == ["The team is disarmed: robots 1, 2 and 3 cannot be seen."]


def test_a_disarmed_robot_that_people_carry_is_not_taken_for_disobedient() -> None:
    run = Rehearsal()
    run.last(2.0)
    begun = run.team.now
    run.plant.meddle = lambda poses, now: poses._replace(position=poses.position + 0.5 * (now - begun))
    run.last(2.0)
    assert not run.team.disobedient.any()
    assert run.texts(Severity.ALARM) == []


def test_a_stale_pose_holds_its_robot_and_a_lost_one_the_team() -> None:
    run = Rehearsal().arm()
    run.last(3.0)
    since = run.team.now

    def blind(poses: Poses, _now: float) -> Poses:
        at = poses.measured_at.copy()
        at[0] = min(at[0], since)
        position = poses.position.copy()
        position[0] = np.nan if at[0] == since else position[0]
        return Poses(np.where(np.isnan(position), hidden, position), poses.heading, at)

    hidden = run.plant.truth.position.copy()
    run.plant.meddle = blind
    run.last(0.5)
    assert run.team.stale.tolist() == [True, False, False]
    assert run.team.armed
    before = run.plant.truth.position.copy()
    run.last(0.3)
    moved = np.hypot(*(run.plant.truth.position - before).T)
    assert moved[0] < STILL < moved[1]
    run.last(0.5)
    assert run.team.arming is Arming.DISARMED
    assert run.texts(Severity.ALARM) == ["The team is disarmed: robot 1 cannot be seen."]
    run.plant.meddle = lambda poses, _now: poses
    run.last(2.0)
    assert run.team.arming is Arming.DISARMED
    assert run.moved(1.0) < STILL


JUMP, NUMBER, FUTURE = (
    "A pose of robot 2 is farther away than it can drive: refused.",
    "A pose of robot 2 is not a number: refused.",
    "A pose of robot 2 is from the future: refused.",
)


@pytest.mark.parametrize(
    ("told", "place", "ahead"),
    [
        (JUMP, (1.0, 0.0), 0.0),
        (NUMBER, (math.nan, 0.0), 0.0),
        (NUMBER, (math.inf, 0.0), 0.0),
        (FUTURE, (0.0, 0.0), 60.0),
    ],
)
def test_a_pose_that_cannot_be_is_refused_counted_and_told_once(
    told: str, place: tuple[float, float], ahead: float
) -> None:
    run = Rehearsal().arm()
    run.last(2.0)

    def meddle(poses: Poses, _now: float) -> Poses:
        position, at = poses.position.copy(), poses.measured_at.copy()
        position[1] += place
        at[1] += ahead
        return Poses(position, poses.heading, at)

    run.plant.meddle = meddle
    run.last(0.2)
    run.plant.meddle = lambda poses, _now: poses
    assert run.texts(Severity.WARNING) == [told]
    assert run.team.track.refused[1] == 10
    before = run.session.snapshot.state.motion.position[1]
    assert np.hypot(*(run.team.track.position[1] - before)) < 0.05
    run.last(1.0)
    assert run.team.armed
    assert not run.team.faults.any()


def test_a_team_that_raises_is_stopped_disarmed_and_can_be_armed_again_when_it_answers() -> None:
    run = Rehearsal().arm()
    run.last(1.0)
    stops = run.plant.stops

    def broken(_poses: Poses, _now: float) -> Poses:
        raise OSError("cable pulled")

    run.plant.meddle = broken
    run.beat()
    assert run.plant.stops == stops + 1
    assert run.texts(Severity.ALARM) == [
        "The team is disarmed: team 'simulated' failed in poses: OSError: cable pulled."
    ]
    before = run.session.ticks
    run.last(2.5)
    assert run.session.ticks == before + 125
    assert run.team.failure
    assert len(run.texts(Severity.ALARM)) == 1
    run.plant.meddle = lambda poses, _now: poses
    run.last(1.5)
    assert run.team.failure == ""
    assert run.team.arming is Arming.DISARMED
    assert run.moved(1.0) < STILL
    run.arm()


def test_disarming_and_closing_stop_the_robots() -> None:
    run = Rehearsal().arm()
    run.last(3.0)
    run.give(Disarm())
    run.last(0.2)
    assert run.moved(1.0) < STILL
    run.session.close()
    assert run.plant.closed
    assert run.plant.stops


def test_every_command_expires() -> None:
    run = Rehearsal().arm()
    run.last(1.0)
    assert {command.valid_for for command in run.plant.sent} == {VALID_FOR}
    numbers = [command.number for command in run.plant.sent]
    assert numbers == list(range(1, len(numbers) + 1))


def test_the_number_of_robots_cannot_change() -> None:
    run = Rehearsal()
    run.give(AddEntity(EntityKind.ROBOT, np.array([1.5, 1.0])))
    assert "Not done: the team has 3 robots, and there would be 4." in run.texts()


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (
            LoadScenario(THREE.replace("0.024", "0.02"), "t.yaml"),
            "0.024 m ahead of their centres, and it would be 0.02 m",
        ),
        (
            LoadScenario(THREE + "filter: centralised\n", "t.yaml"),
            "needs the filter 'distributed', not 'cent",
        ),
        (
            LoadScenario(THREE.replace("limit: 4}", "limit: 4, position_noise: 0.005}"), "t.yaml"),
            "0.005 m of simulated error",
        ),
        (SetParameters({"robots.turn_rate_limit": 8.0}), "drive 0.0959744 m/s, and it would be 0.12 m/s"),
        (SetParameters({"safety.speed_limit": 0.05}), ""),
    ],
)
def test_robots_are_led_no_faster_and_nowhere_else_than_those_that_there_are(
    command: OperatorCommand, words: str
) -> None:
    run = Rehearsal()
    run.give(command)
    assert any(words in text for text in run.texts()) if words else not run.texts()


def test_a_reset_leaves_the_robots_where_they_are() -> None:
    run = Rehearsal().arm()
    run.last(10.0)
    at = run.plant.truth.position.copy()
    run.give(ResetRun())
    assert np.abs(run.session.snapshot.state.motion.position - at).max() < 0.06
    assert run.session.snapshot.time == pytest.approx(PERIOD)


def test_the_budget_grows_with_the_error_of_prediction_and_with_latency() -> None:
    quiet, late = Rehearsal().arm(), Rehearsal("latency_s=0.15,noise_m=0.004,loss=0.1").arm()
    quiet.last(5.0)
    late.last(5.0)
    assert quiet.session.snapshot.last.guard.budget < 0.002
    assert 0.004 < late.session.snapshot.last.guard.budget < 0.037
    assert late.team.latency == pytest.approx(0.17, abs=0.05)


def test_a_recorded_run_of_a_team_replays_to_the_same_digest_without_it(tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    run = Rehearsal("latency_s=0.1,noise_m=0.003,loss=0.1,seed=4", record=file).arm()
    run.last(4.0)
    run.give(StopRobot(2))
    run.last(1.0)
    run.give(Freeze(True))
    run.last(0.2)
    run.give(Freeze(False))
    run.last(2.0)
    run.give(EmergencyStop())
    run.last(0.5)
    run.session.close()
    recording = read_recording(file)
    again = replay(recording)
    assert again.differs_after is None
    assert again.complete
    assert again.ticks == run.session.ticks


def test_a_scenario_gives_options_that_the_command_line_overrides() -> None:
    run = Rehearsal("loss=0", text=THREE + "teams: {simulated: {loss: 1, latency_s: 0.2}}\n")
    run.last(1.0)
    assert run.team.track.seen.all()
    assert run.team.track.age(run.team.now).min() > 0.19


def test_an_unknown_team_in_a_scenario_is_warned_of() -> None:
    (warning,) = Rehearsal(text=THREE + "teams: {simulatd: {loss: 1}}\n").scenario.warnings
    words = "teams.simulatd: no such team or source of poses is installed (did you mean 'simulated'?); installed: "
    assert warning.startswith(words)
