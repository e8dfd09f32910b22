"""The e-pucks of Enki: driven along drawn paths with a bad link, stopped when a part is killed."""

import math
import os
import random
from pathlib import Path

import pytest

from higvf_console.core.errors import HigvfError
from higvf_console.lab.team.driving import Conditions, run
from higvf_console.lab.team.enki import NO_ENKI, Enki, has_enki, world_of
from higvf_console.lab.team.enki_plant import Faults, Link
from higvf_console.lab.team.kills import BOUND, kill
from higvf_console.lab.team.scenes import scenes
from higvf_console.lab.team.suite import Figures, plain, table
from higvf_console.runtime.recording import read_recording, replay
from higvf_console.scenario.scenario import parse_scenario


@pytest.fixture(scope="module", autouse=True)
def enki() -> None:
    if not has_enki():
        (pytest.fail if os.environ.get("HIGVF_REQUIRE_BROWSER") == "1" else pytest.skip)(NO_ENKI)


def test_what_is_sent_arrives_later_or_is_lost_by_its_seed() -> None:
    link, faults = Link(random.Random(0)), Faults(latency_s=0.1, loss=0.5)
    for number in range(100):
        link.send({"n": number}, 0.0, faults)
    assert link.arrived(0.05) == []
    arrived = [message["n"] for message in link.arrived(0.1)]
    assert 30 < len(arrived) < 70
    assert arrived == sorted(arrived)


def test_a_path_is_followed_on_a_bad_link_without_a_contact_and_replays_without_the_plant(tmp_path: Path) -> None:
    gate = next(scene for scene in scenes() if scene.name == "gate")._replace(limit=60.0)
    file = tmp_path / "gate.jsonl"
    outcome = run(gate, Conditions(latency_s=0.15, noise_m=0.005, loss=0.1), record=file)
    assert outcome.arrived
    assert outcome.path_error < 0.03
    assert (outcome.judged.contacts, outcome.infeasible) == (0, 0)
    again = replay(read_recording(file))
    assert again.agrees
    assert again.digest == outcome.digest


def test_the_judge_sees_a_contact_that_nobody_prevents() -> None:
    world = {"width": 1.0, "height": 1.0, "robots": [[0.3, 0.5, 0.0], [0.5, 0.5, math.pi]]}
    with Enki(world, "lockstep") as plant:
        plant.ask({"now": 0.0, "commands": []})
        ahead = [{"robot": k, "n": 1, "v": 0.1, "w": 0.0, "valid_s": 2.0} for k in (1, 2)]
        plant.ask({"now": 0.02, "commands": ahead})
        plant.ask({"now": 1.5, "commands": []})
        assert plant.judgement().contacts == 1


def test_a_robot_stands_when_its_command_has_expired_unless_it_has_no_watchdog() -> None:
    world = {"width": 1.0, "height": 1.0, "robots": [[0.5, 0.5, 0.0]]}
    ahead = [{"robot": 1, "n": 1, "v": 0.05, "w": 0.0, "valid_s": 0.3}]
    for watchdog in (True, False):
        with Enki(world, "lockstep", watchdog=watchdog) as plant:
            plant.ask({"now": 0.0, "commands": ahead})
            plant.ask({"now": 1.0, "commands": []})
            stood = plant.judgement().stood_since_s
        assert stood == pytest.approx(0.32, abs=0.011) if watchdog else stood is None


@pytest.mark.parametrize("kind", ["console", "robot"])
def test_every_wheel_stands_when_a_part_is_killed_and_none_moves_again(kind: str) -> None:
    slalom = next(scene for scene in scenes() if scene.name == "slalom")
    found = kill(kind, slalom, random.Random(3))
    assert math.isfinite(found.stood_after)
    assert not found.moved_again
    assert found.contacts == 0
    if kind == "robot":
        assert "The team is disarmed: the link to robot 3 is broken." in found.told
        assert not any("drives on" in text for text in found.told)
    shown = plain(Figures([], [found]))
    assert shown["kept"] is (found.stood_after < BOUND)
    assert kind in table(Figures([], [found]))


def test_a_world_that_enki_cannot_have_is_refused() -> None:
    text = (
        "version: 1\narena: {size_m: [3, 2]}\nrobots: {radius_m: 0.037, speed_limit_m_per_s: 0.1, start_m: [[1, 1]]}\n"
    )
    bars = "obstacles: {bars: [{from_m: [2, 0.5], to_m: [2, 1.5], half_width_m: 0.05}]}\n"
    scenario = parse_scenario(text + bars, "bars.yaml")
    with pytest.raises(HigvfError, match="obstacles that are circles"):
        world_of(scenario, scenario.setup())
