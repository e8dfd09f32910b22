"""Robots that cannot meet their halves of the pair constraints: neighbours yield, and only then is one violated.

A robot between a growing fire and a neighbour may have no velocity that keeps its half of their constraint, while both
together have one. So its constraints are solved as a cluster, in which the members share their pair constraints as they
like, [22], and keep their own constraints and their halves towards everyone else. A cluster that has no solution comes
with a proof: the constraints in conflict. If a half towards somebody else is among them, that robot joins the cluster;
robots that are in nobody's way stay out. If none is, no velocities of the whole team meet the coupled constraints, and
the constraints in conflict give way, by the least equal amount. So the largest violation of a cluster is the smallest
possible, constraints out of the conflict are met exactly (short of a great many conflicts), and the velocities are the
nearest to the nominal ones under that.
"""

from typing import NamedTuple

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.control.safety.barriers.surroundings import (
    NOBODY_ELSE,
    ROBOT,
    Surroundings,
    constraints_of,
    most_constraints,
)
from higvf_console.control.safety.nearest_point import (
    CONFLICT,
    OPTIMAL,
    Constraints,
    Solution,
    empty_constraints,
    nearest,
    optimality_error,
    residual,
    violation,
)
from higvf_console.core.arrays import Bools, Floats, Ints

_MOST_MEMBERS = 64  # a larger crowd would hold up the tick: its outermost constraints give way instead
_MOST_CONFLICTS = 60
_SEPARATE_CONFLICTS = 30  # after so many, all constraints give way together and ever more, which ends it
_VIOLATION = 1e-6  # share of v_max by which a constraint must be broken for a robot to count as infeasible
_PROOF = 1e-9  # weight below which a constraint has no part in a conflict
_LEEWAY = 1e-9  # share of v_max by which a constraint gives way more than it must
_FEASIBILITY = 1e-8  # share of v_max by which an accepted solution may break a constraint
_OPTIMALITY = 1e-6  # relative error allowed in its optimality conditions


class Outcome(NamedTuple):
    """What the filter returns; a rescue overwrites the rows of its robots.

    Attributes:
        velocity: (N, 2) [m/s].
        active_constraints: (N,) constraints that shape the velocity.
        infeasible: (N,) whether a constraint had to be violated.
    """

    velocity: Floats
    active_constraints: Ints
    infeasible: Bools


@kernel
def rescue(stuck: Bools, usable: Bools, nominal: Floats, around: Surroundings, outcome: Outcome) -> None:
    """Finds velocities for the stuck robots, together with the neighbours that have to yield to them.

    Args:
        stuck: (N,) robots that have no velocity under their own constraints.
        usable: (N,) robots whose position and nominal velocity are numbers; no other joins a cluster.
        nominal: (N, 2) within the speed limit [m/s].
        around: from `barriers.surroundings.survey`.
        outcome: holds every robot's own solution, and receives that of the clusters.
    """
    cluster = np.full(stuck.shape[0], NOBODY_ELSE, np.int64)
    for robot in range(stuck.shape[0]):
        if stuck[robot] and cluster[robot] == NOBODY_ELSE:
            cluster[robot] = robot
            while _grown(robot, cluster, stuck, usable, nominal, around, outcome):
                pass


@kernel
def _grown(
    name: int,
    cluster: Ints,
    stuck: Bools,
    usable: Bools,
    nominal: Floats,
    around: Surroundings,
    outcome: Outcome,
) -> bool:
    """Solves a cluster; or adds the robots that stand in its way, and returns True."""
    members = _members(name, cluster)
    constraints, outsider = _cluster_constraints(members, around)
    speed_limit = around.safety.speed_limit
    exact = np.empty(constraints.size)
    for r in range(constraints.size):
        exact[r] = constraints.linear[r, 2]
    wanted = np.empty((members.shape[0], 2))
    for k in range(members.shape[0]):
        wanted[k, 0], wanted[k, 1] = nominal[members[k], 0], nominal[members[k], 1]
    solution = nearest(wanted, constraints, speed_limit)
    for conflict in range(_MOST_CONFLICTS):
        if solution.status != CONFLICT:
            break
        if _absorbed(name, cluster, members.shape[0], usable, constraints.size, outsider, solution.weight):
            return True
        _give_way(constraints, exact, outsider, solution, conflict - _SEPARATE_CONFLICTS, speed_limit)
        solution = nearest(wanted, constraints, speed_limit)
    sound = solution.status == OPTIMAL
    sound = sound and violation(constraints, solution.velocity, speed_limit) <= _FEASIBILITY * speed_limit
    sound = sound and optimality_error(wanted, constraints, solution, speed_limit) <= _OPTIMALITY
    if sound:
        for r in range(constraints.size):
            constraints.linear[r, 2] = exact[r]
        _write(members, constraints, solution, speed_limit, outcome)
    else:
        for robot in members:
            if stuck[robot]:
                outcome.velocity[robot, 0], outcome.velocity[robot, 1] = 0.0, 0.0
                outcome.infeasible[robot] = True
    return False


@kernel
def _cluster_constraints(members: Ints, around: Surroundings) -> tuple[Constraints, Ints]:
    """The constraints of a cluster, and for each the robot outside that shares it, or NOBODY_ELSE."""
    local = np.full(around.position.shape[0], NOBODY_ELSE, np.int64)
    for k in range(members.shape[0]):
        local[members[k]] = k
    most = most_constraints(around)
    constraints = empty_constraints(members.shape[0], most * members.shape[0])
    outsider = np.full(constraints.linear.shape[0], NOBODY_ELSE, np.int64)
    own = np.empty((most, 3))
    cause = np.empty((most, 2), np.int64)
    used = 0
    for k in range(members.shape[0]):
        count, _ = constraints_of(members[k], around, own, cause)
        for r in range(count):
            other = cause[r, ROBOT]
            shared = other != NOBODY_ELSE and local[other] != NOBODY_ELSE
            if shared and other < members[k]:
                continue
            constraints.linear[used, 0], constraints.linear[used, 1], constraints.linear[used, 2] = (
                own[r, 0],
                own[r, 1],
                own[r, 2],
            )
            constraints.ends[used, 0] = k
            if shared:
                constraints.ends[used, 1] = local[other]
                constraints.linear[used, 2] *= 2.0
            else:
                outsider[used] = other
            used += 1
    return Constraints(constraints.ends, constraints.linear, used), outsider


@kernel
def _absorbed(name: int, cluster: Ints, size: int, usable: Bools, count: int, outsider: Ints, weight: Floats) -> bool:
    """Takes the robots whose halves are in conflict, with their clusters, into this one; whether there were any."""
    grown = False
    for r in range(count):
        robot = outsider[r]
        if robot == NOBODY_ELSE or weight[r] <= _PROOF or not usable[robot] or cluster[robot] == name:
            continue
        known = int(cluster[robot])
        joining = np.full(1, robot, np.int64) if known == NOBODY_ELSE else _members(known, cluster)
        if size + joining.shape[0] <= _MOST_MEMBERS:
            grown = True
            size += joining.shape[0]
            for k in range(joining.shape[0]):
                cluster[joining[k]] = name
    return grown


@kernel
def _members(name: int, cluster: Ints) -> Ints:
    count = 0
    members = np.empty(cluster.shape[0], np.int64)
    for robot in range(cluster.shape[0]):
        if cluster[robot] == name:
            members[count] = robot
            count += 1
    return members[:count].copy()


@kernel
def _give_way(
    constraints: Constraints, exact: Floats, outsider: Ints, solution: Solution, late: int, speed_limit: float
) -> None:
    """Relaxes the constraints in conflict, or all of the members', to the least equal level that ends it.

    The weights y make the left sides cancel, so that the constraints agree once sum y (b + level) >= 0. No level
    exceeds the least violation of the cluster, since at that every conflict is resolved.
    """
    gap, total = 0.0, 0.0
    for r in range(solution.size):
        if r < constraints.size:
            gap -= solution.weight[r] * exact[r]
            total += solution.weight[r]
        else:
            gap -= solution.weight[r] * constraints.linear[r, 2]
    leeway = _LEEWAY * speed_limit * 2.0 ** max(late, 0)
    level = max(gap / total, 0.0) + leeway
    for r in range(constraints.size):
        if solution.weight[r] > _PROOF or (late >= 0 and outsider[r] == NOBODY_ELSE):
            raised = max(constraints.linear[r, 2], exact[r] + level)
            constraints.linear[r, 2] = raised if raised > constraints.linear[r, 2] else raised + leeway


@kernel
def _write(members: Ints, constraints: Constraints, solution: Solution, speed_limit: float, outcome: Outcome) -> None:
    """Hands a cluster's velocities back, with the constraints that shape them and the robots whose own are broken."""
    for k in range(members.shape[0]):
        robot = members[k]
        outcome.velocity[robot, 0], outcome.velocity[robot, 1] = solution.velocity[k, 0], solution.velocity[k, 1]
        outcome.active_constraints[robot] = 0
        outcome.infeasible[robot] = False
    for r in range(constraints.size):
        broken = residual(constraints, r, solution.velocity) > _VIOLATION * speed_limit
        for side in range(2):
            if constraints.ends[r, side] >= 0:
                robot = members[constraints.ends[r, side]]
                outcome.active_constraints[robot] += broken or solution.weight[r] > 0.0
                outcome.infeasible[robot] = outcome.infeasible[robot] or broken
