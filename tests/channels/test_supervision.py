"""Lost channels: what becomes of the team, who may command meanwhile, and what it takes to come back."""

from pathlib import Path

import numpy as np
import pytest

from higvf_console.channels.faults import Line
from higvf_console.core.commands import (
    Acknowledge,
    Clutch,
    Confirm,
    ControlChange,
    Cursor,
    EmergencyStop,
    FaultKind,
    HandOver,
    InjectFault,
    LoadScenario,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    Prioritise,
    ResetRun,
    Resume,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    Undo,
)
from higvf_console.core.interface import Capabilities, ChannelHealth, ChannelState, OperatorContext
from higvf_console.core.state import PathKind, PathStatus
from higvf_console.runtime.recording import Recorder, read_recording, replay
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, parse_scenario
from tests.fake_interfaces import FakeConsole, FakeInterface

STROKE = np.array([[600.0, 350.0], [500.0, 400.0], [400.0, 400.0], [300.0, 300.0]])
BEGIN = [StrokeBegin(source="gaze"), StrokePoints(STROKE, source="gaze")]
DRAWN: list[OperatorCommand] = [*BEGIN, StrokeEnd(source="gaze")]


class Device(FakeInterface):
    """Live until it falls silent, and again from another time on."""

    capabilities = Capabilities(stale_after=0.5)

    def __init__(self, *plan: tuple[float, OperatorCommand], silent: float = 1.0, back: float = np.inf) -> None:
        super().__init__("gaze", *plan)
        self.silent, self.back = silent, back

    def health(self, now: float) -> ChannelHealth:
        last_seen = self.silent if self.silent < now < self.back else now
        return ChannelHealth(ChannelState.LIVE, "a device", last_seen)


def limited(team: Scenario, on_lost: str) -> Scenario:
    return parse_scenario(f"{team.text}\ninputs: {{gaze: {{stale: 0.5, lost: 2, on_lost: {on_lost}}}}}\n", "team.yaml")


def run_to(session: Session, time: float) -> Session:
    while session.snapshot.time < time - 1e-9:
        session.tick()
    return session


def state_of(session: Session, channel: str = "gaze") -> ChannelState:
    return dict(session.snapshot.channels)[channel].state


def given(session: Session, kind: type[OperatorCommand], source: str = "session") -> int:
    return sum(isinstance(command, kind) and command.source == source for _, command in session.commands)


def at_once(*commands: OperatorCommand, time: float = 0.0) -> list[tuple[float, OperatorCommand]]:
    return [(time, command) for command in commands]


def test_a_channel_goes_stale_and_lost_by_its_limits_and_the_log_tells(team: Scenario) -> None:
    session = run_to(Session(team, [Device(silent=1.0)]), 1.4)
    assert state_of(session) is ChannelState.LIVE
    assert state_of(run_to(session, 1.8)) is ChannelState.STALE
    assert state_of(run_to(session, 3.3)) is ChannelState.LOST
    told = [event.text for event in session.snapshot.events if event.kind == "channel"]
    assert [text.split(":")[0] for text in told] == ["Input 'gaze' is stale", "Input 'gaze' is lost"]


def test_the_path_of_a_lost_channel_ends_in_autonomy(team: Scenario) -> None:
    session = run_to(Session(limited(team, "autonomy"), [Device(*at_once(*DRAWN))]), 2.9)
    assert session.snapshot.state.motion.path_status == PathStatus.FOLLOWING
    run_to(session, 3.3)
    assert session.snapshot.state.motion.path_status == PathStatus.FINISHED
    assert given(session, NextTask) == 1
    assert not session.snapshot.state.intent.paused


def test_a_team_that_waits_at_the_end_of_its_path_is_let_go_when_the_channel_is_lost(team: Scenario) -> None:
    drawn = [StrokeBegin(), StrokePoints(STROKE), StrokeEnd(ending="hold", duration=1.0)]
    session = run_to(Session(limited(team, "autonomy"), [Device(*at_once(*drawn))]), 2.9)
    assert session.snapshot.state.motion.path_status == PathStatus.HOLDING
    run_to(session, 3.3)
    assert session.snapshot.state.motion.path_status == PathStatus.FINISHED


def test_or_in_a_hold_or_is_kept_as_the_scenario_says(team: Scenario) -> None:
    hold = run_to(Session(limited(team, "hold"), [Device(*at_once(*DRAWN))]), 3.3)
    assert hold.snapshot.state.intent.paused
    keep = run_to(Session(limited(team, "keep"), [Device(*at_once(*DRAWN))]), 3.3)
    assert keep.snapshot.state.motion.path_status == PathStatus.FOLLOWING
    assert not keep.snapshot.state.intent.paused


@pytest.mark.parametrize("on_lost", ["autonomy", "hold", "keep"])
def test_the_priorities_of_a_lost_channel_end_too_and_those_of_another_stay(team: Scenario, on_lost: str) -> None:
    own, others = ([Prioritise((0,), robot, 4.0)] for robot in (0, 1))
    devices = [Device(*at_once(*own)), FakeInterface("bci", *at_once(*others))]
    session = run_to(Session(limited(team, on_lost), devices), 2.9)
    both = [[0.0, 0.0, 4.0], [1.0, 0.0, 4.0]]
    assert session.snapshot.state.intent.priority.tolist() == both
    run_to(session, 3.3)
    assert session.snapshot.state.intent.priority.tolist() == (both[1:] if on_lost == "autonomy" else both)
    assert session.snapshot.state.intent.paused is (on_lost == "hold")


@pytest.mark.parametrize(("how", "ends"), [(ControlChange.LOST, True), (ControlChange.TAKEN, False)])
def test_the_path_ends_with_the_page_that_steered_though_another_keeps_the_channel_alive(
    team: Scenario, how: ControlChange, ends: bool
) -> None:
    plan = [*at_once(StrokeBegin(), StrokePoints(STROKE), StrokeEnd()), (1.0, HandOver("Browser 2", how))]
    session = run_to(Session(team, [FakeConsole(*plan)]), 0.9)
    assert session.snapshot.state.motion.path_status == PathStatus.FOLLOWING
    run_to(session, 2.0)
    assert (session.snapshot.state.motion.path_status == PathStatus.FINISHED) is ends
    assert given(session, NextTask) == ends


def test_a_change_of_control_gets_through_a_lost_channel_and_a_fault_and_is_no_acknowledgement(team: Scenario) -> None:
    told = HandOver("Browser 2", ControlChange.TAKEN, source="gaze")
    session = run_to(Session(team, [Device((3.5, told), silent=0.5)]), 3.6)
    assert state_of(session) is ChannelState.LOST
    assert given(session, HandOver, "gaze") == 1
    line = Line()
    line.inject(InjectFault("gaze", FaultKind.DROP), 0.0)
    assert line.carry([told], 0.5) == [told]


def test_the_human_intention_fades_within_a_few_time_constants_and_without_a_jump(team: Scenario) -> None:
    session = Session(limited(team, "autonomy"), [Device(*at_once(*DRAWN), silent=0.0)])
    weights = session.setup.params.intention
    rate, dt = weights.decay + weights.robot_weight, session.setup.params.safety.control_period
    run_to(session, 1.9)
    leader = session.snapshot.state.intent.influenced
    gaps: list[float] = []
    while session.snapshot.time < 4.0:
        session.tick()
        if session.snapshot.state.motion.path_status == PathStatus.FINISHED:
            own = session.snapshot.trace.robot_intention * weights.robot_weight / rate
            shared = session.snapshot.state.motion.intention
            gaps.append(float(np.linalg.norm(shared[leader] - own[leader])))
    steps = -np.diff(gaps[: int(1.0 / dt)])
    assert gaps[0] > 0.3, "the human was felt"
    assert steps.max() < 0.35 * gaps[0], "no period takes a third of it at once"
    assert gaps[round(5 / (rate * dt))] < 0.1 * gaps[0], "after five time constants little is left"


def test_a_stroke_that_was_growing_is_dropped_and_the_path_of_another_stays(team: Scenario) -> None:
    console = FakeConsole(*at_once(StrokeBegin(), StrokePoints(STROKE), StrokeEnd()))
    session = run_to(Session(team, [Device(*at_once(*BEGIN, time=0.5)), console]), 3.3)
    assert session.snapshot.state.pointer_state.stroke_source == ""
    assert session.snapshot.state.intent.path.kind != PathKind.NONE
    assert session.snapshot.state.motion.path_status == PathStatus.FOLLOWING


def test_a_channel_that_did_not_steer_is_lost_without_consequence(team: Scenario) -> None:
    session = run_to(Session(limited(team, "hold"), [Device(*at_once(Pick(1), Cursor(STROKE[0])))]), 3.3)
    assert state_of(session) is ChannelState.LOST
    assert not session.snapshot.state.intent.paused
    assert all(command.source != "session" for _, command in session.commands)


def test_a_clutch_that_a_lost_channel_held_opens(team: Scenario) -> None:
    session = run_to(Session(team, [Device(*at_once(Clutch(closed=True, source="gaze")))]), 3.3)
    assert not session.snapshot.state.pointer_state.clutch


def test_what_is_back_commands_nothing_but_stop_and_pause_before_it_is_acknowledged(team: Scenario) -> None:
    plan = [(3.8, Pick(2, source="gaze")), (3.9, Pause(source="gaze")), (4.6, Pick(1, source="gaze"))]
    console = FakeConsole((4.4, Acknowledge()))
    session = run_to(Session(team, [Device(*plan, back=3.5), console]), 4.2)
    assert state_of(session) is ChannelState.RECOVERED
    assert session.snapshot.state.intent.influenced == 0
    assert session.snapshot.state.intent.paused
    assert "1 commands withheld" in dict(session.snapshot.channels)["gaze"].detail
    assert state_of(run_to(session, 4.6)) is ChannelState.LIVE
    run_to(session, 4.7)
    assert session.snapshot.state.intent.influenced == 1
    assert "acknowledge it" in " ".join(event.text for event in session.snapshot.events)


@pytest.mark.parametrize(
    ("command", "source", "state"),
    [
        (Resume(), "emg", ChannelState.LIVE),
        (Acknowledge(channel="gaze"), "emg", ChannelState.LIVE),
        (Acknowledge(channel="bci"), "emg", ChannelState.RECOVERED),
        (Pick(1), "emg", ChannelState.RECOVERED),
        (Acknowledge(), "gaze", ChannelState.LIVE),
        (Pick(1), "gaze", ChannelState.RECOVERED),
    ],
)
def test_only_an_explicit_word_takes_a_channel_back(
    team: Scenario, command: OperatorCommand, source: str, state: ChannelState
) -> None:
    device, other = Device(back=3.5), FakeInterface("emg")
    (device if source == "gaze" else other).plan.append((4.0, command))
    assert state_of(run_to(Session(team, [device, other]), 4.3)) is state


def test_nothing_to_acknowledge_is_said(team: Scenario) -> None:
    session = run_to(Session(team, [FakeInterface("emg", (0.1, Acknowledge()))]), 0.2)
    assert session.snapshot.events[-1].text == "No input waits to be acknowledged."


def test_a_frozen_channel_is_lost_and_its_backlog_changes_nothing(team: Scenario) -> None:
    fault = InjectFault(channel="emg", kind=FaultKind.FREEZE, seconds=5.0)
    emg = FakeInterface("emg", (2.0, Pick(2, source="emg")))
    session = run_to(Session(team, [emg, FakeInterface("script", (1.0, fault))]), 5.4)
    assert state_of(session, "emg") is ChannelState.LOST
    run_to(session, 6.3)
    assert state_of(session, "emg") is ChannelState.RECOVERED
    assert session.snapshot.state.intent.influenced == 0


def test_a_short_freeze_only_makes_commands_late(team: Scenario) -> None:
    fault = InjectFault(channel="emg", kind=FaultKind.FREEZE, seconds=0.5)
    emg = FakeInterface("emg", (1.2, Pick(2, source="emg")))
    session = run_to(Session(team, [emg, FakeInterface("script", (1.0, fault))]), 1.4)
    assert session.snapshot.state.intent.influenced == 0
    assert run_to(session, 1.6).snapshot.state.intent.influenced == 2


def test_a_stop_passes_every_fault(team: Scenario) -> None:
    faults = [(0.0, InjectFault(channel="console", kind=kind, seconds=60.0)) for kind in FaultKind]
    for fault in faults:
        console = FakeConsole((1.0, EmergencyStop()))
        session = run_to(Session(team, [console, FakeInterface("script", fault)]), 1.1)
        assert session.snapshot.state.intent.stopped


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (InjectFault(channel="nose"), "there is no input 'nose'; inputs: emg"),
        (InjectFault(channel="emg", seconds=-1.0), "a fault of -1 s"),
    ],
)
def test_a_fault_that_cannot_be_is_refused(team: Scenario, fault: InjectFault, said: str) -> None:
    session = run_to(Session(team, [FakeInterface("emg", (0.1, fault))]), 0.2)
    assert said in session.snapshot.events[-1].text


def test_a_reset_run_starts_with_sound_lines(team: Scenario) -> None:
    fault = InjectFault(channel="emg", seconds=60.0)
    script = FakeInterface("script", (0.1, fault), (6.0, ResetRun()))
    session = Session(team, [FakeInterface("emg"), script])
    assert state_of(run_to(session, 5.0), "emg") is ChannelState.LOST
    for _ in range(80):
        session.tick()
    assert state_of(session, "emg") is ChannelState.LIVE


@pytest.mark.parametrize(
    ("kind", "come"),
    [
        (FaultKind.DROP, {0.9: [0.9], 3.1: [3.1]}),
        (FaultKind.DELAY, {0.9: [0.9], 1.6: [1.0], 2.1: [1.5], 2.6: [2.0], 3.1: [2.5, 3.1]}),
        (FaultKind.FREEZE, {0.9: [0.9], 3.1: [1.0, 1.5, 2.0, 2.5, 3.1]}),
    ],
)
def test_a_line_delays_drops_or_holds_back_and_nothing_overtakes(
    kind: FaultKind, come: dict[float, list[float]]
) -> None:
    line, last_seen = Line(), dict[float, list[float]]()
    for now in (0.9, 1.0, 1.5, 1.6, 2.0, 2.1, 2.5, 2.6, 3.1, 3.6):
        if now == 1.0:
            line.inject(InjectFault(channel="emg", kind=kind, seconds=2.0, delay=0.6), now)
        said = [Pick(0, time=now)] if now in (0.9, 1.0, 1.5, 2.0, 2.5, 3.1) else []
        for command in line.carry(said, now):
            last_seen.setdefault(now, []).append(command.time)
    assert last_seen == come


@pytest.mark.parametrize("on_lost", ["autonomy", "hold"])
def test_a_recorded_loss_replays_to_the_same_digest(team: Scenario, tmp_path: Path, on_lost: str) -> None:
    scenario, file = limited(team, on_lost), tmp_path / "run.jsonl"
    fault = InjectFault(channel="gaze", kind=FaultKind.FREEZE, seconds=3.0)
    gaze = FakeInterface("gaze", *at_once(*DRAWN), (2.0, Pick(1, source="gaze")))
    session = Session(scenario, [gaze, FakeInterface("script", (0.5, fault))], recorder=Recorder(file, scenario, 0))
    run_to(session, 5.0)
    session.close()
    assert session.snapshot.state.motion.path_status == (
        PathStatus.FINISHED if on_lost == "autonomy" else PathStatus.FOLLOWING
    )
    assert replay(read_recording(file)).agrees


def test_a_path_that_waited_and_was_confirmed_ends_with_the_page_that_drew_it(team: Scenario) -> None:
    drawn = at_once(StrokeBegin(), StrokePoints(STROKE), StrokeEnd(preview=True), Confirm())
    page = FakeConsole(*drawn, (1.0, HandOver("Browser 2", ControlChange.LOST)))
    session = run_to(Session(team, [page]), 2.0)
    assert session.snapshot.state.motion.path_status == PathStatus.FINISHED


def test_a_replay_does_not_repeat_itself_when_the_reset_of_a_run_is_undone(team: Scenario) -> None:
    class Replay(FakeInterface):
        """Gives a pick a second, by the session clock, and begins again when that is set back."""

        now = 0.0

        def poll(self, context: OperatorContext) -> list[OperatorCommand]:
            if context.time < self.now:
                self.now = 0.0
            due = [Pick(int(second) % 3) for second in (1, 2, 3) if self.now < second <= context.time]
            self.now = context.time
            return list(due)

    console = FakeConsole()
    session = run_to(Session(team, [Replay("bci"), console]), 3.5)
    for command in (ResetRun(), Undo()):
        console.push(command)
        session.tick()
    assert session.snapshot.time > 3.4
    run_to(session, 3.8)
    assert given(session, Pick, "console") == 3  # as fakes sign


def test_the_limits_of_a_scenario_that_is_loaded_hold_and_its_settings_of_open_inputs_are_said_not_to(
    team: Scenario,
) -> None:
    strict = team.text + "inputs: {gaze: {stale: 0.1, lost: 0.3, clutch: held}}\n"
    console = FakeConsole((0.5, LoadScenario(text=strict, name="strict.yaml")))
    session = Session(team, [Device(silent=0.0), console])
    while session.snapshot.scenario is team:
        session.tick()
    (said,) = [event.text for event in session.snapshot.events if event.kind == "channel"]
    assert said == "Input 'gaze' keeps its settings; those of 'team' count when the console starts."
    assert state_of(run_to(session, 0.5)) is ChannelState.LOST
    console.push(Undo())
    session.tick()
    assert state_of(run_to(session, 0.9)) is ChannelState.RECOVERED  # by the limits that hold again
