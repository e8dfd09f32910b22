"""Compares the safety filter with other solvers.

    distributed   the compiled filter of each robot
    coupled       the centralised filter: constraints, OSQP, polish
    daqp          a general active-set solver, one call per robot; the time to build its constraints is not counted
    orca          ORCA in C++, as a reference for speed; it solves a different problem

Robots stand on a grid with random nominal velocities; circles and growing fires stand in gaps of the grid.
"""

import itertools
import math
from collections.abc import Callable
from importlib import import_module
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.surroundings import Surroundings, constraints_of, most_constraints, survey
from higvf_console.control.safety.coupled_filter import CoupledFilter
from higvf_console.control.safety.hazards import hazards_of
from higvf_console.control.safety.projection import project
from higvf_console.control.safety.safety_filter import filter_velocities
from higvf_console.core.arrays import Floats, floats
from higvf_console.lab.bench.timing import Case, Suite, take_turns

try:
    import daqp
except ImportError:  # part of the extra `bench`
    daqp = None
try:
    RVOSimulator = import_module("pyrvo.pyrvo").RVOSimulator
except ImportError:  # the extra `orca`, which no other extra installs
    RVOSimulator = None

TEAMS = (3, 30, 100, 1000)
SPACING = {"medium": 60.0, "dense": 30.0}  # [m]
_NOMINALS = 8  # sets of nominal velocities, filtered in turn
_Turn: TypeAlias = Callable[[int], object]
_COMPARED = 60  # robots of each scene that are compared with brute force


class _Scene(NamedTuple):
    position: Floats  # (N, 2) [m]
    nominal: Floats  # (_NOMINALS, N, 2) [m/s]
    circles: Floats  # (P, 3) x, y, radius [m]
    hazards: Floats  # (H, 9) see `control.safety.hazards`
    safety: SafetyParameters


def run() -> Suite:
    """Measures medium and dense scenes of 3 to 1000 robots."""
    cases = [_case(density, robots) for density in SPACING for robots in TEAMS]
    return Suite("Safety filter, one tick of the whole team", "distributed", tuple(cases))


def _case(density: str, robots: int) -> Case:
    scene = _scene(SPACING[density], robots)
    taken: dict[str, float | None] = dict.fromkeys(("distributed", "coupled", "daqp", "orca"))
    contenders, prepare = _contenders(scene)
    taken.update(take_turns(contenders, prepare))
    _, active, infeasible = filter_velocities(scene.position, scene.nominal[0], scene.hazards, scene.safety)
    facts = {
        "active_constraints_a_robot": float(active.mean()),
        "infeasible_robots": float(infeasible.sum()),
        "error_against_brute_force": brute_force_error(scene.position, scene.nominal[0], scene.hazards, scene.safety),
    }
    return Case(density, robots, taken, facts)


def _scene(spacing: float, robots: int) -> _Scene:
    rng = np.random.default_rng(robots)
    columns = math.ceil(math.sqrt(robots))
    grid = np.stack(np.divmod(np.arange(robots), columns), axis=1) * spacing
    jitter = 0.05 * spacing
    safety = SafetyParameters()
    gaps = spacing * (np.array(list(itertools.product(range(columns + 1), repeat=2))) - 0.5)
    rng.shuffle(gaps)
    fires, circles = gaps[:2], gaps[2 : 2 + max(2, robots // 10)]
    room = spacing / math.sqrt(2.0) - math.sqrt(2.0) * jitter - safety.obstacle_clearance
    edge = 0.5 * spacing + 2.0 * safety.obstacle_clearance
    sides = [[1.0, 0.0, -edge], [-1.0, 0.0, -columns * spacing - edge]]
    sides += [[0.0, 1.0, -edge], [0.0, -1.0, -columns * spacing - edge]]
    angle = rng.uniform(0.0, 2.0 * np.pi, (_NOMINALS, robots, 1))
    discs = floats(np.c_[circles, np.full(len(circles), 0.9 * room)])
    hazards = hazards_of(
        circles=discs,
        bars=floats([[-edge, -edge, -edge, columns * spacing, 1.0]]),
        walls=floats(sides),
        fires=floats(np.c_[fires, np.full(len(fires), 0.5 * room), np.ones(len(fires))]),
    )
    nominal = rng.uniform(0.2, 1.0, (_NOMINALS, robots, 1)) * safety.speed_limit
    position = floats(grid + rng.uniform(-jitter, jitter, (robots, 2)))
    directions = np.concatenate([np.cos(angle), np.sin(angle)], axis=2)
    return _Scene(position, floats(nominal * directions), discs, hazards, safety)


def _contenders(scene: _Scene) -> tuple[dict[str, _Turn], dict[str, _Turn]]:
    """The timed functions by name, and the untimed preparations of some of them."""
    coupled = CoupledFilter()
    position, nominal, _, hazards, safety = scene
    found: dict[str, _Turn] = {
        "distributed": lambda turn: filter_velocities(position, nominal[turn % _NOMINALS], hazards, safety),
        "coupled": lambda turn: coupled.filter_velocities(position, nominal[turn % _NOMINALS], hazards, safety),
    }
    prepare: dict[str, _Turn] = {}
    if daqp is not None:
        found["daqp"] = _by_daqp(scene)
    if RVOSimulator is not None:
        found["orca"], prepare["orca"] = _by_orca(scene)
    return found, prepare


def _by_daqp(scene: _Scene) -> _Turn:
    assert daqp is not None
    hessian, solve_one = np.eye(2), daqp.solve
    constraints = _all_constraints(survey(scene.position, scene.hazards, scene.safety))
    parts = [(np.ascontiguousarray(own[:, :2]), own[:, 2].copy()) for own in constraints]

    def solve(turn: int) -> list[Any]:
        velocity = -scene.nominal[turn % _NOMINALS]
        return [
            solve_one(hessian, velocity[i], matrix, bound) if len(bound) else None
            for i, (matrix, bound) in enumerate(parts)
        ]

    return solve


def _by_orca(scene: _Scene) -> tuple[_Turn, _Turn]:
    """One step of the simulator, and the preparation that restores positions and nominal velocities."""
    assert RVOSimulator is not None
    safety = scene.safety
    period, clearance, limit = safety.control_period, safety.robot_clearance, safety.speed_limit
    simulator = RVOSimulator()
    simulator.set_time_step(period)
    simulator.set_agent_defaults(2.0 * clearance, 10, 0.5, 0.5, clearance / 2.0, limit)
    for x, y, radius in scene.circles:
        corners = [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in np.arange(8) * math.pi / 4.0]
        simulator.add_obstacle(corners)
    simulator.process_obstacles()
    for x, y in scene.position:
        simulator.add_agent((float(x), float(y)))
    places = [(float(x), float(y)) for x, y in scene.position]
    nominal = [[(float(x), float(y)) for x, y in velocity] for velocity in scene.nominal]

    def restore(turn: int) -> None:
        for i, velocity in enumerate(nominal[turn % _NOMINALS]):
            simulator.set_agent_position(i, places[i])
            simulator.set_agent_pref_velocity(i, velocity)

    def step(_: int) -> None:
        simulator.do_step()

    return step, restore


def _all_constraints(around: Surroundings) -> list[Floats]:
    space = np.empty((most_constraints(around), 3))
    cause = np.empty((len(space), 2), np.int64)
    return [space[: constraints_of(i, around, space, cause)[0]].copy() for i in range(len(around.position))]


def brute_force_error(position: Floats, nominal: Floats, hazards: Floats, safety: SafetyParameters) -> float:
    """Largest difference between the exact projection and a brute-force search, as a share of v_max.

    Args:
        position: (N, 2) [m].
        nominal: (N, 2) within the speed limit [m/s].
        hazards: (H, 9) see `control.safety.hazards`.
        safety: clearances, rates and speed limit.
    """
    limit = safety.speed_limit
    worst = 0.0
    constraints = _all_constraints(survey(position, hazards, safety))
    for own, velocity in itertools.islice(zip(constraints, nominal, strict=True), _COMPARED):
        ux, uy, feasible = project(velocity[0], velocity[1], own, len(own), limit, np.empty(len(own), np.int64))
        expected = _searched(velocity, own, limit)
        if feasible != (expected is not None):
            return math.inf
        if expected is not None:
            worst = max(worst, math.hypot(ux - expected[0], uy - expected[1]) / limit)
    return worst


def _searched(velocity: Floats, constraints: Floats, limit: float) -> Floats | None:
    """The nearest feasible candidate to `velocity` (2,) [m/s]; None if the constraints (n, 3) are infeasible.

    Candidates are `velocity`, its projections onto the lines a.v = b, and the intersections of these lines with each
    other and with the circle of radius `limit`.
    """
    normal, bound = constraints[:, :2], constraints[:, 2]
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    feet = velocity - (normal @ velocity - bound)[:, None] * normal
    chord = np.sqrt(np.maximum(limit**2 - bound**2, 0.0))[:, None] * along
    tried = [velocity[None], feet, bound[:, None] * normal + chord, bound[:, None] * normal - chord]
    for i, j in itertools.combinations(range(len(constraints)), 2):
        if abs(normal[i] @ along[j]) > 1e-9:
            tried.append(floats(np.linalg.solve(normal[[i, j]], bound[[i, j]]), 1, 2))
    points = np.concatenate(tried)
    allowed = (points @ normal.T <= bound + 1e-9 * limit).all(axis=1) & (np.hypot(*points.T) <= limit * (1.0 + 1e-9))
    points = points[allowed]
    return points[np.argmin(((points - velocity) ** 2).sum(axis=1))] if len(points) else None
