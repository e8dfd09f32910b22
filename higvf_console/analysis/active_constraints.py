"""Which hazards shaped a robot's velocity: its active constraints by name, with the distance and what must be kept."""

from typing import NamedTuple

import numpy as np

from higvf_console.analysis.explain import Moved
from higvf_console.control.parameters import filter_parameters, packed
from higvf_console.control.safety.barriers.surroundings import (
    NOBODY_ELSE,
    Surroundings,
    constraints_of,
    most_constraints,
    survey,
)
from higvf_console.control.safety.hazards import hazard_gap, hazard_word
from higvf_console.sim.disturbances import seen_positions
from higvf_console.sim.guard import guarded
from higvf_console.sim.simulation import hazards_now
from higvf_console.world.polygons import obstacles_of
from higvf_console.world.setup import Setup


class ActiveConstraint(NamedTuple):
    """A constraint that held a robot back.

    Attributes:
        name: of the hazard, e.g. "fire 3".
        distance: to its surface, or to the other robot's controlled point, as the filter measured it [m].
        least: that must be kept [m].
    """

    name: str
    distance: float
    least: float


def active_constraints(robot: int, moved: Moved, setup: Setup) -> list[ActiveConstraint]:
    """The active constraints of a robot in one control period, the tightest first: as many as its trace counts.

    Without one the same is done, so that a panel that shows a first moment has loaded all kernels. A robot of a team
    that stands while others drive is held back by that alone, and has none.
    """
    around = _around(moved, setup)
    most = most_constraints(around)
    constraints, cause = np.empty((most, 3)), np.empty((most, 2), np.int64)
    used, _ = constraints_of(robot, around, constraints, cause)
    slack = constraints[:used, 2] - constraints[:used, :2] @ moved.after.velocity[robot]
    tightest = np.argsort(slack, kind="stable")[: moved.trace.active_constraints[robot]]
    if robot in moved.guard.standing:
        return []
    pairs = [(int(cause[k, 0]), int(cause[k, 1])) for k in tightest]
    return [_named(robot, other, hazard, around, moved, setup) for other, hazard in pairs]


def _around(moved: Moved, setup: Setup) -> Surroundings:
    """What the filter surveyed."""
    params, motion, budget = setup.params, moved.before.motion, moved.guard.budget
    hazards = hazards_now(motion, moved.trace.crew, guarded(setup.world, moved.guard), packed(params, budget))
    return survey(seen_positions(motion, params), hazards, filter_parameters(params, budget))


def _named(robot: int, other: int, hazard: int, around: Surroundings, moved: Moved, setup: Setup) -> ActiveConstraint:
    """The constraint between a robot and another one, or a hazard."""
    x, y = around.position[robot].tolist()
    burning = moved.before.motion.fire_burning
    if other != NOBODY_ELSE:
        gap = float(np.hypot(*(around.position[other] - around.position[robot])))
        return ActiveConstraint(f"robot {other + 1}", gap, around.safety.robot_clearance)
    word, distance = hazard_word(around.hazards[hazard]), hazard_gap(x, y, around.hazards[hazard])
    if word == "fire":
        place = hazard - len(around.hazards) + int(burning.sum())
        name = f"fire {int(np.flatnonzero(burning)[place]) + 1}"
    elif 0 <= (row := hazard - len(setup.world.capsules)) < len(moved.guard.standing):
        name = f"robot {int(moved.guard.standing[row]) + 1}, which stands"
    else:
        name = word if word == "wall" else part_name(hazard, setup)
    return ActiveConstraint(name, distance, around.safety.obstacle_clearance)


def part_name(part: int, setup: Setup) -> str:
    """What people call a part of the world: a circle, a bar, or a polygon of which it is an edge."""
    obstacles = setup.layout.obstacles
    circles, bars = len(obstacles.circles), len(obstacles.bars)
    if part < circles:
        return f"circle {part + 1}"
    if part < circles + bars:
        return f"bar {part - circles + 1}"
    ends = np.cumsum([sum(len(chain) for chain in chains) for chains in obstacles_of(obstacles.polygons)])
    return f"polygon {int(np.searchsorted(ends, part - circles - bars, side='right')) + 1}"
