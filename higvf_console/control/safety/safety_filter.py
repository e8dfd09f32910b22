"""The safety filter: each robot's velocity nearest to its nominal one that meets its barriers, [25], [28].

    survey    who and what is near enough to matter            O(N)
    project   each robot alone, on its halves of the pairs     exact, in the plane
    rescue    robots that have no velocity alone               rare: neighbours yield, or the least violation

The nominal velocity never passes unfiltered; a robot whose data are not numbers gets zero, and the others go on.
"""

import math

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.speed_limit import clipped
from higvf_console.control.safety.barriers.surroundings import constraints_of, most_constraints, survey
from higvf_console.control.safety.projection import project
from higvf_console.control.safety.rescue import Outcome, rescue
from higvf_console.core.arrays import Bools, Floats, Ints

_MET_WITH_EQUALITY = 1e-9  # share of v_max within which a constraint counts as active


@kernel
def filter_velocities(
    position: Floats, nominal: Floats, hazards: Floats, safety: SafetyParameters
) -> tuple[Floats, Ints, Bools]:
    """The distributed safety filter of the whole team.

    Args:
        position: (N, 2) [m].
        nominal: (N, 2) [m/s]; shortened to the speed limit first.
        hazards: (H, 9) obstacles, walls and fires, see `control.safety.hazards`.
        safety: clearances, rates, speed limit and control period.

    Returns:
        velocity: (N, 2) [m/s], the nominal one bit for bit where all constraints are slack.
        active_constraints: (N,) barrier constraints that shaped it.
        infeasible: (N,) no velocities of the team meet the robot's constraints, so the least violation was taken; or a
            hazard comes faster than the robot can retreat; or its data are not numbers, and its velocity is zero.
    """
    around = survey(position, hazards, safety)
    count = position.shape[0]
    outcome = Outcome(np.zeros((count, 2)), np.zeros(count, np.int64), np.zeros(count, np.bool_))
    limited = np.zeros((count, 2))
    stuck = np.zeros(count, np.bool_)
    outrun = np.zeros(count, np.bool_)
    usable = np.zeros(count, np.bool_)
    most = most_constraints(around)
    constraints = np.empty((most, 3))
    cause = np.empty((most, 2), np.int64)
    kept = np.empty(most, np.int64)
    any_stuck = False
    for i in range(count):
        vx, vy = clipped(nominal[i, 0], nominal[i, 1], safety.speed_limit)
        used, outrun[i] = constraints_of(i, around, constraints, cause)
        ux, uy, feasible = project(vx, vy, constraints, used, safety.speed_limit, kept)
        usable[i] = math.isfinite(ux + uy + position[i, 0] + position[i, 1])
        if not usable[i]:
            outcome.infeasible[i] = True
            continue
        limited[i, 0], limited[i, 1] = vx, vy
        stuck[i] = not feasible
        outcome.velocity[i, 0], outcome.velocity[i, 1] = ux, uy
        if ux != vx or uy != vy:
            outcome.active_constraints[i] = _active(ux, uy, constraints, used, safety.speed_limit)
        any_stuck = any_stuck or stuck[i]
    if any_stuck:
        rescue(stuck, usable, limited, around, outcome)
    return outcome.velocity, outcome.active_constraints, outcome.infeasible | outrun


@kernel
def blocked(
    velocity_x: float,
    velocity_y: float,
    nominal_x: float,
    nominal_y: float,
    active_constraints: int,
    stall_speed: float,
) -> bool:
    """Whether barriers, and nothing else, keep a robot from moving.

    The filter's answer satisfies v - u = sum of lambda_k a_k over active constraints, lambda >= 0. So a robot that
    should move and does not (u = 0) has its nominal velocity v in the cone of the active normals, and a nominal
    velocity in the cone of constraints with b = 0 gives u = 0: the cone test needs no constraints, only this.

    Args:
        velocity_x: filtered velocity u [m/s].
        velocity_y: filtered velocity u [m/s].
        nominal_x: what the filter was given, v [m/s].
        nominal_y: what the filter was given, v [m/s].
        active_constraints: from `filter_velocities`.
        stall_speed: below it a robot stands [m/s].
    """
    stands = velocity_x * velocity_x + velocity_y * velocity_y < stall_speed * stall_speed
    wants = nominal_x * nominal_x + nominal_y * nominal_y > stall_speed * stall_speed
    return stands and wants and active_constraints > 0


@kernel
def _active(ux: float, uy: float, constraints: Floats, count: int, speed_limit: float) -> int:
    active = 0
    for k in range(count):
        ax, ay, b = constraints[k, 0], constraints[k, 1], constraints[k, 2]
        active += ax * ux + ay * uy >= b - _MET_WITH_EQUALITY * speed_limit
    return active
