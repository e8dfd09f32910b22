"""All rows of one robot: the row kernels called in turn, skipping whatever is too far away to matter in this tick."""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.forms import PRINTED
from higvf_console.control.guidance.obstacles import spine_point
from higvf_console.control.intention.neighbours import within
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.arena import wall_constraint
from higvf_console.control.safety.barriers.fire import fire_activation_distance, fire_constraint
from higvf_console.control.safety.barriers.linear_constraint import class_k
from higvf_console.control.safety.barriers.obstacle import (
    capsule_constraint,
    circle_constraint,
    obstacle_activation_distance,
)
from higvf_console.control.safety.barriers.robot_pair import pair_constraint, sensing_radius
from higvf_console.core.arrays import Bools, Floats, Ints

NO_ROBOT = -1


class Surroundings(NamedTuple):
    """What can make rows in one tick, with the distance from which on it cannot.

    Attributes:
        position: (N, 2) [m].
        start: (N + 1,) sensed neighbours in compressed rows, see `neighbours`.
        to: (E,) sensed neighbours.
        circles: (P, 3) x, y, radius [m].
        circle_activation: (P,) square of the distance [m^2].
        bars: (Q, 5) ax, ay, bx, by, half width [m].
        capsule_activation: (Q,) square of the distance to the spine [m^2].
        walls: (W, 3) nx, ny, offset [m].
        fires: (B, 4) the burning ones: x, y, radius [m], growth [m/s].
        fire_activation_distance: (B,) square of the distance [m^2].
        safety: clearances, rates, speed limit and control period.
    """

    position: Floats
    start: Ints
    to: Ints
    circles: Floats
    circle_activation: Floats
    bars: Floats
    capsule_activation: Floats
    walls: Floats
    fires: Floats
    fire_activation_distance: Floats
    safety: SafetyParameters


@kernel
def survey(
    position: Floats,
    circles: Floats,
    bars: Floats,
    walls: Floats,
    fire_position: Floats,
    fire_radius: Floats,
    fire_rate: Floats,
    fire_burning: Bools,
    safety: SafetyParameters,
) -> Surroundings:
    """Neighbours and reaches, once a tick; the arguments are those of `safety_filter.filter_velocities`."""
    start, to = within(position, sensing_radius(safety))
    circle_activation = np.empty(circles.shape[0])
    for k in range(circles.shape[0]):
        circle_activation[k] = obstacle_activation_distance(circles[k, 2], safety) ** 2
    capsule_activation = np.empty(bars.shape[0])
    for k in range(bars.shape[0]):
        capsule_activation[k] = obstacle_activation_distance(bars[k, 4], safety) ** 2
    burning = 0
    for k in range(fire_burning.shape[0]):
        burning += fire_burning[k]
    fires = np.empty((burning, 4))
    activation_distance = np.empty(burning)
    burning = 0
    for k in range(fire_position.shape[0]):
        if fire_burning[k]:
            fires[burning, 0], fires[burning, 1] = fire_position[k, 0], fire_position[k, 1]
            fires[burning, 2], fires[burning, 3] = fire_radius[k], fire_rate[k]
            activation_distance[burning] = fire_activation_distance(fire_radius[k], fire_rate[k], safety) ** 2
            burning += 1
    return Surroundings(
        position=position,
        start=start,
        to=to,
        circles=circles,
        circle_activation=circle_activation,
        bars=bars,
        capsule_activation=capsule_activation,
        walls=walls,
        fires=fires,
        fire_activation_distance=activation_distance,
        safety=safety,
    )


@kernel
def most_constraints(around: Surroundings) -> int:
    """How many rows the robot with the most neighbours can have."""
    neighbours = 0
    for i in range(around.start.shape[0] - 1):
        neighbours = max(neighbours, around.start[i + 1] - around.start[i])
    still = around.circles.shape[0] + around.bars.shape[0] + around.walls.shape[0] + around.fires.shape[0]
    return neighbours + still


@kernel
def constraints_of(i: int, around: Surroundings, rows: Floats, other: Ints) -> int:
    """Writes robot i's rows, those of its neighbours first.

    Args:
        i: the robot.
        around: from `survey`.
        rows: (R, 3) receives ax, ay, b; R >= `most_constraints`.
        other: (R,) receives the neighbour that shares the row, or NO_ROBOT.

    Returns:
        How many rows there are.
    """
    x, y = around.position[i, 0], around.position[i, 1]
    count = 0
    for k in range(around.start[i], around.start[i + 1]):
        j = around.to[k]
        rows[count, 0], rows[count, 1], rows[count, 2] = pair_constraint(
            x, y, around.position[j, 0], around.position[j, 1], i < j, around.safety
        )
        other[count] = j
        count += 1
    pairs = count
    count = _obstacle_constraints(x, y, around, rows, count)
    count = _fire_constraints(x, y, around, rows, count)
    for k in range(pairs, count):
        other[k] = NO_ROBOT
    return count


@kernel
def _obstacle_constraints(x: float, y: float, around: Surroundings, rows: Floats, count: int) -> int:
    circles, bars, walls, safety = around.circles, around.bars, around.walls, around.safety
    first = count
    for k in range(circles.shape[0]):
        if (x - circles[k, 0]) ** 2 + (y - circles[k, 1]) ** 2 < around.circle_activation[k]:
            rows[count, 0], rows[count, 1], rows[count, 2] = circle_constraint(
                x, y, circles[k, 0], circles[k, 1], circles[k, 2], safety
            )
            count += 1
    for k in range(bars.shape[0]):
        near_x, near_y = spine_point(x, y, bars[k, 0], bars[k, 1], bars[k, 2], bars[k, 3])
        if (x - near_x) ** 2 + (y - near_y) ** 2 < around.capsule_activation[k]:
            rows[count, 0], rows[count, 1], rows[count, 2] = capsule_constraint(
                x, y, bars[k, 0], bars[k, 1], bars[k, 2], bars[k, 3], bars[k, 4], safety
            )
            count += 1
    if safety.h_index == PRINTED:
        _misindex(x, y, around, rows, first, count)
    for k in range(walls.shape[0]):
        rows[count, 0], rows[count, 1], rows[count, 2] = wall_constraint(
            x, y, walls[k, 0], walls[k, 1], walls[k, 2], safety
        )
        if rows[count, 2] < safety.speed_limit:
            count += 1
    return count


@kernel
def _misindex(x: float, y: float, around: Surroundings, rows: Floats, first: int, count: int) -> None:
    """[27] as printed has h_ij for h_ik: rows of all obstacles get the margin of one, here of the first."""
    margin = around.safety.obstacle_clearance
    if around.circles.shape[0] > 0:
        centre_x, centre_y, radius = around.circles[0, 0], around.circles[0, 1], around.circles[0, 2]
    else:
        ax, ay, bx, by, radius = around.bars[0]
        centre_x, centre_y = spine_point(x, y, ax, ay, bx, by)
    clearance = radius + margin
    square = (x - centre_x) ** 2 + (y - centre_y) ** 2
    bound = 0.5 * around.safety.obstacle_gain * clearance * clearance * class_k(square / (clearance * clearance) - 1.0)
    for k in range(first, count):
        rows[k, 2] = max(bound / math.sqrt(square), -around.safety.speed_limit)


@kernel
def _fire_constraints(x: float, y: float, around: Surroundings, rows: Floats, count: int) -> int:
    fires = around.fires
    for k in range(fires.shape[0]):
        if (x - fires[k, 0]) ** 2 + (y - fires[k, 1]) ** 2 < around.fire_activation_distance[k]:
            rows[count, 0], rows[count, 1], rows[count, 2] = fire_constraint(
                x, y, fires[k, 0], fires[k, 1], fires[k, 2], fires[k, 3], around.safety
            )
            count += 1
    return count
