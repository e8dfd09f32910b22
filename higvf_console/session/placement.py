"""Checks that a run starts safe: nobody overlaps, nobody stands inside an obstacle, the gains fit the team."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from higvf_console.arrays import Floats, Ints, ints
from higvf_console.control.barriers.certificate import check_sampling, least_stand_off
from higvf_console.control.gains import Gains
from higvf_console.control.intention import map_radius
from higvf_console.errors import FilterError, ScenarioError
from higvf_console.sim.certificates import FORMATION_LIMIT, laplacian
from higvf_console.state import World


def check_start(position: Floats, fire_radius: Floats, world: World, gains: Gains, place: str) -> None:
    """Refuses start positions (N, 2) that already violate a safety barrier.

    Raises:
        ScenarioError: two robots overlap, or a robot is too near to an obstacle, a fire or a wall.
    """
    _check_pairs(position, gains.safety.robot_clearance, place)
    least = gains.safety.obstacle_clearance
    for what, gap in _gaps(position, fire_radius, world):
        robot = int(np.argmin(gap))
        if gap[robot] < least:
            x, y = position[robot]
            raise ScenarioError(
                f"{place}: robot {robot + 1} at ({x:g}, {y:g}) is {gap[robot]:.2f} m from {what}; "
                f"obstacle_clearance is {least:g} m"
            )


def _check_pairs(position: Floats, least: float, place: str) -> None:
    pairs = KDTree(position).query_pairs(least, output_type="ndarray")
    gap = np.linalg.norm(position[pairs[:, 0]] - position[pairs[:, 1]], axis=1)
    if (gap < least).any():
        nearest = int(np.argmin(gap))
        first, second = pairs[nearest] + 1
        raise ScenarioError(
            f"{place}: robots {first} and {second} start {gap[nearest]:.2f} m apart; robot_clearance is {least:g} m"
        )


def _gaps(position: Floats, fire_radius: Floats, world: World) -> Iterator[tuple[str, Floats]]:
    """Every surface by name, with the distance (N,) of each robot from it [m]."""
    for number, (x, y, radius) in enumerate(world.circles, 1):
        yield f"circle {number}", np.hypot(*(position - (x, y)).T) - radius
    for number, (*ends, half_width) in enumerate(world.bars, 1):
        start, end = np.array(ends[:2]), np.array(ends[2:])
        along = (position - start) @ (end - start) / max(float((end - start) @ (end - start)), 1e-12)
        nearest = start + np.clip(along, 0.0, 1.0)[:, None] * (end - start)
        yield f"bar {number}", np.hypot(*(position - nearest).T) - half_width
    for number, (centre, radius) in enumerate(zip(world.fire_position, fire_radius, strict=True), 1):
        yield f"fire {number}", np.hypot(*(position - centre).T) - radius
    for normal_x, normal_y, offset in world.walls:
        yield "the arena's wall", position @ np.array([normal_x, normal_y]) - offset


def link_table(links: tuple[tuple[int, int], ...], robots: int) -> tuple[Ints, Ints]:
    """Links i < j as the rows of neighbours that `state.World` holds: (link_start, link_to)."""
    both = sorted([*links, *((j, i) for i, j in links)])
    degree = np.bincount([i for i, _ in both], minlength=robots)
    return ints(np.concatenate([[0], np.cumsum(degree)])), ints([j for _, j in both], -1)


class Network(NamedTuple):
    """The communication graph at the start: the most links that one robot has, and the connected components."""

    degree: int
    components: int


def start_network(position: Floats, links: tuple[tuple[int, int], ...] | None, reach: float) -> Network:
    """The graph of robots at `position` (N, 2): the given links, or all pairs within `reach` [m]."""
    robots = len(position)
    if links is None and np.isinf(reach):
        return Network(robots - 1, 1)
    edges = ints(links, -1, 2) if links is not None else KDTree(position).query_pairs(reach, output_type="ndarray")
    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(robots, robots))
    degree = np.bincount(edges.ravel(), minlength=robots).max()
    return Network(int(degree), int(connected_components(graph, directed=False)[0]))


def intention_radius(
    position: Floats, links: tuple[tuple[int, int], ...] | None, influenced: int, gains: Gains
) -> float:
    """Spectral radius of the intention update as printed, on the communication graph at the start.

    Args:
        position: (N, 2) [m].
        links: given links; None = all pairs within the communication range.
        influenced: the robot that feels the human.
        gains: weights and communication range.
    """
    robots = len(position)
    reach = min(gains.formation.communication_range, 1e9)
    edges = ints(links, -1, 2) if links is not None else KDTree(position).query_pairs(reach, output_type="ndarray")
    return map_radius(laplacian(ints(edges, -1, 2), robots), influenced, gains.intention)


def check_intention(radius: float, source: str) -> None:
    """Refuses an intention update in its printed form that diverges.

    Raises:
        ScenarioError: the spectral `radius` is not below 1; the message gives it and the way out.
    """
    if radius >= 1.0:
        raise ScenarioError(
            f"{source}: forms.intention: the printed update has spectral radius {radius:.3g} and diverges from 1 on; "
            f"multiply all four weights of parameters.intention by less than {1.0 / radius:.3g}, or take 'corrected'"
        )


def check_barriers(world: World, fire_radius: Floats, gains: Gains, source: str) -> None:
    """Refuses gains with which the safety barriers do not hold in discrete time, or no robot could hold at a fire.

    Raises:
        ScenarioError: the sampling condition or the least stand-off is missed; the message gives limit and value.
    """
    try:
        check_sampling(world, fire_radius, gains.safety)
    except FilterError as error:
        raise ScenarioError(f"{source}: parameters.safety: {error}") from error
    stand_off = gains.fires.stand_off
    for number, (radius, growth) in enumerate(zip(fire_radius, world.fire_growth, strict=True), 1):
        least = least_stand_off(float(radius), float(growth), gains.safety)
        if stand_off < least:
            raise ScenarioError(
                f"{source}: parameters.fires.stand_off: {stand_off:g} m is too near to fire {number} "
                f"({radius:g} m, growing {growth:g} m/s), whose barrier holds robots {least:.2f} m off; raise it"
            )


def late_stand_off(fire_radius: Floats, fire_growth: Floats, duration: float, gains: Gains) -> tuple[str, ...]:
    """A warning for each fire that grows, within `duration` [s], until no robot can hold at it."""
    grown = fire_radius + fire_growth * duration
    least = [least_stand_off(float(r), float(g), gains.safety) for r, g in zip(grown, fire_growth, strict=True)]
    return tuple(
        f"fire {number} can grow to {radius:.0f} m, where its barrier holds robots {far:.1f} m off; "
        f"stand_off is {gains.fires.stand_off:g} m"
        for number, (radius, far) in enumerate(zip(grown, least, strict=True), 1)
        if far > gains.fires.stand_off
    )


def check_formation(degree: int, gains: Gains, source: str) -> None:
    """Refuses a formation too stiff for the control period (explicit Euler, `FORMATION_LIMIT`).

    Args:
        degree: the most links that one robot has.
        gains: with `formation_rate` and `control_period`.
        source: the scenario file.

    Raises:
        ScenarioError: dt k_form 2 deg_max is not below the limit.
    """
    stiffness = 2.0 * gains.safety.control_period * gains.formation.formation_rate * degree
    if stiffness >= FORMATION_LIMIT:
        raise ScenarioError(
            f"{source}: parameters.formation: control_period x formation_rate x 2 x {degree} links of one robot is "
            f"{stiffness:.3g} and must stay below {FORMATION_LIMIT:g}; lower formation_rate "
            f"({gains.formation.formation_rate:g} 1/s), set communication_range, or give links"
        )
