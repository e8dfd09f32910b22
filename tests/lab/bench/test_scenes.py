"""Random scenes keep their gaps, clearances, paths and pockets, measured by independent distances."""

import itertools
import math

import numpy as np
import pytest
from scipy.spatial import KDTree

from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats
from higvf_console.lab.bench.deadlock import make_scene, scene_named
from higvf_console.lab.bench.geometry import capsule, disc, distances, gap, hull, polygon
from higvf_console.lab.bench.scene_file import scene_setup, scene_yaml
from higvf_console.lab.bench.scenes import END_CLEARANCE, GAPS, TIME_LIMIT, Kind, Scene
from higvf_console.scenario.scenario import parse_scenario
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.placement import check_start

SCENES = [(kind, seed) for kind in Kind for seed in range(6)]
each_scene = pytest.mark.parametrize(("kind", "seed"), SCENES)


def outlines(scene: Scene) -> list[Floats]:
    """Every obstacle as dense points (n, 2) of its surface, the fires as they are at the time limit."""
    rounds = [*scene.circles, *(np.array([x, y, r + TIME_LIMIT * growth]) for x, y, r, growth in scene.fires)]
    turn = np.linspace(0.0, 2.0 * math.pi, 129)[:, None]
    circle = np.hstack([np.cos(turn), np.sin(turn)])
    share = np.linspace(0.0, 1.0, 120)[:, None]
    found = [centre + radius * circle for *centre, radius in rounds]
    for ax, ay, bx, by, half_width in scene.bars:
        spine = np.array([ax, ay]) + share * np.array([bx - ax, by - ay])
        found.append((spine[:, None] + half_width * circle[::8]).reshape(-1, 2))
    for corners in scene.polygons:
        sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
        found.append(np.concatenate([start + share * (end - start) for start, end in sides]))
    return found


def least_distance(one: Floats, other: Floats) -> float:
    return float(KDTree(one).query(other)[0].min())


def test_distances_agree_with_those_of_dense_outlines() -> None:
    star = polygon(np.array([[0.0, 0.0], [40.0, 0.0], [20.0, 10.0], [20.0, 40.0]]))
    assert gap(disc(0.0, 60.0, 10.0), disc(0.0, 100.0, 20.0)) == pytest.approx(10.0)
    assert gap(capsule(60.0, -20.0, 60.0, 80.0, 5.0), star) == pytest.approx(15.0)
    assert gap(disc(30.0, 30.0, 3.0), star) == pytest.approx(7.0)
    assert gap(capsule(-10.0, 20.0, 60.0, 20.0, 1.0), star) <= 0.0
    assert distances(np.array([[10.0, 2.0], [30.0, 30.0]]), star) == pytest.approx([-2.0, 10.0])
    assert distances(np.array([[24.0, 12.0]]), hull(star))[0] < 0.0


@each_scene
def test_the_same_seed_gives_the_same_scene(kind: Kind, seed: int) -> None:
    assert scene_yaml(make_scene(kind, seed)) == scene_yaml(make_scene(kind, seed))
    assert scene_yaml(make_scene(kind, seed)) != scene_yaml(make_scene(kind, seed + 100))


@pytest.mark.parametrize("kind", [Kind.SPACED, Kind.CROWDED])
@pytest.mark.parametrize("seed", range(6))
def test_scattered_obstacles_keep_their_gap_until_the_time_limit(kind: Kind, seed: int) -> None:
    scene = make_scene(kind, seed)
    found = outlines(scene)
    assert 5 <= len(found) - len(scene.fires) <= 25
    assert 1 <= len(scene.fires) <= 4
    for one, other in itertools.combinations(found, 2):
        assert least_distance(one, other) >= GAPS[kind] - 1e-9
    everything = np.concatenate(found)
    low, high = np.array(scene.arena[:2]), np.array(scene.arena[2:])
    assert (everything - low).min() >= GAPS[kind] - 1e-9
    assert (high - everything).min() >= GAPS[kind] - 1e-9


@each_scene
def test_a_team_starts_safe_and_spaced(kind: Kind, seed: int) -> None:
    scene, params = make_scene(kind, seed), Parameters()
    setup = scene_setup(scene, params)
    assert 3 <= len(scene.robots) <= 10
    obstacles = Obstacles(scene.circles, scene.bars, scene.polygons)
    check_start(scene.robots, setup.start.motion.fire_radius, setup.world, obstacles, params, "the scene")
    assert min(math.dist(a, b) for a, b in itertools.combinations(scene.robots, 2)) >= 40.0


@each_scene
def test_a_path_crosses_an_obstacle_and_ends_free(kind: Kind, seed: int) -> None:
    scene = make_scene(kind, seed)
    still = [disc(*row) for row in scene.circles] + [capsule(*row) for row in scene.bars]
    still += [polygon(corners) for corners in scene.polygons]
    fires = [disc(x, y, radius + TIME_LIMIT * growth) for x, y, radius, growth in scene.fires]
    path = np.concatenate([np.linspace(a, b, 20) for a, b in itertools.pairwise(scene.stroke)])
    assert min(distances(path, shape).min() for shape in still) < 0.0
    assert min(distances(scene.stroke[-1:], hull(shape))[0] for shape in [*still, *fires]) >= END_CLEARANCE
    assert math.dist(scene.stroke[0], scene.robots[scene.influenced]) < 1.0


def test_pockets_block_the_straight_way_and_some_contain_the_team() -> None:
    inside = 0
    for seed in range(30):
        scene = make_scene(Kind.POCKETS, seed)
        leg, floor = scene.bars[:2] if len(scene.bars) > 1 else (np.zeros(5), np.ones(5))
        in_bars = leg[2:4].tolist() == floor[:2].tolist()
        walls = [capsule(*row) for row in scene.bars[:3]] if in_bars else [polygon(scene.polygons[0])]
        straight = np.linspace(scene.robots.mean(axis=0), scene.stroke[-1], 400)
        assert min(distances(straight, wall).min() for wall in walls) < 0.0
        pocket = polygon(np.concatenate([wall.edges.reshape(-1, 2) for wall in walls]))
        inside += bool((distances(scene.robots, hull(pocket)) < 0.0).all())
    assert 5 <= inside <= 15


@each_scene
def test_a_saved_scene_is_the_same_run(kind: Kind, seed: int) -> None:
    scene = make_scene(kind, seed)
    setup, saved = scene_setup(scene, Parameters()), parse_scenario(scene_yaml(scene), "scene.yaml").setup()
    assert saved.start.motion.position.tobytes() == setup.start.motion.position.tobytes()
    assert saved.start.intent.path.spline.tobytes() == setup.start.intent.path.spline.tobytes()
    assert saved.start.intent.influenced == setup.start.intent.influenced
    assert saved.world.circles.tobytes() == setup.world.circles.tobytes()
    assert saved.world.fire_growth.tobytes() == setup.world.fire_growth.tobytes()
    assert saved.world.bars[:, :4].tobytes() == setup.world.bars[:, :4].tobytes()


def test_a_scene_is_named_by_kind_and_seed() -> None:
    assert scene_named("crowded:17").seed == 17
