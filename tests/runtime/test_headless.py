"""Headless runs: the report, and the same bytes from the same seed and inputs, here and in another process."""

import hashlib
import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from higvf_console.channels import channels
from higvf_console.cli.main import main
from higvf_console.core.commands import Cursor, Freeze, OperatorCommand, Pick, StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.interface import InputSpec, Interface
from higvf_console.runtime.headless import EvenSample, run_headless
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, load_scenario
from higvf_console.sim.simulation import advance, roll
from tests.fake_interfaces import BrokenInterface, FakeInterface

STROKE = np.array([[650.0, 250.0], [500.0, 400.0], [400.0, 400.0], [300.0, 300.0]])
KEYS = [
    "scenario", "forms", "seed", "duration_s", "ticks", "ended", "extinguished", "loss_area_m2", "loss_area_total_m2",
    "min_clearance_margin_m", "infeasible_ticks", "deadlock_s", "certificates", "commands", "channels", "attention",
    "calibrations", "tick_ms", "digest",
]  # fmt: skip


def strokes() -> list[tuple[float, OperatorCommand]]:
    commands = [
        Cursor(STROKE[0], source="gaze"),
        StrokeBegin(source="gaze"),
        StrokePoints(STROKE, source="gaze"),
        StrokeEnd(source="gaze"),
        Pick(2, source="bci"),
    ]
    return [(0.5, command) for command in commands]


def report_of(scenario: Scenario, *plan: tuple[float, OperatorCommand], seed: int = 0, duration: float = 3.0) -> Any:
    return run_headless(Session(scenario, [FakeInterface("plan", *plan)], seed), duration)


def test_a_report_has_every_entry_and_is_json(team: Scenario) -> None:
    report = report_of(team, *strokes())
    assert list(report) == KEYS
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert (report["scenario"], report["forms"], report["seed"]) == ("team", "corrected", 0)
    assert (report["duration_s"], report["ticks"]) == (3.0, 150)
    assert report["loss_area_total_m2"] == pytest.approx(sum(report["loss_area_m2"]))
    assert set(report["tick_ms"]) == {"p50", "p99"}


def test_a_sample_of_a_long_run_is_small_and_spread_over_all_of_it() -> None:
    sample = EvenSample(8)
    for value in range(8):
        sample.add(value)
    assert sample.values == list(range(8))
    for value in range(8, 1001):
        sample.add(value)
    assert sample.values == list(range(0, 1001, 128))


def test_a_report_lists_the_commands_that_matter(team: Scenario) -> None:
    assert report_of(team, *strokes())["commands"] == [
        {"time": 0.5, "source": "gaze", "kind": "StrokeBegin"},
        {"time": 0.5, "source": "gaze", "kind": "StrokeEnd"},
        {"time": 0.5, "source": "bci", "kind": "Pick"},
    ]


def test_a_report_tells_how_each_input_is_at_the_end(team: Scenario) -> None:
    report = run_headless(Session(team, [FakeInterface("plan"), BrokenInterface("glove")]), 1.0)
    assert report["channels"] == {
        "plan": {"state": "live", "detail": "at 0.90 s"},
        "glove": {"state": "lost", "detail": "RuntimeError: cable pulled"},
    }


def test_a_headless_run_warns_of_an_input_that_fails(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def opened(spec: InputSpec) -> Interface:
        return BrokenInterface(spec.channel)

    monkeypatch.setattr(channels, "open_interface", opened)
    assert main(["run", "empty", "--headless", "--duration", "0.2", "--input", "glove"]) == 0
    assert "s: Input 'glove' failed and is off: RuntimeError: cable pulled\n" in capsys.readouterr().err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_headless_run_warns_of_a_recording_that_cannot_be_completed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "firefighting", "--headless", "--duration", "0.2", "--record", "/dev/full"]) == 0
    assert "The recording ends here: No space left on device" in capsys.readouterr().err


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_of_a_headless_run_comes_between_two_ticks(team: Scenario) -> None:
    session, tick = Session(team, []), Session.tick

    def interrupted(*, advance: bool = True) -> None:
        signal.raise_signal(signal.SIGINT)
        tick(session, advance=advance)

    session.tick = interrupted  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(KeyboardInterrupt):
        run_headless(session, 1.0)
    assert session.ticks == 1


def test_a_run_ends_when_all_fires_are_out(team: Scenario) -> None:
    report = report_of(team, duration=60.0)
    assert report["extinguished"] == [1]
    assert report["ticks"] < 3000


def test_a_run_without_fires_lasts_for_its_duration() -> None:
    report = report_of(load_scenario("empty"), duration=0.5)
    assert (report["ticks"], report["extinguished"], report["loss_area_m2"]) == (25, [], [])
    assert report["loss_area_total_m2"] == 0.0


def test_the_scenario_says_how_long_a_run_lasts() -> None:
    scenario = load_scenario("empty")
    assert run_headless(Session(scenario, []))["duration_s"] == scenario.duration


def test_a_frozen_clock_does_not_hang_the_run(team: Scenario) -> None:
    report = report_of(team, (1.0, Freeze(frozen=True)))
    assert report["ticks"] == 50
    assert report["digest"] == report_of(team, duration=1.0)["digest"]


def test_the_same_seed_and_inputs_give_the_same_digest_and_others_do_not(team: Scenario) -> None:
    first, again = report_of(team, *strokes()), report_of(team, *strokes())
    assert first["digest"] == again["digest"]
    assert report_of(team, *strokes(), seed=1)["digest"] != first["digest"]
    assert report_of(team)["digest"] != first["digest"]


def test_the_digest_is_the_hash_of_the_trajectory(team: Scenario) -> None:
    setup = team.setup(0)
    state, expected = setup.start, hashlib.sha256()
    for _ in range(25):
        state, _ = advance(state, setup.world, setup.params)
        motion = state.motion
        for part in (motion.position, motion.velocity, motion.fire_radius, motion.fire_burning):
            expected.update(part.tobytes())
        expected.update(np.float64(motion.path_parameter).tobytes())
    assert report_of(team, duration=0.5)["digest"] == expected.hexdigest()


def test_a_headless_run_ends_where_a_roll_ends(team: Scenario) -> None:
    setup = team.setup(0)
    rolled, _ = roll(setup.start, setup.world, setup.params, 100)
    session = Session(team, [])
    run_headless(session, 2.0)
    assert session.snapshot.state.motion.position.tobytes() == rolled.motion.position.tobytes()


def test_another_process_gives_the_same_digest() -> None:
    command = [sys.executable, "-m", "higvf_console", "run", "firefighting", "--headless", "--duration", "4"]
    digests = {json.loads(subprocess.run(command, capture_output=True, check=True).stdout)["digest"] for _ in range(2)}
    assert digests == {report_of(load_scenario("firefighting"), duration=4.0)["digest"]}
