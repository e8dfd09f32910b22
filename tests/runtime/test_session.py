"""The loop between operator and team, ticked by hand and, where the clock is the point, paced."""

import logging
import math
import threading
import time
from typing import Any

import numpy as np
import pytest

from higvf_console.analysis.baseline import compute_baseline
from higvf_console.channels.console import ConsoleChannel
from higvf_console.core.commands import (
    AskReset,
    Clutch,
    Cursor,
    EmergencyStop,
    Freeze,
    InjectFault,
    LoadScenario,
    OperatorCommand,
    Pause,
    Pick,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    SetSpeed,
    Step,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelState, OperatorContext
from higvf_console.core.state import PathStatus
from higvf_console.core.viewport import Viewport
from higvf_console.runtime.background.worker import Worker
from higvf_console.runtime.journal import EVENTS_KEPT
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, load_scenario, parse_scenario
from higvf_console.sim.simulation import advance
from tests.fake_interfaces import BrokenInterface, FakeConsole, FakeInterface

STROKE = np.array([[600.0, 350.0], [500.0, 400.0], [400.0, 400.0], [300.0, 300.0]])


def kinds(session: Session) -> list[str]:
    return [event.kind for event in session.snapshot.events]


def test_there_is_a_snapshot_before_the_first_tick(team: Scenario) -> None:
    session = Session(team, [FakeConsole()])
    now = session.snapshot
    assert (now.time, now.frozen, now.speed, now.extinguished, now.infeasible_ticks) == (0.0, False, 1.0, (), 0)
    assert now.trace.nominal.shape == (3, 2)
    assert [name for name, _ in now.channels] == ["console"]
    np.testing.assert_allclose(now.loss_area, [np.pi * 20**2])


class WarnedInterface(FakeInterface):
    warnings = ("script.yaml, entry 1: thing: renamed; write kind",)


def test_warnings_of_scenario_and_inputs_are_its_first_events() -> None:
    text = "version: 1\narena: {size_m: [900, 700]}\nrobots: {start_m: [[100, 100]]}\nparameters: {rings: {}}"
    session = Session(parse_scenario(text, "t.yaml"), [FakeInterface("mouse"), WarnedInterface("script")])
    assert [(event.kind, event.text) for event in session.snapshot.events] == [
        ("scenario", "t.yaml: parameters.rings: renamed; write parameters.boundaries"),
        ("input", "script.yaml, entry 1: thing: renamed; write kind"),
    ]


def test_a_tick_is_one_advance(team: Scenario) -> None:
    session = Session(team, [])
    state = session.setup.start
    for _ in range(5):
        state, _ = advance(state, session.setup.world, session.setup.params)
        session.tick()
    assert session.snapshot.state.motion.position.tobytes() == state.motion.position.tobytes()
    assert session.snapshot.time == pytest.approx(0.1)
    assert session.ticks == 5


def test_the_centralised_filter_runs_where_the_scenario_asks_for_it(team: Scenario) -> None:
    close = team.text.replace("[670, 350]", "[665, 300]").replace("[500, 250]", "[682, 430]")
    text = close + "parameters: {formation: {formation_rate: 0}}\n"
    distributed, coupled = (
        Session(parse_scenario(text + f"filter: {kind}", "t.yaml"), []) for kind in ("distributed", "centralised")
    )
    for session in (distributed, coupled):
        for _ in range(100):
            session.tick()
    assert coupled.snapshot.infeasible_ticks == 0
    assert coupled.snapshot.min_clearance >= 0.0
    difference = coupled.snapshot.state.motion.position - distributed.snapshot.state.motion.position
    assert 0.0 < np.abs(difference).max() < 50.0


def test_interfaces_are_told_what_they_may_know(team: Scenario) -> None:
    console = FakeConsole((0.0, Pick(1)), (0.0, Pause()), (0.0, Clutch(closed=True)))
    session = Session(team, [console])
    session.viewport = Viewport(800.0, 600.0, 0.0, 0.0, 1.0)
    session.tick()
    session.tick()
    first, second = console.contexts
    assert (first.time, first.paused, first.influenced, first.clutch, first.robots) == (0.0, False, 0, False, 3)
    assert (second.time, second.paused, second.influenced, second.clutch) == (pytest.approx(0.02), True, 1, True)
    assert second.viewport is session.viewport


def test_commands_of_all_interfaces_steer_the_same_tick_in_order(team: Scenario) -> None:
    pointer_state = [StrokeBegin(source="gaze"), StrokePoints(STROKE, source="gaze"), StrokeEnd(source="gaze")]
    gaze = FakeInterface("gaze", *((0.0, command) for command in pointer_state))
    bci = FakeInterface("bci", (0.0, Pick(2, source="bci")))
    session = Session(team, [gaze, bci])
    session.tick()
    assert session.snapshot.state.intent.influenced == 2
    assert session.snapshot.state.motion.path_status == PathStatus.FOLLOWING
    assert [type(command).__name__ for _, command in session.commands] == ["StrokeBegin", "StrokeEnd", "Pick"]


def test_a_view_pushes_through_the_interface_that_takes_the_pointer(team: Scenario) -> None:
    session = Session(team, [FakeInterface("emg"), FakeConsole()])
    session.pointer.push(EmergencyStop())
    session.tick()
    assert session.snapshot.state.intent.stopped
    assert not session.snapshot.state.motion.velocity.any()


def test_a_session_without_such_an_interface_says_so_when_asked_for_it(team: Scenario) -> None:
    with pytest.raises(InputError, match="no input accepts the pointer and keys of the console's pages; inputs: emg"):
        _ = Session(team, [FakeInterface("emg")]).pointer


def test_two_interfaces_of_one_name_are_refused(team: Scenario) -> None:
    with pytest.raises(InputError, match="interface 'emg' is given 2 times"):
        Session(team, [FakeInterface("emg"), FakeInterface("emg")])


def test_an_interface_that_raises_is_set_aside_and_the_run_goes_on(team: Scenario) -> None:
    broken, console = BrokenInterface("emg"), FakeConsole((0.1, Pick(1)))
    session = Session(team, [broken, console])
    for _ in range(40):
        session.tick()
    assert session.ticks == 40
    assert kinds(session).count("channel") == 1
    event = next(event for event in session.snapshot.events if event.kind == "channel")
    assert event.text == "Input 'emg' failed and is off: RuntimeError: cable pulled"
    assert dict(session.snapshot.channels)["emg"].state is ChannelState.LOST
    assert dict(session.snapshot.channels)["console"].state is ChannelState.LIVE
    assert len(broken.contexts) == 2
    assert session.snapshot.state.intent.influenced == 1


def test_the_stroke_of_an_interface_that_fails_is_dropped(team: Scenario) -> None:
    gaze = BrokenInterface("gaze", (0.0, StrokeBegin(source="gaze")), (0.0, StrokePoints(STROKE, source="gaze")))
    session = Session(team, [gaze])
    session.tick()
    assert session.snapshot.state.pointer_state.stroke_source == "gaze"
    session.tick()
    assert session.snapshot.state.pointer_state.stroke_source == ""
    assert len(session.snapshot.state.pointer_state.stroke) == 0


def test_a_channel_whose_health_raises_is_shown_as_lost(team: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    emg = FakeInterface("emg")
    session = Session(team, [emg])

    def broken_health(_: float) -> Any:
        raise OSError("gone")

    monkeypatch.setattr(emg, "health", broken_health)
    for _ in range(30):
        session.tick()
    assert dict(session.snapshot.channels)["emg"][:2] == (ChannelState.LOST, "OSError: gone")


@pytest.mark.parametrize(
    ("kind", "fields"),
    [(Pick, {"robot": "third"}), (SetSpeed, {"factor": "fast"}), (InjectFault, {"channel": "bci", "seconds": "3"})],
)
def test_a_command_that_makes_no_sense_is_refused_and_changes_nothing(
    team: Scenario, kind: type[OperatorCommand], fields: dict[str, Any]
) -> None:
    session = Session(team, [FakeInterface("bci", (0.0, kind(**fields, source="bci")))])
    session.tick()
    assert (session.snapshot.state.intent.influenced, len(session.commands)) == (0, 0)
    refused = next(event for event in session.snapshot.events if event.kind == "refused")
    assert refused.text.startswith(f"Input 'bci' sent {kind.__name__}, which cannot be used:")


def test_a_frozen_clock_stands_while_commands_still_apply(team: Scenario) -> None:
    console = FakeConsole()
    session = Session(team, [console])
    session.tick()
    console.push(Freeze(frozen=True))
    console.push(Pick(2))
    for _ in range(3):
        session.tick()
    assert session.snapshot.frozen
    assert session.snapshot.time == pytest.approx(0.02)
    assert session.snapshot.state.intent.influenced == 2
    console.push(Freeze(frozen=False))
    session.tick()
    assert session.snapshot.time == pytest.approx(0.04)


def test_each_step_advances_a_frozen_clock_by_one_tick(team: Scenario) -> None:
    console = FakeConsole((0.0, Freeze(frozen=True)))
    session = Session(team, [console])
    session.tick()
    console.push(Step())
    console.push(Step())
    for _ in range(5):
        session.tick()
    assert session.ticks == 2


def test_a_step_of_a_running_clock_is_not_saved_up(team: Scenario) -> None:
    console = FakeConsole((0.0, Step()), (0.02, Freeze(frozen=True)))
    session = Session(team, [console])
    for _ in range(5):
        session.tick()
    assert session.ticks == 1


@pytest.mark.parametrize(("factor", "speed"), [(0.25, 0.25), (8.0, 8.0), (0.2, 1.0), (9.0, 1.0), (float("nan"), 1.0)])
def test_the_speed_stays_within_a_quarter_and_eight(team: Scenario, factor: float, speed: float) -> None:
    session = Session(team, [FakeConsole((0.0, SetSpeed(factor)))])
    session.tick()
    assert session.snapshot.speed == speed
    assert ("refused" in kinds(session)) is (speed != factor)


def test_a_reset_starts_the_run_and_its_tally_again(team: Scenario) -> None:
    console = FakeConsole((0.0, Pick(1)))
    close = parse_scenario(team.text.replace("[670, 350]", "[665, 300]"), "close.yaml")
    session = Session(close, [console])
    for _ in range(10):
        session.tick()
    assert np.isfinite(session.snapshot.min_clearance)
    console.push(ResetRun())
    session.tick(advance=False)
    assert session.snapshot.time == 0.0
    assert session.snapshot.state.motion.position.tobytes() == session.setup.start.motion.position.tobytes()
    assert session.snapshot.state.intent.influenced == 0
    assert session.snapshot.min_clearance == float("inf")
    assert session.ticks == 10


def test_fires_are_told_in_the_order_in_which_they_go_out() -> None:
    text = """
version: 1
arena: {size_m: [400, 400]}
robots: {start_m: [[300, 300], [335, 300]]}
fires:
  - {at_m: [100, 100], radius_m: 10, robots_needed: 1}
  - {at_m: [300, 260], radius_m: 20, robots_needed: 1}
"""
    session = Session(parse_scenario(text, "two.yaml"), [])
    while len(session.snapshot.extinguished) < 2 and session.snapshot.time < 60.0:
        session.tick()
    assert session.snapshot.extinguished == (1, 0)
    assert kinds(session).count("extinguished") == 2


def test_events_do_not_pile_up_for_ever(team: Scenario) -> None:
    toggles: list[OperatorCommand] = [Pick(number % 3) for number in range(1, EVENTS_KEPT + 50)]
    session = Session(team, [FakeConsole(*((0.0, command) for command in toggles))])
    session.tick()
    assert len(session.snapshot.events) == EVENTS_KEPT


def test_cursors_are_not_kept_as_commands(team: Scenario) -> None:
    session = Session(team, [FakeInterface("gaze", (0.0, Cursor(np.array([1.0, 2.0]))))])
    session.tick()
    assert not session.commands
    np.testing.assert_array_equal(session.snapshot.state.pointer_state.cursor, [1.0, 2.0])


def test_warnings_of_the_scenario_are_the_first_events(team: Scenario) -> None:
    lonely = parse_scenario(team.text + "links: []", "lonely.yaml")
    assert kinds(Session(lonely, [])) == ["scenario"]


def test_closing_a_session_closes_every_interface_even_after_one_that_fails(team: Scenario) -> None:
    class Stuck(FakeInterface):
        def close(self) -> None:
            raise OSError("stuck")

    last = FakeInterface("bci")
    session = Session(team, [Stuck("emg"), last])
    with pytest.raises(InputError, match="an input did not close: stuck"):
        session.close()
    assert last.closed == 1


def wait_until(condition: Any) -> None:
    end = time.monotonic() + 20.0
    while not condition():
        assert time.monotonic() < end, "nothing happened for 20 s"
        time.sleep(0.005)


@pytest.fixture(name="looped")
def _looped() -> Any:
    """Starts `Session.run` on a thread; ends it after the test."""
    stopping, threads = threading.Event(), list[threading.Thread]()

    def start(session: Session) -> Session:
        threads.append(threading.Thread(target=session.run, args=(stopping,)))
        threads[0].start()
        return session

    yield start
    stopping.set()
    for thread in threads:
        thread.join(timeout=20.0)
        assert not thread.is_alive()


def test_the_loop_runs_until_it_is_stopped_and_computes_the_baseline(team: Scenario, looped: Any) -> None:
    session = looped(Session(team, [FakeConsole()]))
    wait_until(lambda: session.ticks > 5 and session.baseline is not None)
    assert session.baseline.time[0] == pytest.approx(0.02)
    assert session.baseline.loss_area[0] == pytest.approx(np.pi * 20.02**2)
    assert (np.diff(session.baseline.loss_area) >= 0.0).all()


def test_a_slow_clock_still_listens_at_full_rate(team: Scenario, looped: Any) -> None:
    console = FakeConsole((0.0, SetSpeed(0.25)))
    session = looped(Session(team, [console]))
    wait_until(lambda: session.ticks >= 10)
    assert len(console.contexts) > 3 * session.ticks


def test_an_engine_that_fails_stops_the_team_and_tells_the_operator(
    team: Scenario, looped: Any, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    console = FakeConsole()
    session = Session(team, [console])
    for _ in range(50):
        session.tick()
    assert session.snapshot.state.motion.velocity.any()

    def broken_step() -> Any:
        raise ArithmeticError("no number")

    monkeypatch.setattr(session._run, "step", broken_step)  # pyright: ignore[reportPrivateUsage]
    with caplog.at_level(logging.ERROR):
        looped(session)
        wait_until(lambda: session.error is not None and session.snapshot.frozen)
    now = session.snapshot
    assert now.state.intent.stopped
    assert not now.state.motion.velocity.any()
    assert now.events[-1].text == (
        "The engine failed; the team stands and the clock is frozen: ArithmeticError: no number"
    )
    assert "the engine failed at 1.00 s" in caplog.text
    monkeypatch.undo()
    console.push(ResetRun())
    console.push(Freeze(frozen=False))
    wait_until(lambda: session.ticks > 55)


def test_a_baseline_is_not_computed_without_fires_nor_after_the_end(team: Scenario) -> None:
    ended = threading.Event()
    assert compute_baseline(load_scenario("empty").setup(), 10.0, ended) is None
    ended.set()
    assert compute_baseline(team.setup(), 10.0, ended) is None


def crowded(team: Scenario) -> tuple[Session, ConsoleChannel]:
    """A session that has time for one command a tick, with many that wait."""
    console = ConsoleChannel()
    session = Session(team, [console])
    session.command_time = 0.0
    for k in range(300):
        console.push(Pick(k % 2))
    return session, console


def test_what_does_not_fit_into_a_control_period_waits_in_order(team: Scenario) -> None:
    session, _ = crowded(team)
    for _ in range(3):
        session.tick()
    assert [applied.command.robot for applied in session.commands if isinstance(applied.command, Pick)] == [0, 1, 0]
    assert session.ticks == 3


def test_a_stop_waits_for_no_command_and_no_queue(team: Scenario) -> None:
    session, console = crowded(team)
    session.tick()
    console.push(EmergencyStop())
    session.tick()
    assert session.snapshot.state.intent.stopped
    assert not session.snapshot.state.motion.velocity.any()
    assert len(session.commands) == 2


def test_a_stop_is_looked_for_between_two_commands(team: Scenario) -> None:
    console = ConsoleChannel()

    class Stopping(FakeInterface):
        def poll(self, context: OperatorContext) -> list[OperatorCommand]:
            super().poll(context)
            console.push(EmergencyStop())  # the console has been polled already in this tick
            return [Pick(1), Pick(0)]

    session = Session(team, [console, Stopping("late")])
    session.tick()
    assert [type(applied.command) for applied in session.commands] == [EmergencyStop, Pick, Pick]


def test_each_long_hold_up_of_the_loop_is_reported_by_itself_and_moves_nobody(
    team: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, stopping = Session(team, []), threading.Event()
    losses = iter([0.3, 30.4, 0.3, 7.0])

    def wait(due: float, _period: float, _stopping: threading.Event) -> tuple[float, float]:
        lost = next(losses, None)
        if lost is None:
            stopping.set()
        return due, lost or 0.0

    monkeypatch.setattr(session._clock, "wait", wait)  # pyright: ignore[reportPrivateUsage]
    session.run(stopping)
    told = [event.text for event in session.snapshot.events if "held up" in event.text]
    assert told == [
        f"The console was held up for {lost} s: the run stood meanwhile, and goes on from there."
        for lost in ("30.4", "7.0")
    ]
    assert session.ticks == 5, "what was lost is not caught up with"


def test_a_lag_that_rounds_to_nothing_is_not_reported(team: Scenario) -> None:
    session = Session(team, [])
    message = "The computer is busy: the run lags 0.1 s behind real time (1 new delay)."
    for lost, told in ((0.04, []), (0.06, [message])):
        session._clock.lost = lost  # pyright: ignore[reportPrivateUsage]
        session._report_lateness()  # pyright: ignore[reportPrivateUsage]
        session.tick()
        assert [event.text for event in session.snapshot.events if event.kind == "late"] == told


def test_a_lag_before_the_start_delays_nothing_and_is_not_reported(team: Scenario) -> None:
    session = Session(team, [], attended=True, waits=True)
    session._clock.lost = 0.5  # pyright: ignore[reportPrivateUsage]
    session._report_lateness()  # pyright: ignore[reportPrivateUsage]
    session.tick()
    assert not [event for event in session.snapshot.events if event.kind == "late"]


def test_resets_that_were_given_before_a_stop_do_not_release_it(team: Scenario) -> None:
    session, console = crowded(team)
    console.push(EmergencyStop())
    session.tick()
    for command in (AskReset(), ResetEmergencyStop(), Resume(), EmergencyStop()):
        console.push(command)
    session.command_time = math.inf
    session.tick()
    session.tick()
    assert session.snapshot.state.intent.stopped


def test_a_repeated_stop_costs_nothing(team: Scenario) -> None:
    session = Session(team, [device := FakeInterface("bci")])
    for _ in range(1000):
        device.push(EmergencyStop())
    session.tick()
    device.push(EmergencyStop())
    session.tick()
    assert len(session.commands) == 1
    assert kinds(session).count("stop") == 1


def test_a_stop_takes_back_a_reset_that_was_begun(team: Scenario) -> None:
    session = Session(team, [device := FakeInterface("bci")])
    for command in (EmergencyStop(), AskReset(), EmergencyStop(), ResetEmergencyStop()):
        device.push(command)
        session.tick()
    assert session.snapshot.state.intent.stopped


def test_a_scenario_is_read_by_the_worker_while_the_team_goes_on(team: Scenario) -> None:
    worker = Worker()
    session = Session(team, [device := FakeInterface("console")], worker=worker)
    device.push(LoadScenario(text=team.text.replace("name: team", "name: team\ntitle: New one"), name="new.yaml"))
    device.push(LoadScenario(text="title: [", name="bad.yaml"))
    session.tick()
    assert session.scenario is team
    wait_until(lambda: session.tick() or "refused" in kinds(session))
    assert session.scenario.title == "New one"
    assert "Not done: bad.yaml: line 1" in next(
        event.text for event in session.snapshot.events if event.kind == "refused"
    )
    session.close()
    worker.close()
