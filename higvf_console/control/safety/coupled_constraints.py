"""The constraints of the whole team as one list that holds for many ticks, so that a solver keeps its structure.

A Verlet list: everything that is near enough to matter, and a skin more. It holds while no robot has moved by half the
skin, and no hazard's displacement plus growth of its activation distance comes to that; only numbers change meanwhile.
"""

import numpy as np

from higvf_console.control.intention.neighbours import within
from higvf_console.control.kernel import kernel
from higvf_console.control.safety.barriers.linear_constraint import attainable
from higvf_console.control.safety.barriers.robot_pair import pair_constraint, sensing_radius
from higvf_console.control.safety.barriers.surroundings import Surroundings
from higvf_console.control.safety.hazards import hazard_constraint, hazard_outruns, within_distance
from higvf_console.control.safety.nearest_point import Constraints, empty_constraints
from higvf_console.core.arrays import Bools, Ints

_PAIR, _HAZARD = 0, 1


@kernel
def constraint_list(around: Surroundings, skin: float) -> Ints:
    """Every constraint that can matter before something has moved half the skin.

    Args:
        around: from `barriers.surroundings.survey`.
        skin: [m].

    Returns:
        (C, 3) kind, robot, and index of the other robot or of the hazard; for `listed_constraints`.
    """
    position = around.position
    start, to = within(position, sensing_radius(around.safety) + skin)
    listing = np.empty((to.shape[0] + position.shape[0] * around.hazards.shape[0], 3), np.int64)
    used = 0
    for i in range(position.shape[0]):
        for entry in range(start[i], start[i + 1]):
            if to[entry] > i:
                used = _listed(listing, used, _PAIR, i, to[entry])
        for k in range(around.hazards.shape[0]):
            if within_distance(position[i, 0], position[i, 1], around.hazards, k, around.activation[k] + skin):
                used = _listed(listing, used, _HAZARD, i, k)
    return listing[:used].copy()


@kernel
def listed_constraints(listing: Ints, around: Surroundings) -> tuple[Constraints, Bools]:
    """The coupled constraints of a list as they are now: a.u_i <= b, and a.(u_i - u_j) <= 2 b for pairs, [22].

    And (N,) to which robots a hazard comes faster than they can retreat.
    """
    constraints = empty_constraints(around.position.shape[0], listing.shape[0])
    position, safety, limit = around.position, around.safety, around.safety.speed_limit
    outrun = np.zeros(position.shape[0], np.bool_)
    for r in range(listing.shape[0]):
        kind, i, k = listing[r, 0], listing[r, 1], listing[r, 2]
        x, y = position[i, 0], position[i, 1]
        constraints.ends[r, 0] = i
        if kind == _PAIR:
            constraints.ends[r, 1] = k
            ax, ay, b = pair_constraint(x, y, position[k, 0], position[k, 1], True, safety)
            bound = 2.0 * attainable(b, limit)
        else:
            ax, ay, b = hazard_constraint(x, y, around.hazards, k, safety)
            bound = attainable(b, limit)
            outrun[i] = outrun[i] or (b < -limit and hazard_outruns(x, y, around.hazards, k, safety))
        constraints.linear[r, 0], constraints.linear[r, 1], constraints.linear[r, 2] = ax, ay, bound
    return constraints, outrun


@kernel
def _listed(listing: Ints, used: int, kind: int, robot: int, other: int) -> int:
    listing[used, 0], listing[used, 1], listing[used, 2] = kind, robot, other
    return used + 1
