"""Checks that a run starts safe: nobody overlaps, nobody stands inside an obstacle, the parameters fit the team."""

from collections.abc import Iterator
from itertools import chain
from typing import NamedTuple

import numpy as np

from higvf_console.control.forms import PRINTED
from higvf_console.control.intention.intention import map_radius
from higvf_console.control.parameters import Parameters, controlled
from higvf_console.control.safety.barriers.sampling import check_sampling, least_stand_off
from higvf_console.control.safety.hazards import worst_hazards
from higvf_console.core.arrays import Floats, floats, ints
from higvf_console.core.errors import FilterError, ScenarioError
from higvf_console.core.numbers import metres
from higvf_console.core.state import World
from higvf_console.core.viewport import Arena
from higvf_console.sim.certificates import FORMATION_LIMIT, laplacian
from higvf_console.sim.disturbances import noise_limit
from higvf_console.world.layout import Layout
from higvf_console.world.neighbour_search import kd_tree
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.polygons import obstacles_of, segment_distance, signed_distance

ROUNDING = 1e-6  # [m] by which a start may miss a clearance: a team that is written down may stand right at it
PRINTED_RADIUS = 0.9  # spectral radius to which the printed intention update is scaled
_WEIGHTS = ("decay", "robot_weight", "neighbour_weight", "human_weight")


def check_start(
    position: Floats, fire_radius: Floats, world: World, obstacles: Obstacles, params: Parameters, place: str
) -> None:
    """Refuses starts that already violate a safety barrier.

    Args:
        position: (N, 2) controlled points [m].
        fire_radius: (M,) [m].
        world: fires and walls.
        obstacles: circles, bars and polygons.
        params: those of the bodies.
        place: what to call the section in errors.

    Raises:
        ScenarioError: two robots overlap, or a robot is too near to an obstacle, a fire or a wall, or inside it.
    """
    body, point = params.safety, controlled(params).safety
    _check_pairs(position, point.robot_clearance, _clearance("robot", body.robot_clearance, params), place)
    least = point.obstacle_clearance - ROUNDING
    for what, gap in chain(obstacle_gaps(position, obstacles), other_gaps(position, fire_radius, world)):
        robot = int(np.argmin(gap))
        if gap[robot] < least:
            x, y = position[robot]
            raise ScenarioError(
                f"{place}: robot {robot + 1} at ({x:g}, {y:g}) is {_gap(gap[robot])} from {what}; "
                f"{_clearance('obstacle', body.obstacle_clearance, params)}"
            )


def _clearance(kind: str, clearance: float, params: Parameters) -> str:
    """The clearance of bodies in words, and that of controlled points where it differs."""
    look_ahead, noise = params.robots.look_ahead, params.robots.position_noise
    causes = [f"look_ahead {look_ahead:g} m"] * (look_ahead > 0.0) + [f"position_noise {noise:g} m"] * (noise > 0.0)
    said = f"{kind}_clearance is {clearance:g} m"
    if not causes:
        return said
    enlarged = clearance + (2.0 if kind == "robot" else 1.0) * (look_ahead + noise)
    return f"{said}, enlarged to {enlarged:g} m by {' and '.join(causes)}"


def _gap(gap: float) -> str:
    return f"{gap:.{3 if abs(gap) < 1.0 else 2}f} m"


def _check_pairs(position: Floats, least: float, clearance: str, place: str) -> None:
    pairs = kd_tree(position).query_pairs(least, output_type="ndarray")
    gap = np.linalg.norm(position[pairs[:, 0]] - position[pairs[:, 1]], axis=1)
    if (gap < least - ROUNDING).any():
        nearest = int(np.argmin(gap))
        first, second = pairs[nearest] + 1
        raise ScenarioError(f"{place}: robots {first} and {second} start {_gap(gap[nearest])} apart; {clearance}")


def obstacle_gaps(points: Floats, obstacles: Obstacles) -> Iterator[tuple[str, Floats]]:
    """Every obstacle by name, with the distance (N,) of each point (N, 2) from its surface [m], negative inside."""
    for number, (x, y, radius) in enumerate(obstacles.circles, 1):
        yield f"circle {number}", np.hypot(*(points - (x, y)).T) - radius
    for number, (*ends, half_width) in enumerate(obstacles.bars, 1):
        yield f"bar {number}", segment_distance(points, floats(ends[:2]), floats(ends[2:])) - half_width
    for number, chains in enumerate(obstacles_of(obstacles.polygons), 1):
        yield f"polygon {number}", signed_distance(chains, points)


def other_gaps(position: Floats, fire_radius: Floats, world: World) -> Iterator[tuple[str, Floats]]:
    """Every fire and wall by name, in the same way."""
    for number, (centre, radius) in enumerate(zip(world.fire_position, fire_radius, strict=True), 1):
        yield f"fire {number}", np.hypot(*(position - centre).T) - radius
    for normal_x, normal_y, offset in world.walls:
        yield "the arena's wall", position @ np.array([normal_x, normal_y]) - offset


def wall_gaps(points: Floats, arena: Arena) -> tuple[Floats, ...]:
    """Distance (N,) of each point (N, 2) from the four sides of the arena [m], negative outside."""
    x, y = points.T
    return x - arena.x_min, arena.x_max - x, y - arena.y_min, arena.y_max - y


def buried_fires(fire_position: Floats, fire_radius: Floats, obstacles: Obstacles) -> tuple[str, ...]:
    """A warning for each fire that lies inside an obstacle, where no robot can see it."""
    return tuple(
        f"fire {fire + 1} lies inside {what}; no robot sees it until it has grown out of it"
        for what, gap in obstacle_gaps(fire_position, obstacles)
        for fire in np.flatnonzero(gap <= -fire_radius)
    )


def unavoidable(layout: Layout) -> tuple[str, ...]:
    """A warning for each fire and moving obstacle that comes as fast as robots can yield, or faster."""
    limit = controlled(layout.params).safety.speed_limit
    dangers = [(f"fire {number} grows at", fire.growth) for number, fire in enumerate(layout.fires, 1)]
    circles = len(layout.obstacles.circles)
    for row, course in layout.obstacles.movers():
        name = f"circle {row + 1}" if row < circles else f"bar {row - circles + 1}"
        dangers.append((f"{name} moves at", course.speed))
    return tuple(
        f"{what} {speed:g} m/s; robots, whose speed limit is {limit:.3g} m/s, cannot always keep clear of it"
        for what, speed in dangers
        if speed >= limit
    )


def misfits(layout: Layout, position: Floats) -> tuple[str, ...]:
    """A warning for each number that does not fit the arena, and for each fire that is held from the start.

    Args:
        layout: arena, fires and parameters.
        position: (N, 2) of the robots at the start [m].
    """
    arena, params = layout.arena, layout.params
    side = min(arena.width, arena.height)
    size = f"the arena of {arena.width:g} m x {arena.height:g} m"
    remedy = "give robots.radius_m and speed_limit_m_per_s, from which the defaults follow, or another value"
    lengths = [
        ("safety.robot_clearance", params.safety.robot_clearance, 1.0),
        ("boundaries.reactive_margin", params.boundaries.reactive_margin, 0.5),
        ("path.capture_distance", params.path.capture_distance, 1.0),
    ]
    if layout.fires:
        lengths.append(("fires.stand_off", params.fires.stand_off, 0.5))
    found = [
        f"{name} is {value:g} m, more than {'half of ' * (share < 1.0)}the shorter side of {size}; {remedy}"
        for name, value, share in lengths
        if value > share * side
    ]
    if params.blending.cruise_speed * params.path.progress_timeout > 2.0 * max(arena.width, arena.height):
        found.append(
            f"blending.cruise_speed is {params.blending.cruise_speed:g} m/s: a robot crosses {size} within half of "
            f"path.progress_timeout, {params.path.progress_timeout:g} s; {remedy}"
        )
    reach = layout.fire_radius + params.fires.stand_off
    for number, fire in enumerate(layout.fires, 1):
        near = int((np.hypot(*(position - fire.position).T) <= reach[number - 1]).sum())
        if near >= fire.needs:
            found.append(
                f"fire {number} is held from the start: {near} robots stand within fires.stand_off, "
                f"{params.fires.stand_off:g} m, of its edge"
            )
    return tuple(found)


class Network(NamedTuple):
    """The communication graph at the start: the most links that one robot has, and the connected components."""

    degree: int
    components: int


def start_network(position: Floats, links: tuple[tuple[int, int], ...] | None, activation_distance: float) -> Network:
    """The graph of robots at `position` (N, 2): the given links, or all pairs within `activation_distance` [m]."""
    robots = len(position)
    if links is None and np.isinf(activation_distance):
        return Network(robots - 1, 1)
    edges = (
        ints(links, -1, 2)
        if links is not None
        else kd_tree(position).query_pairs(activation_distance, output_type="ndarray")
    )
    from scipy.sparse import coo_array  # noqa: PLC0415 (slow to import)
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(robots, robots))
    degree = np.bincount(edges.ravel(), minlength=robots).max()
    return Network(int(degree), int(connected_components(graph, directed=False)[0]))


def intention_radius(
    position: Floats, links: tuple[tuple[int, int], ...] | None, influenced: int, params: Parameters
) -> float:
    """Spectral radius of the intention update as printed, on the communication graph at the start.

    Args:
        position: (N, 2) [m].
        links: given links; None = all pairs within the communication range.
        influenced: index of the influenced robot.
        params: weights and communication range.
    """
    robots = len(position)
    activation_distance = min(params.formation.communication_range, 1e9)
    edges = (
        ints(links, -1, 2)
        if links is not None
        else kd_tree(position).query_pairs(activation_distance, output_type="ndarray")
    )
    return map_radius(laplacian(ints(edges, -1, 2), robots), influenced, params.intention)


def convergent(
    params: Parameters, position: Floats, links: tuple[tuple[int, int], ...] | None, influenced: int
) -> tuple[Parameters, tuple[str, ...]]:
    """The parameters with weights for which the printed intention update converges, and a warning if that changed them.

    Weights that suit the corrected update make the printed one diverge: they are scaled to `PRINTED_RADIUS`.
    """
    radius = intention_radius(position, links, influenced, params)
    if params.forms.intention != PRINTED or radius < 1.0:
        return params, ()
    scale = PRINTED_RADIUS / radius
    weights = {name: scale * getattr(params.intention, name) for name in _WEIGHTS}
    warning = (
        f"the intention update as printed has spectral radius {radius:.3g} and diverges: "
        f"its weights are multiplied by {scale:.3g}, which makes it {PRINTED_RADIUS:g}"
    )
    return params._replace(intention=params.intention._replace(**weights)), (warning,)


def check_intention(radius: float, source: str) -> None:
    """Refuses an intention update in its printed form that diverges.

    Raises:
        ScenarioError: the spectral `radius` is not below 1; the message gives it and the way out.
    """
    if radius >= 1.0:
        raise ScenarioError(
            f"{source}: forms.intention: the printed update has spectral radius {radius:.3g} and diverges (limit 1); "
            f"multiply all four weights of parameters.intention by less than {1.0 / radius:.3g}, or take 'corrected'"
        )


def check_robots(params: Parameters, growth: float, source: str) -> None:
    """Refuses unicycles that cannot move, and noise under which clearances are not kept.

    Args:
        params: those of the bodies.
        growth: of the fastest fire, or the speed of the fastest obstacle [m/s].
        source: the scenario file.

    Raises:
        ScenarioError: with the value and the limit.
    """
    robots = params.robots
    if robots.look_ahead > 0.0 and robots.turn_rate_limit == 0.0:
        raise ScenarioError(
            f"{source}: parameters.robots.turn_rate_limit: unicycles that cannot turn cannot follow a velocity; "
            "give more than 0 rad/s, or look_ahead 0 for single integrators"
        )
    limit = noise_limit(controlled(params._replace(robots=robots._replace(position_noise=0.0))), growth)
    if robots.position_noise > limit:
        raise ScenarioError(
            f"{source}: parameters.robots.position_noise: {robots.position_noise:g} m exceeds {limit:.3g} m, up to "
            "which the barriers keep the true clearances; lower it, or raise the clearances, pair_gain, "
            "obstacle_gain or speed_limit"
        )


def robot_warnings(params: Parameters) -> tuple[str, ...]:
    """What the robots' model and noise make of other tunables without need to refuse them."""
    robots, point, warnings = params.robots, controlled(params).safety, list[str]()
    if robots.look_ahead == 0.0 and np.isfinite(robots.turn_rate_limit):
        warnings.append("robots.turn_rate_limit has no effect on single integrators; unicycles have a look_ahead")
    if point.speed_limit < params.safety.speed_limit and point.speed_limit < params.blending.cruise_speed:
        warnings.append(
            f"look_ahead and turn_rate_limit let unicycles go {point.speed_limit:.3g} m/s; "
            f"cruise_speed is {params.blending.cruise_speed:g} m/s"
        )
    if point != params.safety and params.boundaries.repulsive_margin <= point.obstacle_clearance:
        warnings.append(
            f"{_clearance('obstacle', params.safety.obstacle_clearance, params)}; it should stay below "
            f"repulsive_margin ({params.boundaries.repulsive_margin:g} m), where robots circulate"
        )
    return tuple(warnings)


def check_barriers(world: World, fire_radius: Floats, params: Parameters, source: str) -> None:
    """Refuses parameters with which the safety barriers do not hold in discrete time, or no robot could hold at a fire.

    Raises:
        ScenarioError: as `check_rates` and `check_stand_off`.
    """
    check_rates(world, fire_radius, params, source)
    check_stand_off(world, fire_radius, params, source)


def check_rates(world: World, fire_radius: Floats, params: Parameters, source: str) -> None:
    """Refuses parameters with which the safety barriers do not hold in discrete time.

    Raises:
        ScenarioError: the sampling condition is missed; the message gives limit and value.
    """
    try:
        check_sampling(worst_hazards(world, fire_radius), controlled(params).safety)
    except FilterError as error:
        raise ScenarioError(f"{source}: parameters.safety: {error}") from error


def check_stand_off(world: World, fire_radius: Floats, params: Parameters, source: str) -> None:
    """Refuses a stand-off at which no robot could hold at a fire.

    Raises:
        ScenarioError: with the least stand-off of the fire.
    """
    safety, stand_off = controlled(params).safety, params.fires.stand_off
    for number, (radius, growth) in enumerate(zip(fire_radius, world.fire_growth, strict=True), 1):
        least = least_stand_off(float(radius), float(growth), safety)
        if stand_off < least:
            raise ScenarioError(
                f"{source}: parameters.fires.stand_off: {stand_off:g} m is too near to fire {number} "
                f"({radius:g} m, growing {growth:g} m/s), whose barrier holds robots {metres(least)} off; raise it"
            )


def late_stand_off(fire_radius: Floats, fire_growth: Floats, duration: float, params: Parameters) -> tuple[str, ...]:
    """A warning for each fire that grows, within `duration` [s], until no robot can hold at it."""
    grown = fire_radius + fire_growth * duration
    safety = controlled(params).safety
    least = [least_stand_off(float(r), float(g), safety) for r, g in zip(grown, fire_growth, strict=True)]
    return tuple(
        f"fire {number} can grow to {radius:.3g} m, where its barrier holds robots {metres(far)} off; "
        f"stand_off is {params.fires.stand_off:g} m"
        for number, (radius, far) in enumerate(zip(grown, least, strict=True), 1)
        if far > params.fires.stand_off
    )


def check_formation(degree: int, params: Parameters, source: str) -> None:
    """Refuses a formation too stiff for the control period (explicit Euler, `FORMATION_LIMIT`).

    Args:
        degree: the most links that one robot has.
        params: with `formation_rate` and `control_period`.
        source: the scenario file.

    Raises:
        ScenarioError: dt k_form 2 deg_max is not below the limit.
    """
    stiffness = 2.0 * params.safety.control_period * params.formation.formation_rate * degree
    if stiffness >= FORMATION_LIMIT:
        raise ScenarioError(
            f"{source}: parameters.formation: control_period x formation_rate x 2 x {degree} links of one robot is "
            f"{stiffness:.3g} and must stay below {FORMATION_LIMIT:g}; lower formation_rate "
            f"({params.formation.formation_rate:g} 1/s), set communication_range, or give links"
        )
