"""Scenarios: strict YAML files that say what a run starts from.

    version: 1                               # these three are required
    arena: {size_m: [1200, 700]}             # or x_min, y_min, x_max, y_max; walls: false opens it
    robots: {start_m: [[700, 300], ...]}     # or count, spacing_m, centre_m; jitter_m, as the seed decides;
        # heading_deg of unicycles: one for all, or a list; radius_m and speed_limit_m_per_s set the scale
    title, description, name: text           # the name defaults to the file's
    briefing: text                           # what the operator reads before the run begins
    links: [[1, 2], ...]                     # else the communication range decides
    formation_m: [[0, 0], ...]               # the shape to keep, else the start positions
    fires: [{at_m: [500, 250], radius_m: 20, growth_m_per_s: 1, robots_needed: 2}, ...]
    obstacles:
      circles: [{at_m: ..., radius_m: 20}]
          # of a moving one also path_m: [[x, y], ...], speed_m_per_s, loop: true; or velocity_m_per_s: [vx, vy]
      bars: [{from_m: ..., to_m: ..., half_width_m: 6}]              # or capsules; likewise, of its middle
      polygons: [{points_m: [[0, 0], [90, 0], [0, 60]]}]               # of any shape that does not cross itself;
          # free_m: [[...], ...], outlines of the free areas in it
      masks: [{image: plan.png, at_m: [0, 0], metres_per_pixel: 2}]    # dark pixels; at_m is its lower left corner;
          # threshold: 128, obstacle: dark | bright, tolerance_m, least_area_m2; beside this file, or shipped
    path: {circle: {at_m: ..., radius_m: 250}, direction: forward}     # or line, ellipse, sketch (points_m, closed,
        # smoothing_m); ending: release | hold | loop, pace, duration_s
    influenced: 1                            # robots and fires count from 1
    strokes: [{name: Round the bar, robot: 1, points_m: [...]}]        # "show me" buttons
    parameters: {safety: {robot_clearance: 25}}                        # groups and names of `control.params`
    forms: corrected                         # or zero-in, printed; or a word for each of `control.forms`
    filter: distributed                      # or centralised
    inputs: {emg: {labels: {fist: pause}}}   # settings by interface; stale, lost, on_lost of any: channel_settings
    teams: {simulated: {latency_s: 0.1}}     # options of --team and --poses, by name
    demo: ["gaze=assets/recordings/barrier-gaze.tsv:frame=screen"]     # what --demo plays, as --input
    ends: {when: all_fires_out}              # or path_finished, never; after_s
    duration_s: 120

A key that is not known, a number out of range or a start that is not safe raises a `ScenarioError` with the file, the
key path, the value and the choices.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path as FilePath

from higvf_console.channels.channel_state import GivenLimits
from higvf_console.channels.channels import unknown_settings
from higvf_console.control.forms import PRINTED, Forms
from higvf_console.control.parameters import Parameters
from higvf_console.core.arguments import instance, whole
from higvf_console.core.arrays import Floats
from higvf_console.core.errors import ScenarioError, closest
from higvf_console.core.quantity import Quantity, shown
from higvf_console.core.reading.document import read_text, read_yaml, without_collections
from higvf_console.core.reading.node import Node
from higvf_console.core.state import NO_PATH, Path, PathEnding, PathKind
from higvf_console.core.viewport import Arena
from higvf_console.operator.path_commands import follow
from higvf_console.scenario.channel_settings import read_inputs
from higvf_console.scenario.ends import Ends, end_warnings, read_ends
from higvf_console.scenario.sections import (
    FilterKind,
    Robots,
    ShownStroke,
    read_arena,
    read_fires,
    read_formation,
    read_forms,
    read_links,
    read_obstacles,
    read_parameters,
    read_path,
    read_robots,
    read_strokes,
)
from higvf_console.scenario.teams import read_teams, unknown_teams
from higvf_console.world.layout import Fire, Layout, Links
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.placement import (
    Network,
    buried_fires,
    check_barriers,
    check_formation,
    check_intention,
    check_robots,
    check_start,
    convergent,
    intention_radius,
    late_stand_off,
    misfits,
    robot_warnings,
    start_network,
    unavoidable,
)
from higvf_console.world.setup import Setup, make_setup

VERSION = 1
KEYS = (
    "version", "name", "title", "description", "briefing", "arena", "robots", "links", "formation_m", "fires",
    "obstacles", "path", "influenced", "strokes", "parameters", "forms", "filter", "inputs", "teams", "demo",
    "ends", "duration_s",
)  # fmt: skip
_SEEDS = 2**53  # whole numbers that a float can tell apart
_DURATION = Quantity("s", 0.001, 1e6, "", "How long a run lasts.")


@dataclass(frozen=True, eq=False)
class Scenario:
    """A scenario file, read and checked.

    Attributes:
        name: word that reports use.
        title: what a person reads.
        description: one or two sentences.
        briefing: what the operator reads before the run begins; empty = the description alone.
        text: the file as it was read, for recordings.
        source: where it was read from.
        arena: what the operator sees.
        walls: whether the arena's four sides are barriers.
        robots: where the team starts.
        links: given communication links as index pairs i < j; None = the communication range decides.
        formation: (N, 2) shape [m]; None = the start positions.
        fires: in the order of their numbers.
        obstacles: circles, bars and polygons.
        path: desired path in force from the start, or NO_PATH.
        influenced: index of the robot that is influenced first.
        strokes: what the "show me" buttons draw.
        params: all tunables.
        filter: which safety filter runs.
        inputs: settings by interface name.
        limits: when silence of an input matters, by its name, where the scenario says.
        teams: options of `--team` and `--poses`, by name.
        demo: inputs of `--demo`, written as on the command line.
        ends: how a run ends.
        duration: how long a run lasts at most [s]; in the console only if it ends at all.
        warnings: what is allowed but probably not meant.
    """

    name: str
    title: str
    description: str
    briefing: str
    text: str
    source: str
    arena: Arena
    walls: bool
    robots: Robots
    links: Links | None
    formation: Floats | None
    fires: tuple[Fire, ...]
    obstacles: Obstacles
    path: Path
    influenced: int
    strokes: tuple[ShownStroke, ...]
    params: Parameters
    filter: FilterKind
    inputs: Mapping[str, Mapping[str, object]]
    limits: Mapping[str, GivenLimits]
    teams: Mapping[str, Mapping[str, str]]
    demo: tuple[str, ...]
    ends: Ends
    duration: float
    warnings: tuple[str, ...]

    def setup(self, seed: int = 0) -> Setup:
        """What a run starts from; the same seed gives the same bytes.

        Raises:
            ArgumentError: the seed is no whole number from 0.
            ScenarioError: the seed's jitter puts a robot where it would violate a safety barrier.
        """
        seed = whole("seed", seed, 0)
        position = self.robots.controlled(seed, self.params.robots.look_ahead)
        setup = make_setup(self._layout(position, seed), position)
        fire_radius = setup.layout.fire_radius
        check_start(position, fire_radius, setup.world, self.obstacles, self.params, f"{self.source}: robots")
        start = setup.start._replace(
            motion=setup.start.motion._replace(heading=self.robots.heading),
            intent=setup.start.intent._replace(influenced=self.influenced),
        )
        return setup._replace(start=follow(start, self.path))

    def with_forms(self, forms: Forms) -> "Scenario":
        """The same scenario with other forms of the equations, and weights with which they converge."""
        params = self.params._replace(forms=instance("forms", forms, Forms))
        params, warnings = convergent(params, self.robots.points, self.links, self.influenced)
        return replace(self, params=params, warnings=self.warnings + warnings)

    @property
    def random(self) -> bool:
        """Whether the seed decides anything: start positions, measurement errors or packet losses."""
        robots = self.params.robots
        return bool(self.robots.jitter > 0 or robots.position_noise > 0 or robots.packet_loss > 0)

    def _layout(self, position: Floats, seed: int) -> Layout:
        return Layout(
            arena=self.arena,
            formation=position if self.formation is None else self.formation,
            walls=self.walls,
            obstacles=self.obstacles,
            fires=self.fires,
            links=self.links,
            params=self.params._replace(robots=self.params.robots._replace(seed=float(seed % _SEEDS))),
        )


def data_folder() -> FilePath:
    """The folder of `scenarios` and `assets`: beside the package in a checkout, inside it in a wheel.

    A checkout comes first, for an editable install may leave a stale copy inside.
    """
    package = FilePath(__file__).parents[1]
    checkout = package.parent
    return checkout if (checkout / "pyproject.toml").is_file() and (checkout / "scenarios").is_dir() else package


def scenario_names() -> tuple[str, ...]:
    """Names of the shipped scenarios."""
    return tuple(sorted(path.stem for path in (data_folder() / "scenarios").glob("*.yaml")))


def load_scenario(name_or_path: str | FilePath) -> Scenario:
    """The shipped scenario of that name, or the one in that file.

    Args:
        name_or_path: a name of `scenario_names`, or a .yaml file.

    Raises:
        ScenarioError: there is no such scenario, or its file cannot be used.
    """
    given = str(instance("name_or_path", name_or_path, str, FilePath))
    file = FilePath(given)
    if file.suffix not in (".yaml", ".yml"):
        names = scenario_names()
        if given not in names:
            raise ScenarioError(
                f"no scenario '{given}'{closest(given, names)}; known scenarios: {', '.join(names)}, or a .yaml file"
            )
        file = data_folder() / "scenarios" / f"{given}.yaml"
    return parse_scenario(read_text(file), str(file))


@without_collections()
def parse_scenario(text: str, source: str, polygons: tuple[Floats, ...] | None = None) -> Scenario:
    """The scenario that a YAML text describes.

    Args:
        text: the YAML.
        source: where it comes from, for errors; its stem names a scenario that does not name itself, images are looked
            for in its folder and then in `data_folder()`.
        polygons: what its polygons and masks came to when they were read before; None = read them.

    Raises:
        ScenarioError: the text cannot be used.
    """
    root = read_yaml(text, source)
    entries = root.section(KEYS, ("version", "arena", "robots"))
    version = entries["version"]
    if str(version.value) != str(VERSION):
        raise version.error(
            f"{shown(version.value)} is not a version that this console reads; known versions: {VERSION}"
        )

    def entry(key: str, default: object) -> Node:
        return entries.get(key, root.entry(key, default))

    arena, walls = read_arena(entries["arena"])
    robots = read_robots(entries["robots"], arena)
    count = len(robots.points)
    params = read_parameters(entry("parameters", {}), robots.scale)
    params = params._replace(forms=read_forms(entry("forms", "corrected")))
    inputs, limits = read_inputs(entry("inputs", {}))
    teams = read_teams(entry("teams", {}))
    links = read_links(entries["links"], count) if "links" in entries else None
    network = start_network(robots.points, links, params.formation.communication_range)
    check_formation(network.degree, params, source)
    fires = read_fires(entry("fires", []), count, robots.scale)
    obstacles = read_obstacles(entry("obstacles", {}), (FilePath(source).parent, data_folder()), polygons)
    check_robots(
        params, max([0.0, *(fire.growth for fire in fires), *(c.speed for _, c in obstacles.movers())]), source
    )
    name = entry("name", FilePath(source).stem).text()
    scenario = Scenario(
        name=name,
        title=entry("title", name).text(),
        description=entry("description", "").text().strip(),
        briefing=entry("briefing", "").text().strip(),
        text=text,
        source=source,
        arena=arena,
        walls=walls,
        robots=robots,
        links=links,
        formation=read_formation(entries["formation_m"], count) if "formation_m" in entries else None,
        fires=fires,
        obstacles=obstacles,
        path=read_path(entries["path"], params.path.stroke_smoothing, params.scale) if "path" in entries else NO_PATH,
        influenced=entry("influenced", 1).integer(1, count, "a robot's number") - 1,
        strokes=read_strokes(entry("strokes", []), count),
        params=params,
        filter=FilterKind(entry("filter", "distributed").choice(tuple(FilterKind))),
        inputs=inputs,
        limits=limits,
        teams=teams,
        demo=tuple(item.text() for item in entry("demo", []).items()),
        ends=read_ends(entries["ends"]) if "ends" in entries else Ends(),
        duration=entry("duration_s", 120.0).number(_DURATION),
        warnings=(
            *root.warnings,
            *_network_warnings(network, links is not None),
            *unknown_settings(inputs),
            *unknown_teams(teams),
            *robot_warnings(params),
        ),
    )
    start = scenario.setup(seed=0)
    fire_radius = start.start.motion.fire_radius
    check_barriers(start.world, fire_radius, params, source)
    if params.forms.intention == PRINTED:
        check_intention(intention_radius(robots.points, links, scenario.influenced, params), source)
    late = late_stand_off(fire_radius, start.world.fire_growth, scenario.duration, params)
    buried = buried_fires(start.world.fire_position, fire_radius, scenario.obstacles)
    warnings = (
        *late,
        *buried,
        *unavoidable(start.layout),
        *misfits(start.layout, robots.points),
        *_end_warnings(scenario),
    )
    return replace(scenario, warnings=(*scenario.warnings, *warnings))


def _end_warnings(scenario: Scenario) -> tuple[str, ...]:
    path = scenario.path
    no_end = path.closed or path.ending == PathEnding.LOOP or path.length == math.inf
    endless = path.kind != PathKind.NONE and no_end and path.duration == math.inf
    return end_warnings(scenario.ends, fires=bool(scenario.fires), endless_path=endless, duration=scenario.duration)


def _network_warnings(network: Network, linked: bool) -> tuple[str, ...]:
    if network.components == 1:
        return ()
    cause = "links" if linked else "communication_range"
    return (f"the team starts in {network.components} groups that cannot communicate; see {cause}",)
