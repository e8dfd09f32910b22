"""A random scene as a run, and as a scenario file that the console shows."""

from higvf_console.control.guidance.paths import sketch_path
from higvf_console.control.parameters import Parameters
from higvf_console.lab.bench.scenes import TIME_LIMIT, Scene
from higvf_console.operator.path_commands import follow
from higvf_console.scenario.reading import yaml_text
from higvf_console.world.build import edges
from higvf_console.world.layout import Fire, Layout
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.setup import Setup, make_setup

_NEEDS = 2  # robots that extinguish a fire
_EDGE = 0.001  # half width by which a file writes an edge of a polygon [m]


def scene_setup(scene: Scene, params: Parameters) -> Setup:
    """The run that a scene starts, its path in force."""
    layout = Layout(
        arena=scene.arena,
        formation=scene.robots,
        obstacles=Obstacles(scene.circles, scene.bars, scene.polygons),
        fires=tuple(Fire((x, y), radius, growth, _NEEDS) for x, y, radius, growth in scene.fires.tolist()),
        params=params,
    )
    setup = make_setup(layout, scene.robots)
    start = setup.start._replace(intent=setup.start.intent._replace(influenced=scene.influenced))
    path = sketch_path(scene.stroke, params.path.stroke_smoothing, closed=False)
    return setup._replace(start=follow(start, path))


def scene_yaml(scene: Scene) -> str:
    """A scenario file of the scene, for `higvf run FILE.yaml`."""
    sides = [row[:4] for corners in scene.polygons for row in edges(corners).tolist()]
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
            "bars": [{"from_m": row[:2], "to_m": row[2:4], "half_width_m": row[4]} for row in bars],
        },
        "path": {"sketch": {"points_m": scene.stroke.tolist(), "closed": False}},
        "duration_s": TIME_LIMIT,
    }
    return yaml_text(content)
