"""Checks that a run starts safe: nobody overlaps, nobody is inside an obstacle, the barriers hold from the start."""

from collections.abc import Iterator
from itertools import chain

import numpy as np

from higvf_console.control.parameters import Parameters, controlled
from higvf_console.control.safety.barriers.sampling import check_sampling, least_stand_off
from higvf_console.control.safety.hazards import worst_hazards
from higvf_console.core.arrays import Floats, floats
from higvf_console.core.errors import FilterError, ScenarioError
from higvf_console.core.numbers import metres
from higvf_console.core.state import World
from higvf_console.core.viewport import Arena
from higvf_console.sim.disturbances import noise_limit
from higvf_console.world.neighbour_search import kd_tree
from higvf_console.world.obstacles import Obstacles
from higvf_console.world.polygons import obstacles_of, segment_distance, signed_distance

ROUNDING = 1e-6  # [m] by which a start may miss a clearance: a team that is written down may stand right at it


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
    _check_pairs(position, point.robot_clearance, clearance_words("robot", body.robot_clearance, params), place)
    least = point.obstacle_clearance - ROUNDING
    for what, gap in chain(obstacle_gaps(position, obstacles), other_gaps(position, fire_radius, world)):
        robot = int(np.argmin(gap))
        if gap[robot] < least:
            x, y = position[robot]
            raise ScenarioError(
                f"{place}: robot {robot + 1} at ({x:g}, {y:g}) is {_gap(gap[robot])} from {what}; "
                f"{clearance_words('obstacle', body.obstacle_clearance, params)}"
            )


def clearance_words(kind: str, clearance: float, params: Parameters) -> str:
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
