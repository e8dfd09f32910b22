"""A random scene as a run, and as a scenario file that the console shows."""

import numpy as np
import yaml

from higvf_console.arrays import Floats, floats, ints
from higvf_console.control.gains import Gains
from higvf_console.control.paths import sketch_path
from higvf_console.lab.planar import chain
from higvf_console.lab.scenes import TIME_LIMIT, Scene
from higvf_console.sim.operator import follow
from higvf_console.sim.setup import Setup
from higvf_console.sim.simulation import initial_state
from higvf_console.state import World

_NEEDS = 2  # robots that extinguish a fire
_EDGE = 0.001  # half width by which a file writes an edge of a polygon [m]


def scene_setup(scene: Scene, gains: Gains) -> Setup:
    """The run that a scene starts, its path in force."""
    world = World(
        circles=scene.circles,
        bars=np.vstack([scene.bars, *(_edges(corners, 0.0) for corners in scene.polygons)]),
        walls=floats(
            [
                [1.0, 0.0, scene.arena.x_min],
                [-1.0, 0.0, -scene.arena.x_max],
                [0.0, 1.0, scene.arena.y_min],
                [0.0, -1.0, -scene.arena.y_max],
            ]
        ),
        fire_position=floats(scene.fires[:, :2]),
        fire_growth=floats(scene.fires[:, 3]),
        fire_needs=ints([_NEEDS] * len(scene.fires)),
        formation=scene.robots,
        link_start=ints([]),
        link_to=ints([]),
    )
    start = initial_state(scene.robots, floats(scene.fires[:, 2]), world)
    start = start._replace(intent=start.intent._replace(influenced=scene.influenced))
    path = sketch_path(scene.stroke, gains.path.stroke_smoothing, closed=False)
    return Setup(scene.arena, world, gains, follow(start, path))


def scene_yaml(scene: Scene) -> str:
    """A scenario file of the scene, for `higvf run FILE.yaml`."""
    edges = [row for corners in scene.polygons for row in _edges(corners, _EDGE)]
    content = {
        "version": 1,
        "name": f"{scene.kind}-{scene.seed}",
        "title": f"Scene {scene.kind}:{scene.seed}",
        "description": f"Random scene of the study of deadlocks, kind {scene.kind}, seed {scene.seed}.",
        "arena": {"size_m": list(scene.arena[2:]), "walls": True},
        "robots": {"start_m": scene.robots.tolist()},
        "influenced": scene.influenced + 1,
        "fires": [
            {"at_m": [x, y], "radius_m": radius, "growth_m_per_s": growth, "robots_needed": _NEEDS}
            for x, y, radius, growth in scene.fires.tolist()
        ],
        "obstacles": {
            "circles": [{"at_m": [x, y], "radius_m": radius} for x, y, radius in scene.circles.tolist()],
            "bars": [
                {"from_m": row[:2], "to_m": row[2:4], "half_width_m": row[4]}
                for row in [*scene.bars.tolist(), *(edge.tolist() for edge in edges)]
            ],
        },
        "path": {"sketch": {"points_m": scene.stroke.tolist(), "closed": False}},
        "duration_s": TIME_LIMIT,
    }
    return yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=120)


def _edges(corners: Floats, half_width: float) -> Floats:
    """The edges of a polygon as bars (n, 5)."""
    edges = chain(corners)
    return np.hstack([edges, np.full((len(edges), 1), half_width)])
