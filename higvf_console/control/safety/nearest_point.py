"""The nearest point to nominal velocities under constraints that couple robots: a dual active set, exact, with proofs.

The method of Goldfarb and Idnani for an identity Hessian. It starts at the nominal velocities, which are optimal for no
constraints, and brings in the most violated constraint, letting go of active constraints whose multiplier would turn
negative. It stops at the optimum, or with a conflict: weights >= 0 under which the constraints add up to 0.u <=
something negative, which proves that no velocity meets them. A speed limit is a disc, so it enters as a tangent
wherever it is broken.

A constraint is ax, ay, b of a.u_i <= b, or of a.(u_i - u_j) <= b where two members share it: `ends` holds i and j, or i
and -1.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Bools, Floats, Ints

OPTIMAL = 0
CONFLICT = 1
FAILED = 2

_TOLERANCE = 1e-10  # share of v_max by which a constraint may be broken
_DEPENDENT = 1e-14  # square of the sine of the angle to the active normals below which a normal depends on them
_TANGENTS = 40  # a member, at most


class Constraints(NamedTuple):
    """Constraints of a cluster of S robots, with space for the tangents of the speed limit behind them.

    Attributes:
        ends: (C, 2) members that share the constraint; -1 for none.
        linear: (C, 3) ax, ay, b.
        size: number of constraints before any tangent.
    """

    ends: Ints
    linear: Floats
    size: int


class Solution(NamedTuple):
    """What `nearest` found.

    Attributes:
        status: OPTIMAL, CONFLICT or FAILED.
        velocity: (S, 2) [m/s]; of use when OPTIMAL.
        weight: (C,) multipliers of the constraints when OPTIMAL; when in CONFLICT the weights that prove it.
        size: number of constraints, tangents included.
    """

    status: int
    velocity: Floats
    weight: Floats
    size: int


class _Active(NamedTuple):
    """Active constraints, their multipliers, and N = Q R of their normals: row k of `basis` is Q's column k."""

    chosen: Ints
    multiplier: Floats
    basis: Floats
    upper: Floats


@kernel
def empty_constraints(members: int, count: int) -> Constraints:
    """Space for `count` constraints of a cluster and for the tangents of its speed limits."""
    space = count + _TANGENTS * members
    return Constraints(np.full((space, 2), -1, np.int64), np.zeros((space, 3)), count)


@kernel
def nearest(nominal: Floats, constraints: Constraints, speed_limit: float) -> Solution:
    """The velocities nearest to `nominal` that meet all constraints and the speed limit.

    Args:
        nominal: (S, 2) [m/s].
        constraints: from `empty_constraints`, filled; tangents are written behind them.
        speed_limit: v_max [m/s].
    """
    size = nominal.size
    active = _Active(
        np.empty(size, np.int64), np.zeros(size), np.zeros((size, size)), np.zeros((size, size))
    )  # fmt: skip
    velocity = nominal.copy()
    weight = np.zeros(constraints.linear.shape[0])
    is_active = np.zeros(constraints.linear.shape[0], np.bool_)
    used, count = 0, constraints.size
    for _ in range(20 * (size + constraints.size) + 200):
        p, count = _most_broken(velocity, constraints, count, is_active, speed_limit)
        if p < 0:
            for k in range(used):
                weight[active.chosen[k]] = active.multiplier[k]
            return Solution(OPTIMAL, velocity, weight, count)
        if p >= constraints.linear.shape[0]:
            return Solution(FAILED, velocity, weight, count)
        used, proven = _enter(p, velocity, constraints, active, used, is_active, weight)
        if proven:
            return Solution(CONFLICT, velocity, weight, count)
    return Solution(FAILED, velocity, weight, count)


@kernel
def residual(constraints: Constraints, r: int, velocity: Floats) -> float:
    """By how much `velocity` (S, 2) breaks constraint r [m/s]."""
    i, j = constraints.ends[r, 0], constraints.ends[r, 1]
    ax, ay = constraints.linear[r, 0], constraints.linear[r, 1]
    value = ax * velocity[i, 0] + ay * velocity[i, 1]
    if j >= 0:
        value -= ax * velocity[j, 0] + ay * velocity[j, 1]
    return value - constraints.linear[r, 2]


@kernel
def violation(constraints: Constraints, velocity: Floats, speed_limit: float) -> float:
    """By how much `velocity` (S, 2) breaks the worst constraint or speed limit [m/s]; 0 if it meets them all."""
    worst = 0.0
    for r in range(constraints.size):
        worst = max(worst, residual(constraints, r, velocity))
    for k in range(velocity.shape[0]):
        worst = max(worst, math.sqrt(velocity[k, 0] ** 2 + velocity[k, 1] ** 2) - speed_limit)
    return worst


@kernel
def optimality_error(nominal: Floats, constraints: Constraints, solution: Solution, speed_limit: float) -> float:
    """By how much a solution misses stationarity, complementarity and the signs of the multipliers.

    Returns:
        A share of the largest multiplier, or of the speed limit where that is larger.
    """
    stationary = np.empty_like(nominal)
    for k in range(nominal.shape[0]):
        for axis in range(2):
            stationary[k, axis] = solution.velocity[k, axis] - nominal[k, axis]
    error, scale = 0.0, speed_limit
    for r in range(solution.size):
        weight = solution.weight[r]
        scale = max(scale, weight)
        error = max(error, -weight, min(weight, abs(residual(constraints, r, solution.velocity))))
        i, j = constraints.ends[r, 0], constraints.ends[r, 1]
        for axis in range(2):
            stationary[i, axis] += weight * constraints.linear[r, axis]
            if j >= 0:
                stationary[j, axis] -= weight * constraints.linear[r, axis]
    for k in range(nominal.shape[0]):
        error = max(error, abs(stationary[k, 0]), abs(stationary[k, 1]))
    return error / scale


@kernel
def _most_broken(
    velocity: Floats, constraints: Constraints, count: int, is_active: Bools, speed_limit: float
) -> tuple[int, int]:
    """The most broken constraint, -1 if none is; a broken speed limit adds its tangent. And how many there are."""
    worst, p, fast = _TOLERANCE * speed_limit, -1, -1
    for r in range(count):
        if not is_active[r]:
            broken = residual(constraints, r, velocity)
            if broken > worst:
                worst, p = broken, r
    for k in range(velocity.shape[0]):
        excess = math.sqrt(velocity[k, 0] ** 2 + velocity[k, 1] ** 2) - speed_limit
        if excess > worst:
            worst, fast = excess, k
    if fast < 0:
        return p, count
    if count < constraints.linear.shape[0]:
        speed = speed_limit + worst
        constraints.ends[count, 0], constraints.ends[count, 1] = fast, -1
        constraints.linear[count, 0], constraints.linear[count, 1] = (
            velocity[fast, 0] / speed,
            velocity[fast, 1] / speed,
        )
        constraints.linear[count, 2] = speed_limit
    return count, count + 1


@kernel
def _enter(
    p: int, velocity: Floats, constraints: Constraints, active: _Active, used: int, is_active: Bools, weight: Floats
) -> tuple[int, bool]:
    """Makes constraint p active, moving `velocity` and multipliers; or writes the proof of a conflict to `weight`."""
    size = velocity.size
    step = np.empty(size)
    share = np.empty(size)
    column = np.empty(size)
    gained = 0.0
    while True:
        square = _split(p, constraints, active, used, step, column)
        _solve_upper(active.upper, column, used, share)
        drop, t = -1, np.inf
        for k in range(used):
            if share[k] > 1e-13 and active.multiplier[k] < t * share[k]:
                drop, t = k, active.multiplier[k] / share[k]
        independent = square > _DEPENDENT
        full = max(residual(constraints, p, velocity), 0.0) / square if independent else np.inf
        if drop < 0 and not independent:
            weight[p] = 1.0
            for k in range(used):
                weight[active.chosen[k]] = max(-share[k], 0.0)
            return used, True
        t = min(t, full)
        gained += t
        for k in range(used):
            active.multiplier[k] -= t * share[k]
        if independent:
            for k in range(velocity.shape[0]):
                velocity[k, 0] -= t * step[2 * k]
                velocity[k, 1] -= t * step[2 * k + 1]
        if full <= t:
            _append(p, active, used, step, column, math.sqrt(square))
            active.multiplier[used] = gained
            is_active[p] = True
            return used + 1, False
        is_active[active.chosen[drop]] = False
        used = _remove(drop, active, used)


@kernel
def _split(p: int, constraints: Constraints, active: _Active, used: int, step: Floats, column: Floats) -> float:
    """Splits constraint p's normal into `column`, its parts along the basis, and `step`, the rest; the rest squared."""
    for m in range(step.shape[0]):
        step[m] = 0.0
        column[m] = 0.0
    i, j = constraints.ends[p, 0], constraints.ends[p, 1]
    for axis in range(2):
        step[2 * i + axis] = constraints.linear[p, axis]
        if j >= 0:
            step[2 * j + axis] = -constraints.linear[p, axis]
    square, before = _square(step), np.inf
    while square < 0.5 * before and square > 0.0:  # a second pass removes the rounding of the first
        before = square
        for k in range(used):
            part = 0.0
            for m in range(step.shape[0]):
                part += active.basis[k, m] * step[m]
            column[k] += part
            for m in range(step.shape[0]):
                step[m] -= part * active.basis[k, m]
        square = _square(step)
        if square < _DEPENDENT * _DEPENDENT:
            break
    return square


@kernel
def _square(step: Floats) -> float:
    total = 0.0
    for m in range(step.shape[0]):
        total += step[m] * step[m]
    return total


@kernel
def _solve_upper(upper: Floats, column: Floats, used: int, share: Floats) -> None:
    for k in range(used - 1, -1, -1):
        value = column[k]
        for m in range(k + 1, used):
            value -= upper[k, m] * share[m]
        share[k] = value / upper[k, k]


@kernel
def _append(p: int, active: _Active, used: int, step: Floats, column: Floats, length: float) -> None:
    active.chosen[used] = p
    for m in range(step.shape[0]):
        active.basis[used, m] = step[m] / length
    for k in range(used):
        active.upper[k, used] = column[k]
    active.upper[used, used] = length


@kernel
def _remove(drop: int, active: _Active, used: int) -> int:
    """Takes one active constraint out; plane rotations make the rest of N = Q R triangular again. How many are left."""
    upper, basis = active.upper, active.basis
    for k in range(drop, used - 1):
        active.chosen[k] = active.chosen[k + 1]
        active.multiplier[k] = active.multiplier[k + 1]
        for m in range(k + 2):
            upper[m, k] = upper[m, k + 1]
        length = math.sqrt(upper[k, k] ** 2 + upper[k + 1, k] ** 2)
        c, s = upper[k, k] / length, upper[k + 1, k] / length
        upper[k, k] = length
        for m in range(k + 2, used):
            upper[k, m], upper[k + 1, m] = c * upper[k, m] + s * upper[k + 1, m], c * upper[k + 1, m] - s * upper[k, m]
        for m in range(basis.shape[1]):
            basis[k, m], basis[k + 1, m] = c * basis[k, m] + s * basis[k + 1, m], c * basis[k + 1, m] - s * basis[k, m]
    return used - 1
