"""Which dangers shaped a robot's velocity: its active barrier rows by name, with the distance and what must be kept."""

from typing import NamedTuple

import numpy as np

from higvf_console.analysis.explain import Moved
from higvf_console.control.forms import PRINTED
from higvf_console.control.guidance.obstacles import spine_point
from higvf_console.control.parameters import controlled, packed
from higvf_console.control.safety.barriers.arena import wall_constraint
from higvf_console.control.safety.barriers.surroundings import (
    NO_ROBOT,
    Surroundings,
    constraints_of,
    most_constraints,
    survey,
)
from higvf_console.core.arrays import Floats
from higvf_console.sim.disturbances import measured
from higvf_console.sim.fires import growth_rates
from higvf_console.world.polygons import obstacles_of
from higvf_console.world.setup import Setup


class ActiveConstraint(NamedTuple):
    """A barrier row that held a robot back.

    Attributes:
        name: of the danger, e.g. "fire 3".
        distance: to its surface, or to the other robot's controlled point, as the filter measured it [m].
        least: that must be kept [m].
    """

    name: str
    distance: float
    least: float


def active_constraints(robot: int, moved: Moved, setup: Setup) -> list[ActiveConstraint]:
    """The active rows of a robot in one control period, the tightest first: as many as its trace counts.

    Without one the same is done, so that a panel that shows a first moment has loaded all kernels.
    """
    around = _around(moved, setup)
    rows, other = np.empty((most_constraints(around), 3)), np.empty(most_constraints(around), np.int64)
    used = constraints_of(robot, around, rows, other)
    slack = rows[:used, 2] - rows[:used, :2] @ moved.after.velocity[robot]
    neighbours = [int(j) for j in other[:used] if j != NO_ROBOT]
    dangers = _neighbour_dangers(robot, neighbours, around) + _still_dangers(robot, moved, around, setup)
    return [dangers[row] for row in np.argsort(slack, kind="stable")[: moved.trace.active_constraints[robot]]]


def seen_positions(moved: Moved, setup: Setup) -> Floats:
    """Positions (N, 2) [m] as controller and filter measured them."""
    motion = moved.before.motion
    if setup.params.robots.position_noise == 0.0:
        return motion.position
    return measured(motion.position, motion.tick, packed(setup.params)[0].robots)


def _around(moved: Moved, setup: Setup) -> Surroundings:
    """What the filter surveyed."""
    world, params, motion = setup.world, setup.params, moved.before.motion
    rate = growth_rates(motion, moved.trace.crew, world)
    if params.forms.fire_constraint == PRINTED:
        rate = np.zeros(len(rate))
    return survey(
        seen_positions(moved, setup), world.circles, world.bars, world.walls, world.fire_position, motion.fire_radius,
        rate, motion.fire_burning, controlled(params).safety._replace(h_index=params.forms.h_index),
    )  # fmt: skip


def _neighbour_dangers(robot: int, neighbours: list[int], around: Surroundings) -> list[ActiveConstraint]:
    gaps = np.hypot(*(around.position[neighbours] - around.position[robot]).T)
    least = around.safety.robot_clearance
    return [ActiveConstraint(f"robot {j + 1}", float(gap), least) for j, gap in zip(neighbours, gaps, strict=True)]


def _still_dangers(robot: int, moved: Moved, around: Surroundings, setup: Setup) -> list[ActiveConstraint]:
    """Circles, bars, walls and fires that made a row, in the order of `constraints_of`."""
    x, y = around.position[robot].tolist()
    least, world = around.safety.obstacle_clearance, setup.world
    found: list[ActiveConstraint] = []
    for k, (cx, cy, radius) in enumerate(world.circles):
        square = (x - cx) ** 2 + (y - cy) ** 2
        if square < around.circle_activation[k]:
            found.append(ActiveConstraint(part_name(k, setup), square**0.5 - radius, least))
    for k, (ax, ay, bx, by, radius) in enumerate(world.bars):
        near_x, near_y = spine_point(x, y, ax, ay, bx, by)
        square = (x - near_x) ** 2 + (y - near_y) ** 2
        if square < around.capsule_activation[k]:
            found.append(ActiveConstraint(part_name(len(world.circles) + k, setup), square**0.5 - radius, least))
    for nx, ny, offset in world.walls:
        if wall_constraint(x, y, nx, ny, offset, around.safety)[2] < around.safety.speed_limit:
            found.append(ActiveConstraint("wall", float(nx * x + ny * y - offset), least))
    for place, fire in enumerate(np.flatnonzero(moved.before.motion.fire_burning).tolist()):
        fx, fy, radius, _ = around.fires[place]
        square = (x - fx) ** 2 + (y - fy) ** 2
        if square < around.fire_activation_distance[place]:
            found.append(ActiveConstraint(f"fire {fire + 1}", square**0.5 - radius, least))
    return found


def part_name(part: int, setup: Setup) -> str:
    """What people call a part of the world: circle `part`, or bar `part` - P, which may be an edge of a polygon."""
    obstacles = setup.layout.obstacles
    circles, bars = len(obstacles.circles), len(obstacles.bars)
    if part < circles:
        return f"circle {part + 1}"
    if part < circles + bars:
        return f"bar {part - circles + 1}"
    ends = np.cumsum([sum(len(chain) for chain in chains) for chains in obstacles_of(obstacles.polygons)])
    return f"polygon {int(np.searchsorted(ends, part - circles - bars, side='right')) + 1}"
