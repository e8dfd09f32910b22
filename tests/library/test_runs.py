"""Whole runs from Python: the report of the command line, every control period, recorded and replayed."""

import json
from pathlib import Path

import numpy as np
import pytest

import higvf_console as hc
from higvf_console import commands
from higvf_console.cli.main import main
from higvf_console.runtime import compiling
from tests.fake_interfaces import FakeInterface

TEAM = [[700, 300], [670, 350], [730, 350]]


def test_a_run_by_name_is_that_of_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "firefighting", "--headless", "--duration", "0.5"]) == 0
    report = hc.run("firefighting", 0.5)
    assert report["digest"] == json.loads(capsys.readouterr().out)["digest"]


def test_each_control_period_is_seen_in_a_run_and_in_its_replay(tmp_path: Path) -> None:
    seen: list[hc.Tick] = []
    again: list[hc.Tick] = []
    hc.run("firefighting", 0.5, record=tmp_path / "run.jsonl", each=seen.append)
    result = hc.replay(hc.read_recording(str(tmp_path / "run.jsonl")), each=again.append)
    assert result.agrees
    assert [tick.time for tick in seen] == pytest.approx(np.arange(1, 26) * 0.02)
    for ours, theirs in zip(seen, again, strict=True):
        assert ours.state.motion.position.tobytes() == theirs.state.motion.position.tobytes()
        assert ours.trace.terms.tobytes() == theirs.trace.terms.tobytes()


def test_an_error_of_the_callback_ends_the_run_and_closes_the_inputs() -> None:
    device = FakeInterface("plan")

    def fail(_: hc.Tick) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        hc.run("empty", 0.5, interfaces=[device], each=fail)
    assert device.closed


def test_a_device_of_ones_own_steers_a_run() -> None:
    report = hc.run("empty", 0.2, interfaces=[FakeInterface("plan", (0.1, commands.Pick(robot=1)))])
    assert [command["kind"] for command in report["commands"]] == ["Pick"]


def test_a_scenario_of_a_setup_starts_bit_for_bit_from_it_and_is_read_from_its_text(tmp_path: Path) -> None:
    hazards = hc.Hazards().circle((480, 400), 20).capsule((900, 230), (900, 400), 6).fire((500, 250), 20, growth=0.3)
    hazards = hazards.polygon([[100, 100], [200, 100], [150, 180]]).inside((0, 0, 1200, 700))
    params = hc.make_parameters(blending={"cruise_speed": 40.0}, safety={"speed_limit": 70.0})
    setup = hc.make_setup(TEAM, hazards, params, links=[(0, 1), (2, 1)], path=hc.circle_path((600, 350), 200))
    scenario = hc.make_scenario(
        setup, "own", description="Its own.", duration=3.0, inputs={"emg": {"labels": {"fist": "pause"}}}
    )
    start = scenario.setup(0)
    assert start.start.motion.position.tobytes() == setup.start.motion.position.tobytes()
    for one, other in zip(start.world, setup.world, strict=True):
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()
    assert start.params == setup.params
    (tmp_path / "own.yaml").write_text(scenario.text)
    assert hc.load_scenario(tmp_path / "own.yaml").duration == 3.0
    by_hand, _ = hc.roll(setup.start, setup.world, setup.params, 50)
    last: list[hc.Tick] = []
    hc.run(scenario, 1.0, each=last.append)
    assert last[-1].state.motion.position.tobytes() == by_hand.motion.position.tobytes()


def test_an_obstacle_moves_through_a_run_with_its_velocity_and_robots_give_way() -> None:
    hazards = hc.Hazards().circle((300, 0), 15, velocity=(-20, 0)).capsule((0, 400), (40, 400), 6)
    setup = hc.make_setup([[0, 3], [0, 60]], hazards.fire((0, 900), 5))
    _, history = hc.roll(setup.start, setup.world, setup.params, 700)
    place = np.array([300.0, 0.0]) + np.outer(np.arange(1, 701) * 0.02, (-20.0, 0.0))
    gaps = np.linalg.norm(history.position - place[:, None], axis=2) - 15.0 - 12.0
    assert -0.1 < gaps.min() < 20.0
    assert history.clearance.min() > -0.1
    still = hc.make_setup([[0, 3], [0, 60]])
    assert hc.advance(still.start, still.world, still.params)[0].motion.position.tolist() == [[0, 3], [0, 60]]


@pytest.mark.parametrize("robots", [0, 1])
def test_a_team_of_none_or_one_is_advanced_and_its_fires_grow(robots: int) -> None:
    setup = hc.make_setup(TEAM[:robots], hc.Hazards().fire((0, 0), 10))
    state, trace = hc.advance(setup.start, setup.world, setup.params)
    _, history = hc.roll(setup.start, setup.world, setup.params, 10)
    assert state.motion.fire_radius[0] == pytest.approx(10.02)
    assert trace.clearance.shape == (robots,)
    assert history.position.shape == (10, robots, 2)


def test_unsafe_starts_are_refused_with_their_numbers() -> None:
    with pytest.raises(hc.ScenarioError, match=r"setup: positions: robots 1 and 2 start 5.00 m apart"):
        hc.make_setup([[0, 0], [5, 0]])
    with pytest.raises(hc.ScenarioError, match=r"robot 1 at \(0, 0\) is 3.00 m from circle 1"):
        hc.make_setup([[0, 0]], hc.Hazards().circle((10, 0), 7))
    with pytest.raises(hc.ArgumentError, match="fire 1 needs 3 robots; expected at most 1"):
        hc.make_setup([[0, 0]], hc.Hazards().fire((100, 0), 7, robots_needed=3))


def test_what_a_run_cannot_hold_is_refused() -> None:
    with pytest.raises(hc.ArgumentError, match="walls besides those of an arena"):
        hc.make_setup(TEAM, hc.Hazards().wall((1, 0), 0.0))
    with pytest.raises(hc.ArgumentError, match="arena differs"):
        hc.make_setup(TEAM, hc.Hazards().inside((0, 0, 1200, 700)), arena=(0, 0, 900, 700))


def test_fields_of_a_path_have_length_one_and_follow_it() -> None:
    path = hc.line_path((0, 0), direction=-1)
    vectors = hc.guiding_vectors(path, [[0, 0], [5, 300], [7, -4000]])
    assert np.hypot(*vectors.T) == pytest.approx(1.0)
    assert vectors[0].tolist() == [-1.0, 0.0]
    assert vectors[1, 1] < -0.9 < 0.9 < vectors[2, 1]
    setup = hc.make_setup([[0, 0]], path=path)
    assert hc.vector_field([[0, 0]], setup, kind="path") == pytest.approx(np.array([[-60.0, 0.0]]))
    assert hc.vector_field([], setup).shape == (0, 2)


def test_parameters_are_made_by_name() -> None:
    assert hc.make_parameters(safety={"speed_limit": 50}).safety.speed_limit == 50.0
    assert hc.make_parameters("printed").forms.speed == 1.0
    for wrong, line in (
        ({"safty": {}}, "unknown group"), ({"safety": {"speed": 5}}, "unknown key"),
        ({"safety": 5}, "expected Mapping"),
        ({"safety": {"speed_limit": -5}}, "-5 is not a number from"),
        ({"forms": "old"}, "forms: .old. is not one of corr"),
    ):  # fmt: skip
        with pytest.raises(hc.ArgumentError, match=line):
            hc.make_parameters(**wrong)  # pyright: ignore


def test_compilation_is_reported_once_in_the_words_of_the_command_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from higvf_console.control.compilation import progress

    monkeypatch.setattr(progress, "_listeners", [])
    compiling.report_once.cache_clear()
    compiling.announce()
    compiling.announce()
    assert capsys.readouterr().err == ""
    progress.compiling("one kernel")
    progress.compiling("another kernel")
    assert capsys.readouterr().err == f"{compiling.COMPILING}\n"
