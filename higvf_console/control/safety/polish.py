"""From a good guess to the exact optimum: constraints that are active, or nearly, split the team into small problems.

Robots that share no tight constraint do not feel each other, so each connected component is solved by itself
(`nearest_point`). Constraints that the parts break together are added, and the parts that they join are solved again.
"""

from typing import NamedTuple

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.control.safety.nearest_point import (
    FAILED,
    OPTIMAL,
    Constraints,
    empty_constraints,
    nearest,
    optimality_error,
    residual,
    violation,
)
from higvf_console.core.arrays import Bools, Floats, Ints

_LARGEST_PART = 100  # robots; beyond it the dense method is slower than a sparse solver
_ROUNDS = 12
_BROKEN = 1e-9  # share of v_max
_OPTIMALITY = 1e-6  # relative error allowed in the optimality conditions


class Polished(NamedTuple):
    """What `polish` found.

    Attributes:
        status: OPTIMAL, CONFLICT (no velocities meet all constraints, proven) or FAILED (too large, or no progress).
        velocity: (N, 2) [m/s].
        weight: (R,) multipliers of the constraints.
    """

    status: int
    velocity: Floats
    weight: Floats


@kernel
def polish(nominal: Floats, constraints: Constraints, likely: Bools, speed_limit: float) -> Polished:
    """The velocities nearest to `nominal` that meet all constraints and the speed limit, exactly.

    Args:
        nominal: (N, 2) within the speed limit [m/s].
        constraints: all constraints of the team.
        likely: (R,) constraints that are thought to be tight; grows by the constraints that turn out to be.
        speed_limit: v_max [m/s].
    """
    velocity = nominal.copy()
    weight = np.zeros(constraints.size)
    for _ in range(_ROUNDS):
        part = _parts(constraints, likely, nominal.shape[0])
        of_constraint = np.full(constraints.size, -1, np.int64)
        for r in range(constraints.size):
            if likely[r]:
                of_constraint[r] = part[constraints.ends[r, 0]]
        first, members = _grouped(part, nominal.shape[0])
        first_constraint, which = _grouped(of_constraint, nominal.shape[0])
        for k in range(nominal.shape[0]):
            own = members[first[k] : first[k + 1]]
            own_constraints = which[first_constraint[k] : first_constraint[k + 1]]
            if own.shape[0] > 0:
                status = _solve_part(own, own_constraints, nominal, constraints, speed_limit, velocity, weight)
                if status != OPTIMAL:
                    return Polished(status, velocity, weight)
        grown = False
        for r in range(constraints.size):
            if not likely[r] and residual(constraints, r, velocity) > _BROKEN * speed_limit:
                likely[r] = True
                grown = True
        if not grown:
            return Polished(OPTIMAL, velocity, weight)
    return Polished(FAILED, velocity, weight)


@kernel
def _parts(constraints: Constraints, likely: Bools, count: int) -> Ints:
    """Connected components of the likely pair constraints: (N,) smallest robot index of each one's component."""
    part = np.arange(count)
    for r in range(constraints.size):
        i, j = constraints.ends[r, 0], constraints.ends[r, 1]
        if likely[r] and j >= 0:
            i, j = _root(part, i), _root(part, j)
            part[max(i, j)] = min(i, j)
    for i in range(count):
        part[i] = _root(part, i)
    return part


@kernel
def _grouped(label: Ints, count: int) -> tuple[Ints, Ints]:
    """The indices of every label in compressed rows; those labelled -1 are left out."""
    first = np.zeros(count + 1, np.int64)
    for k in range(label.shape[0]):
        if label[k] >= 0:
            first[label[k] + 1] += 1
    for k in range(count):
        first[k + 1] += first[k]
    fill = first.copy()
    members = np.empty(first[count], np.int64)
    for k in range(label.shape[0]):
        if label[k] >= 0:
            members[fill[label[k]]] = k
            fill[label[k]] += 1
    return first, members


@kernel
def _root(part: Ints, i: int) -> int:
    while part[i] != i:
        part[i] = part[part[i]]
        i = part[i]
    return i


@kernel
def _solve_part(
    members: Ints,
    which: Ints,
    nominal: Floats,
    constraints: Constraints,
    speed_limit: float,
    velocity: Floats,
    weight: Floats,
) -> int:
    """Writes the velocities of `members` under the constraints `which`, and their multipliers; its status."""
    if members.shape[0] > _LARGEST_PART:
        return FAILED
    wanted = np.empty((members.shape[0], 2))
    for k in range(members.shape[0]):
        wanted[k, 0], wanted[k, 1] = nominal[members[k], 0], nominal[members[k], 1]
    own = empty_constraints(members.shape[0], which.shape[0])
    for k in range(which.shape[0]):
        r = which[k]
        own.ends[k, 0] = np.searchsorted(members, constraints.ends[r, 0])
        if constraints.ends[r, 1] >= 0:
            own.ends[k, 1] = np.searchsorted(members, constraints.ends[r, 1])
        own.linear[k, 0], own.linear[k, 1], own.linear[k, 2] = (
            constraints.linear[r, 0],
            constraints.linear[r, 1],
            constraints.linear[r, 2],
        )
    solution = nearest(wanted, own, speed_limit)
    if solution.status != OPTIMAL:
        return solution.status
    if violation(own, solution.velocity, speed_limit) > _BROKEN * speed_limit:
        return FAILED
    if optimality_error(wanted, own, solution, speed_limit) > _OPTIMALITY:
        return FAILED
    for k in range(members.shape[0]):
        velocity[members[k], 0], velocity[members[k], 1] = solution.velocity[k, 0], solution.velocity[k, 1]
    for k in range(which.shape[0]):
        weight[which[k]] = solution.weight[k]
    return OPTIMAL
