"""Robots that cannot meet their own halves of the pair rows: neighbours yield, and only then is anything violated.

A robot between a growing fire and a neighbour may have no velocity that keeps its half of their row, while both
together have one. So its rows are solved as a cluster, in which the members share their pair rows as they like, [22],
and keep their own rows and their halves towards everyone else. A cluster that has no solution comes with a proof: the
rows in conflict. If a half towards somebody else is among them, that robot joins the cluster; robots that are in
nobody's way stay out. If none is, no velocities of the whole team meet the coupled rows, and the rows in conflict give
way, by the least equal amount. So the largest violation of a cluster is the smallest possible, rows out of the conflict
are met exactly (short of a great many conflicts), and the velocities are the nearest to the nominal ones under that.
"""

from typing import NamedTuple

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.control.safety.barriers.surroundings import NO_ROBOT, Surroundings, constraints_of, most_constraints
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

_MOST_MEMBERS = 64  # a larger crowd would hold up the tick: its outermost rows give way instead
_MOST_CONFLICTS = 60
_SEPARATE_CONFLICTS = 30  # after so many, all rows give way together and ever more, which ends it
_VIOLATION = 1e-6  # share of v_max by which a row must be broken for a robot to count as infeasible
_PROOF = 1e-9  # weight below which a row has no part in a conflict
_LEEWAY = 1e-9  # share of v_max by which a row gives way more than it must
_FEASIBILITY = 1e-8  # share of v_max by which an accepted solution may break a row
_OPTIMALITY = 1e-6  # relative error allowed in its optimality conditions


class Outcome(NamedTuple):
    """What the filter returns; a rescue overwrites the rows of its robots.

    Attributes:
        velocity: (N, 2) [m/s].
        active_constraints: (N,) rows that shape the velocity.
        infeasible: (N,) whether a row had to be violated.
    """

    velocity: Floats
    active_constraints: Ints
    infeasible: Bools


@kernel
def rescue(stuck: Bools, usable: Bools, nominal: Floats, around: Surroundings, outcome: Outcome) -> None:
    """Finds velocities for the stuck robots, together with the neighbours that have to yield to them.

    Args:
        stuck: (N,) robots that have no velocity under their own rows.
        usable: (N,) robots whose position and nominal velocity are numbers; no other joins a cluster.
        nominal: (N, 2) within the speed limit [m/s].
        around: from `barriers.surroundings.survey`.
        outcome: holds every robot's own solution, and receives that of the clusters.
    """
    cluster = np.full(stuck.shape[0], NO_ROBOT, np.int64)
    for robot in range(stuck.shape[0]):
        if stuck[robot] and cluster[robot] == NO_ROBOT:
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
    rows, outsider = _cluster_constraints(members, around)
    speed_limit = around.safety.speed_limit
    exact = np.empty(rows.size)
    for r in range(rows.size):
        exact[r] = rows.row[r, 2]
    wanted = np.empty((members.shape[0], 2))
    for k in range(members.shape[0]):
        wanted[k, 0], wanted[k, 1] = nominal[members[k], 0], nominal[members[k], 1]
    solution = nearest(wanted, rows, speed_limit)
    for conflict in range(_MOST_CONFLICTS):
        if solution.status != CONFLICT:
            break
        if _absorbed(name, cluster, members.shape[0], usable, rows.size, outsider, solution.weight):
            return True
        _give_way(rows, exact, outsider, solution, conflict - _SEPARATE_CONFLICTS, speed_limit)
        solution = nearest(wanted, rows, speed_limit)
    sound = solution.status == OPTIMAL
    sound = sound and violation(rows, solution.velocity, speed_limit) <= _FEASIBILITY * speed_limit
    sound = sound and optimality_error(wanted, rows, solution, speed_limit) <= _OPTIMALITY
    if sound:
        for r in range(rows.size):
            rows.row[r, 2] = exact[r]
        _write(members, rows, solution, speed_limit, outcome)
    else:
        for robot in members:
            if stuck[robot]:
                outcome.velocity[robot, 0], outcome.velocity[robot, 1] = 0.0, 0.0
                outcome.infeasible[robot] = True
    return False


@kernel
def _cluster_constraints(members: Ints, around: Surroundings) -> tuple[Constraints, Ints]:
    """The rows of a cluster, and for each the robot outside that shares it, or NO_ROBOT."""
    local = np.full(around.position.shape[0], NO_ROBOT, np.int64)
    for k in range(members.shape[0]):
        local[members[k]] = k
    most = most_constraints(around)
    rows = empty_constraints(members.shape[0], most * members.shape[0])
    outsider = np.full(rows.row.shape[0], NO_ROBOT, np.int64)
    own = np.empty((most, 3))
    other = np.empty(most, np.int64)
    used = 0
    for k in range(members.shape[0]):
        for r in range(constraints_of(members[k], around, own, other)):
            shared = other[r] != NO_ROBOT and local[other[r]] != NO_ROBOT
            if shared and other[r] < members[k]:
                continue
            rows.row[used, 0], rows.row[used, 1], rows.row[used, 2] = own[r, 0], own[r, 1], own[r, 2]
            rows.ends[used, 0] = k
            if shared:
                rows.ends[used, 1] = local[other[r]]
                rows.row[used, 2] *= 2.0
            else:
                outsider[used] = other[r]
            used += 1
    return Constraints(rows.ends, rows.row, used), outsider


@kernel
def _absorbed(name: int, cluster: Ints, size: int, usable: Bools, count: int, outsider: Ints, weight: Floats) -> bool:
    """Takes the robots whose halves are in conflict, with their clusters, into this one; whether there were any."""
    grown = False
    for r in range(count):
        robot = outsider[r]
        if robot == NO_ROBOT or weight[r] <= _PROOF or not usable[robot] or cluster[robot] == name:
            continue
        known = int(cluster[robot])
        joining = np.full(1, robot, np.int64) if known == NO_ROBOT else _members(known, cluster)
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
    rows: Constraints, exact: Floats, outsider: Ints, solution: Solution, late: int, speed_limit: float
) -> None:
    """Relaxes the rows in conflict, or all of the members', to the least equal level that ends it; no speed limit.

    The weights y make the left sides cancel, so that the rows agree once sum y (b + level) >= 0. No level exceeds the
    least violation of the cluster, since at that every conflict is resolved.
    """
    gap, total = 0.0, 0.0
    for r in range(solution.size):
        if r < rows.size:
            gap -= solution.weight[r] * exact[r]
            total += solution.weight[r]
        else:
            gap -= solution.weight[r] * rows.row[r, 2]
    leeway = _LEEWAY * speed_limit * 2.0 ** max(late, 0)
    level = max(gap / total, 0.0) + leeway
    for r in range(rows.size):
        if solution.weight[r] > _PROOF or (late >= 0 and outsider[r] == NO_ROBOT):
            raised = max(rows.row[r, 2], exact[r] + level)
            rows.row[r, 2] = raised if raised > rows.row[r, 2] else raised + leeway


@kernel
def _write(members: Ints, rows: Constraints, solution: Solution, speed_limit: float, outcome: Outcome) -> None:
    """Hands a cluster's velocities back, with the rows that shape them and the robots whose exact rows are broken."""
    for k in range(members.shape[0]):
        robot = members[k]
        outcome.velocity[robot, 0], outcome.velocity[robot, 1] = solution.velocity[k, 0], solution.velocity[k, 1]
        outcome.active_constraints[robot] = 0
        outcome.infeasible[robot] = False
    for r in range(rows.size):
        broken = residual(rows, r, solution.velocity) > _VIOLATION * speed_limit
        for side in range(2):
            if rows.ends[r, side] >= 0:
                robot = members[rows.ends[r, side]]
                outcome.active_constraints[robot] += broken or solution.weight[r] > 0.0
                outcome.infeasible[robot] = outcome.infeasible[robot] or broken
