"""Polygons and masks of a scenario file stand in the world as chains of bars, and in its recordings for good."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from higvf_console.control.intention.perception import fire_value, interval_room
from higvf_console.core.errors import ScenarioError
from higvf_console.runtime.headless import run_headless
from higvf_console.runtime.recording import Recorder, read_recording, replay
from higvf_console.runtime.session import Session
from higvf_console.scenario.scenario import Scenario, data_folder, load_scenario, parse_scenario
from higvf_console.world.polygons import signed_area, signed_distance

BASE = """
version: 1
arena: {size_m: [1200, 700]}
robots: {start_m: [[700, 300], [670, 350], [730, 350]]}
"""
MASK = "obstacles: {masks: [{image: plan.png, at_m: [100, 200], metres_per_pixel: 2, tolerance_m: 0.5}]}"


def with_plan(folder: Path, mask: str = MASK) -> Scenario:
    """A scenario beside an image with a dark square of 40 m on white, its lower left corner at (120, 240)."""
    picture = np.full((60, 80), 255, np.uint8)
    picture[20:40, 10:30] = 0
    cv2.imwrite(str(folder / "plan.png"), picture)
    (folder / "plan.yaml").write_text(BASE + mask)
    return load_scenario(folder / "plan.yaml")


def test_the_edges_of_a_polygon_follow_the_bars_and_have_no_width() -> None:
    obstacles = """obstacles:
  bars: [{from_m: [100, 100], to_m: [200, 100], half_width_m: 6}]
  polygons: [{points_m: [[300, 100], [300, 200], [400, 100], [300, 100]]}]"""
    setup = parse_scenario(BASE + obstacles, "t.yaml").setup()
    assert setup.world.bars[0].tolist() == [100, 100, 200, 100, 6]
    (chain,) = setup.layout.obstacles.polygons
    assert signed_area(chain) == 5000.0
    for edge, point, following in zip(setup.world.bars[1:], chain, np.roll(chain, -1, axis=0), strict=True):
        assert edge.tolist() == [*point, *following, 0.0]


def test_an_image_is_found_beside_the_scenario_file(tmp_path: Path) -> None:
    (chain,) = with_plan(tmp_path).obstacles.polygons
    assert chain.min(axis=0) == pytest.approx([120, 240], abs=0.5)
    assert chain.max(axis=0) == pytest.approx([160, 280], abs=0.5)


def test_a_shipped_image_is_found_from_anywhere(tmp_path: Path) -> None:
    shipped = (data_folder() / "scenarios" / "building.yaml").read_text()
    (tmp_path / "copy.yaml").write_text(shipped)
    assert len(load_scenario(tmp_path / "copy.yaml").obstacles.polygons) == 9


def test_bright_pixels_are_the_obstacle_when_the_file_says_so(tmp_path: Path) -> None:
    outer, inner = with_plan(tmp_path, MASK.replace("plan.png,", "plan.png, obstacle: bright,")).obstacles.polygons
    assert signed_area(outer) == pytest.approx(160 * 120, rel=0.05)
    assert signed_area(inner) == pytest.approx(-40 * 40, rel=0.05)


def test_a_team_may_start_in_a_free_area_that_a_mask_encloses(tmp_path: Path) -> None:
    def with_robot_at(x: float, y: float) -> Scenario:
        picture = np.zeros((60, 80), np.uint8)
        picture[10:50, 10:70] = 255
        cv2.imwrite(str(tmp_path / "yard.png"), picture)
        text = BASE.replace("[[700, 300], [670, 350], [730, 350]]", f"[[{x}, {y}]]")
        (tmp_path / "yard.yaml").write_text(text + MASK.replace("plan", "yard"))
        return load_scenario(tmp_path / "yard.yaml")

    chains = with_robot_at(180, 260).obstacles.polygons
    assert signed_distance(chains, np.array([[180.0, 260.0]]))[0] == pytest.approx(40.0, abs=0.5)
    with pytest.raises(ScenarioError, match=r"robot 1 at \(110, 260\) is -\d.* m from polygon 1"):
        with_robot_at(110, 260)


@pytest.mark.parametrize(
    ("option", "sentence"),
    [
        (
            "threshold: 0",
            "no dark shape of at least 16 m^2 at threshold 0; change threshold, obstacle or least_area_m2",
        ),
        ("least_area_m2: 1e5", "no dark shape of at least 100000 m^2 at threshold 128"),
    ],
)
def test_a_mask_that_shows_nothing_is_refused(tmp_path: Path, option: str, sentence: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        with_plan(tmp_path, MASK.replace("plan.png,", f"plan.png, {option},"))
    assert sentence in str(caught.value)


def test_a_mask_with_too_many_edges_is_refused_with_the_way_out(tmp_path: Path) -> None:
    picture = np.full((80, 80), 255, np.uint8)
    picture[::4, ::4] = 0
    cv2.imwrite(str(tmp_path / "dots.png"), picture)
    (tmp_path / "dots.yaml").write_text(BASE + MASK.replace("plan.png,", "dots.png, least_area_m2: 0,"))
    with pytest.raises(
        ScenarioError, match=r"its outlines have \d+ edges, at most 500 .*; raise tolerance_m \(0.5 m\)"
    ):
        load_scenario(tmp_path / "dots.yaml")


def test_a_replay_needs_no_image(tmp_path: Path) -> None:
    scenario = with_plan(tmp_path)
    session = Session(scenario, [], recorder=Recorder(tmp_path / "run.jsonl", scenario, 0))
    run_headless(session, 1.0)
    session.close()
    (tmp_path / "plan.png").unlink()
    recording = read_recording(tmp_path / "run.jsonl")
    for kept, traced in zip(recording.scenario.obstacles.polygons, scenario.obstacles.polygons, strict=True):
        assert kept.tobytes() == traced.tobytes()
    assert replay(recording).agrees


def test_a_recording_from_before_there_were_polygons_is_still_read(tmp_path: Path) -> None:
    scenario = load_scenario("empty")
    Recorder(tmp_path / "run.jsonl", scenario, 0).close()
    text = (tmp_path / "run.jsonl").read_text()
    assert ', "polygons": []' in text
    (tmp_path / "old.jsonl").write_text(text.replace(', "polygons": []', ""))
    assert read_recording(tmp_path / "old.jsonl").scenario.name == "empty"


def test_a_polygon_hides_of_a_fire_what_lies_behind_it() -> None:
    turn, radius = np.arange(10) * np.pi / 5, np.tile([36.0, 66.0], 5)
    star = np.array([500.0, 300.0]) + radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    text = f"{BASE}fires: [{{at_m: [300, 300], radius_m: 40}}]\n"
    setup = parse_scenario(f"{text}obstacles: {{polygons: [{{points_m: {star.tolist()}}}]}}", "t.yaml").setup()
    world, reach = setup.world, setup.params.perception.perception_range
    room = interval_room(world.capsules)
    seen: list[float] = []
    for x, y in ((700.0, 300.0), (700.0, 260.0), (680.0, 420.0), (650.0, 150.0), (300.0, 600.0)):
        half = np.arcsin(40 / np.hypot(300 - x, 300 - y))
        to_corners = np.angle((star - [x, y]) @ [1, 1j] / complex(300 - x, 300 - y))  # from the bearing of the fire
        low, high = np.clip([to_corners.min(), to_corners.max()], -half, half)
        seen.append(fire_value(x, y, 300.0, 300.0, 40.0, reach, world.capsules, room))
        assert seen[-1] == pytest.approx(2 * half - (high - low))
    assert seen[0] == 0.0
    assert 0.0 < seen[2] < seen[4]


def test_a_bar_may_be_called_a_capsule() -> None:
    text = "version: 1\narena: {size_m: [900, 700]}\nrobots: {start_m: [[100, 100]]}\nobstacles: "
    part = "[{from_m: [300, 350], to_m: [400, 350], half_width_m: 30}]"
    bars, capsules = (parse_scenario(f"{text}{{{key}: {part}}}", "t.yaml") for key in ("bars", "capsules"))
    assert bars.obstacles.bars.tolist() == capsules.obstacles.bars.tolist() == [[300, 350, 400, 350, 30]]
    assert capsules.warnings == ()
