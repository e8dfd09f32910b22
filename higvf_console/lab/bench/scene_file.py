"""Converts a random scene to a run and to a scenario file."""

from higvf_console.control.guidance.paths import sketch_path
from higvf_console.control.parameters import Parameters
from higvf_console.core.reading.document import yaml_text
from higvf_console.lab.bench.scenes import TIME_LIMIT, Scene
from higvf_console.operator.path_commands import follow
from higvf_console.world.build import edges
from higvf_console.world.layout import Fire, Layout
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.setup import Setup, make_setup

_NEEDS = 2  # robots needed to extinguish a fire
_EDGE = 0.001  # half width of the bar that represents an edge of a polygon [m]


def scene_setup(scene: Scene, params: Parameters) -> Setup:
    """The start of a run of the scene, with its path active."""
    layout = Layout(
        arena=scene.arena,
        formation=scene.robots,
        obstacles=Obstacles(scene.circles, scene.bars, scene.polygons),
        fires=tuple(Fire((x, y), radius, growth, _NEEDS) for x, y, radius, growth in scene.fires.tolist()),
        params=params,
    )
    setup = make_setup(layout, scene.robots)
    start = setup.start._replace(intent=setup.start.intent._replace(influenced=scene.influenced))
    path = sketch_path(scene.stroke, params.path.stroke_smoothing, closed=False, scale=scene.scale)
    return setup._replace(start=follow(start, path))


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
