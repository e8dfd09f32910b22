"""All linear constraints of one robot: neighbours and hazards that are near enough to matter in this tick."""

from typing import NamedTuple

import numpy as np

from higvf_console.control.intention.neighbours import within
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.linear_constraint import attainable
from higvf_console.control.safety.barriers.robot_pair import pair_constraint, sensing_radius
from higvf_console.control.safety.hazards import (
    GROWTH,
    KIND,
    RADIUS,
    VX,
    VY,
    hazard_activation_distance,
    hazard_constraint,
    hazard_matters,
    hazard_outruns,
    within_distance,
)
from higvf_console.core.arrays import Floats, Ints

NOBODY_ELSE = -1  # no other robot, no hazard
ROBOT, HAZARD = 0, 1  # columns of the cause of a constraint


class Surroundings(NamedTuple):
    """What can constrain robots in one tick, with the distance from which on it cannot.

    Attributes:
        position: (N, 2) [m].
        start: (N + 1,) sensed neighbours in compressed rows, see `neighbours`.
        to: (E,) sensed neighbours.
        hazards: (H, 9) see `control.safety.hazards`.
        activation: (H,) activation distance of each hazard [m]; infinite for a wall.
        safety: clearances, rates, speed limit and control period.
    """

    position: Floats
    start: Ints
    to: Ints
    hazards: Floats
    activation: Floats
    safety: SafetyParameters


@kernel
def survey(position: Floats, hazards: Floats, safety: SafetyParameters) -> Surroundings:
    """Neighbours and activation distances, once a tick; arguments as of `safety_filter.filter_velocities`."""
    start, to = within(position, sensing_radius(safety))
    activation = np.empty(hazards.shape[0])
    for k in range(hazards.shape[0]):
        if k > 0 and _alike(hazards, k, k - 1):  # as the edges of a polygon are
            activation[k] = activation[k - 1]
        else:
            activation[k] = hazard_activation_distance(hazards, k, safety)
    return Surroundings(
        position=position, start=start, to=to, hazards=hazards, activation=activation, safety=safety
    )  # fmt: skip


@kernel
def _alike(hazards: Floats, k: int, other: int) -> bool:
    """Whether two hazards have the same activation distance."""
    return (
        hazards[k, KIND] == hazards[other, KIND]
        and hazards[k, RADIUS] == hazards[other, RADIUS]
        and hazards[k, VX] == hazards[other, VX]
        and hazards[k, VY] == hazards[other, VY]
        and hazards[k, GROWTH] == hazards[other, GROWTH]
    )


@kernel
def most_constraints(around: Surroundings) -> int:
    """How many constraints the robot with the most neighbours can have."""
    neighbours = 0
    for i in range(around.start.shape[0] - 1):
        neighbours = max(neighbours, around.start[i + 1] - around.start[i])
    return neighbours + around.hazards.shape[0]


@kernel
def constraints_of(i: int, around: Surroundings, constraints: Floats, cause: Ints) -> tuple[int, bool]:
    """Writes robot i's constraints, those of its neighbours first.

    Args:
        i: the robot.
        around: from `survey`.
        constraints: (C, 3) receives ax, ay, b; C >= `most_constraints`.
        cause: (C, 2) receives the neighbour that shares the constraint, and the hazard; NOBODY_ELSE for none.

    Returns:
        How many constraints there are; and whether a hazard comes faster than the robot can retreat.
    """
    x, y = around.position[i, 0], around.position[i, 1]
    limit, count, outrun = around.safety.speed_limit, 0, False
    for entry in range(around.start[i], around.start[i + 1]):
        j = around.to[entry]
        ax, ay, b = pair_constraint(x, y, around.position[j, 0], around.position[j, 1], i < j, around.safety)
        constraints[count, 0], constraints[count, 1], constraints[count, 2] = ax, ay, attainable(b, limit)
        cause[count, ROBOT], cause[count, HAZARD] = j, NOBODY_ELSE
        count += 1
    for k in range(around.hazards.shape[0]):
        if not within_distance(x, y, around.hazards, k, around.activation[k]):
            continue
        ax, ay, b = hazard_constraint(x, y, around.hazards, k, around.safety)
        if not hazard_matters(around.hazards, k, b, limit):
            continue
        constraints[count, 0], constraints[count, 1], constraints[count, 2] = ax, ay, attainable(b, limit)
        cause[count, ROBOT], cause[count, HAZARD] = NOBODY_ELSE, k
        outrun = outrun or (b < -limit and hazard_outruns(x, y, around.hazards, k, around.safety))
        count += 1
    return count, outrun
