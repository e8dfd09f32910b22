"""The centralised safety filter: one quadratic program for the whole team, [23], in which pairs share a constraint.

    list     a Verlet list keeps the program's structure, so that OSQP updates numbers instead of starting anew
    OSQP     finds the active constraints; its status and residuals are never trusted alone
    polish   solves the active parts exactly, speed limit included, and proves a conflict where there is one

Slower than the distributed filter, and in Python: no fast preview. Where no velocities of the team meet all
constraints, or the program cannot be solved, the distributed filter answers for this tick; it takes the least violation
and flags the robots.
"""
# OSQP and SciPy's sparse matrices have no types.
# pyright: reportUnknownMemberType=false

from typing import NamedTuple

import numpy as np
import osqp
from scipy import sparse

from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.speed_limit import clipped
from higvf_console.control.safety.barriers.surroundings import Surroundings, survey
from higvf_console.control.safety.coupled_constraints import constraint_list, listed_constraints
from higvf_console.control.safety.hazards import AX, AY, BX, BY, RADIUS, VX, VY, bounded, radius_varies
from higvf_console.control.safety.nearest_point import OPTIMAL, Constraints, residual
from higvf_console.control.safety.polish import polish
from higvf_console.control.safety.safety_filter import filter_velocities
from higvf_console.core.arrays import Bools, Floats, Ints

_SOLVED = 1  # OSQP_SOLVED; an enumeration that its package makes when it is imported
_SKIN = 0.5  # share of the robot clearance that is listed beyond what can matter now
_ROUGH = 1e-3  # share of v_max: accurate enough to tell which constraints are likely to be active
_FINE = 1e-9  # for teams that are too entangled to be polished
_LIKELY = 1e-3  # share of v_max within which a constraint may turn out to be active
_ACCEPTED = 1e-7  # share of v_max allowed in the optimality conditions without polish


class CoupledFilter:
    """The centralised filter of one run; keeps OSQP's workspace between ticks.

    Attributes:
        fallbacks: ticks in which the distributed filter answered instead.
    """

    def __init__(self) -> None:
        """The team and its world may change between calls: the program is then set up anew."""
        self.fallbacks = 0
        self._program: _Program | None = None

    def filter_velocities(
        self, position: Floats, nominal: Floats, hazards: Floats, safety: SafetyParameters
    ) -> tuple[Floats, Ints, Bools]:
        """Filters the whole team; arguments and results as in `safety_filter.filter_velocities`."""
        found = None
        if np.isfinite(position).all() and np.isfinite(nominal).all():
            found = self._solved(survey(position, hazards, safety), nominal)
        if found is None:
            self.fallbacks += 1
            return filter_velocities(position, nominal, hazards, safety)
        return found.velocity, found.active_constraints, found.outrun

    def _solved(self, around: Surroundings, nominal: Floats) -> "_Found | None":
        """The exact optimum, or None where there is none or it could not be found."""
        if self._program is None or not self._program.covers(around):
            self._program = _Program(around)
        constraints, outrun = listed_constraints(self._program.listing, around)
        limit = around.safety.speed_limit
        wanted = _limited(nominal, limit)
        if _all_met(wanted, constraints):
            return _Found(wanted, np.zeros(len(nominal), np.int64), outrun)
        guess = self._program.solve(wanted, constraints, limit, _ROUGH)
        if guess is None:
            return None
        likely = (guess.weight > _LIKELY * limit) | (_residuals(guess.velocity, constraints) > -_LIKELY * limit)
        exact = polish(wanted, constraints, likely, limit)
        if exact.status == OPTIMAL:
            return _Found(exact.velocity, _active(exact.weight > 0.0, constraints, len(nominal)), outrun)
        fine = self._program.solve(wanted, constraints, limit, _FINE)
        if fine is None or _optimality_error(wanted, fine, constraints, limit) > _ACCEPTED * limit:
            return None
        return _Found(fine.velocity, _active(fine.weight > _ACCEPTED * limit, constraints, len(nominal)), outrun)


class _Found(NamedTuple):
    velocity: Floats  # (N, 2) [m/s]
    active_constraints: Ints  # (N,)
    outrun: Bools  # (N,) a hazard comes faster than the robot can retreat


class _Guess(NamedTuple):
    velocity: Floats  # (N, 2) [m/s]
    weight: Floats  # (R,) multipliers [m/s]


class _Program:
    """OSQP's problem for one list, in units of v_max and with unit normals: minimise |u - v|^2/2 under A u <= b."""

    def __init__(self, around: Surroundings) -> None:
        self._skin = _SKIN * around.safety.robot_clearance
        self.listing = constraint_list(around, self._skin)
        self._made_for = around._replace(position=around.position.copy())
        ends = listed_constraints(self.listing, around)[0].ends[: len(self.listing)]
        row = np.arange(len(ends))
        pairs = np.flatnonzero(ends[:, 1] >= 0)
        first, second = 2 * ends[:, 0], 2 * ends[pairs, 1]
        rows = np.concatenate((row, row, pairs, pairs))
        columns = np.concatenate((first, first + 1, second, second + 1))
        self._pairs = pairs
        self._order = np.lexsort((rows, columns))  # of OSQP's compressed columns
        size = around.position.size
        starts = np.concatenate(([0], np.cumsum(np.bincount(columns, minlength=size))))
        matrix = sparse.csc_matrix((np.ones(len(rows)), rows[self._order], starts), (len(ends), size))
        self._solver = osqp.OSQP()
        self._solver.setup(
            sparse.eye(size, format="csc"),
            np.zeros(size),
            matrix,
            np.full(len(ends), -np.inf),
            np.zeros(len(ends)),
            scaling=0,
            rho=1.0,
            check_termination=5,
            max_iter=4000,
            warm_starting=True,
            verbose=False,
        )

    def covers(self, around: Surroundings) -> bool:
        """Whether the list still holds every constraint that can matter."""
        made, now = self._made_for, around.hazards
        then = made.hazards
        if around.safety != made.safety or around.position.shape != made.position.shape or now.shape != then.shape:
            return False
        changed = now != then
        changed[radius_varies(now), RADIUS] = False  # counted in the activation distance
        moves = now[:, [VX, VY]].any(axis=1) | then[:, [VX, VY]].any(axis=1)
        for column in (AX, AY, BX, BY, VX, VY):
            changed[moves, column] = False
        if changed.any():
            return False
        shifted = np.hypot(now[:, AX] - then[:, AX], now[:, AY] - then[:, AY])
        near = bounded(now)
        nearer = shifted[near] + np.maximum(around.activation[near] - made.activation[near], 0.0)
        moved = np.hypot(*(around.position - made.position).T)
        return bool(nearer.max(initial=0.0) <= self._skin / 2 and moved.max(initial=0.0) <= self._skin / 2)

    def solve(self, nominal: Floats, constraints: Constraints, limit: float, accuracy: float) -> _Guess | None:
        """OSQP's answer, or None where it does not call the problem solved."""
        linear = constraints.linear[: constraints.size]
        unit = np.ones(constraints.size)
        unit[self._pairs] = np.sqrt(0.5)
        ax, ay = unit * linear[:, 0], unit * linear[:, 1]
        values = np.concatenate((ax, ay, -ax[self._pairs], -ay[self._pairs]))[self._order]
        self._solver.update_settings(eps_abs=accuracy, eps_rel=accuracy)
        self._solver.update(q=-nominal.ravel() / limit, u=unit * linear[:, 2] / limit, Ax=values)
        result = self._solver.solve(raise_error=False)
        if result.info.status_val != _SOLVED:
            return None
        velocity, weight = np.asarray(result.x) * limit, np.asarray(result.y) * unit * limit
        if not (np.isfinite(velocity).all() and np.isfinite(weight).all()):
            return None
        return _Guess(velocity.reshape(-1, 2), weight)


def _optimality_error(nominal: Floats, guess: _Guess, constraints: Constraints, limit: float) -> float:
    """Largest violation of the optimality conditions of the whole team [m/s]."""
    ends, normal = constraints.ends[: constraints.size], constraints.linear[: constraints.size, :2]
    broken = _residuals(guess.velocity, constraints)
    stationary = guess.velocity - nominal
    np.add.at(stationary, ends[:, 0], guess.weight[:, None] * normal)
    shared = ends[:, 1] >= 0
    np.subtract.at(stationary, ends[shared, 1], guess.weight[shared, None] * normal[shared])
    slack = np.minimum(guess.weight, np.abs(broken))
    speed = np.hypot(*guess.velocity.T) - limit
    parts = (broken, -guess.weight, slack, speed, np.abs(stationary).ravel())
    return max(float(part.max(initial=0.0)) for part in parts)


@kernel
def _limited(nominal: Floats, limit: float) -> Floats:
    wanted = np.empty_like(nominal)
    for i in range(nominal.shape[0]):
        wanted[i, 0], wanted[i, 1] = clipped(nominal[i, 0], nominal[i, 1], limit)
    return wanted


@kernel
def _residuals(velocity: Floats, constraints: Constraints) -> Floats:
    broken = np.empty(constraints.size)
    for r in range(constraints.size):
        broken[r] = residual(constraints, r, velocity)
    return broken


@kernel
def _all_met(velocity: Floats, constraints: Constraints) -> bool:
    met = True
    for r in range(constraints.size):
        met = met and residual(constraints, r, velocity) <= 0.0
    return met


@kernel
def _active(active: Bools, constraints: Constraints, count: int) -> Ints:
    found = np.zeros(count, np.int64)
    for r in range(constraints.size):
        if active[r]:
            found[constraints.ends[r, 0]] += 1
            if constraints.ends[r, 1] >= 0:
                found[constraints.ends[r, 1]] += 1
    return found
