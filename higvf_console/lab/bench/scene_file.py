"""Converts a random scene to a run and to a scenario file."""

from higvf_console.control.guidance.paths import sketch_path
from higvf_console.control.parameters import Parameters
from higvf_console.core.arrays import Floats, floats, ints
from higvf_console.core.viewport import Arena
from higvf_console.lab.bench.scenes import TIME_LIMIT, Scene
from higvf_console.operator.path_commands import follow
from higvf_console.scenario.reading import yaml_text
from higvf_console.sim.setup import Setup
from higvf_console.sim.simulation import initial_state
from higvf_console.world.build import edges, make_world

_NEEDS = 2  # robots needed to extinguish a fire
_EDGE = 0.001  # half width of the bar that represents an edge of a polygon [m]


def scene_setup(scene: Scene, params: Parameters) -> Setup:
    """The start of a run of the scene, with its path active."""
    world = make_world(
        circles=scene.circles,
        bars=scene.bars,
        walls=_walls(scene.arena),
        fire_position=scene.fires[:, :2],
        fire_growth=scene.fires[:, 3],
        fire_needs=ints([_NEEDS] * len(scene.fires)),
        formation=scene.robots,
        clearance=params.safety.obstacle_clearance,
        polygons=scene.polygons,
    )
    start = initial_state(scene.robots, floats(scene.fires[:, 2]), world)
    start = start._replace(intent=start.intent._replace(influenced=scene.influenced))
    path = sketch_path(scene.stroke, params.path.stroke_smoothing, closed=False)
    return Setup(scene.arena, world, params, follow(start, path))


def scene_yaml(scene: Scene) -> str:
    """The text of a scenario file of the scene, for `higvf run FILE.yaml`."""
    sides = [edge[:4] for corners in scene.polygons for edge in edges(corners).tolist()]
    bars = [*scene.bars.tolist(), *([*side, _EDGE] for side in sides)]
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
            "bars": [{"from_m": bar[:2], "to_m": bar[2:4], "half_width_m": bar[4]} for bar in bars],
        },
        "path": {"sketch": {"points_m": scene.stroke.tolist(), "closed": False}},
        "duration_s": TIME_LIMIT,
    }
    return yaml_text(content)


def _walls(arena: Arena) -> Floats:
    """The arena's four sides as walls (4, 3)."""
    low_x, low_y, high_x, high_y = arena
    return floats([[1.0, 0.0, low_x], [-1.0, 0.0, -high_x], [0.0, 1.0, low_y], [0.0, -1.0, -high_y]])
