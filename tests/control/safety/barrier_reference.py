"""The barrier constraints and their optimisation problems, slow and plain, as a reference for the compiled ones."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.hazards import hazards_of
from higvf_console.control.safety.safety_filter import filter_velocities
from higvf_console.core.arrays import Bools, Floats, Ints, floats

SAFETY = SafetyParameters()
POLYGON = 64  # sides by which a speed limit is replaced in linear programs


class Scene(NamedTuple):
    """A team among hazards; fires (B, 4) are x, y, radius [m], growth [m/s]."""

    position: Floats
    nominal: Floats
    circles: Floats
    bars: Floats
    walls: Floats
    fires: Floats
    safety: SafetyParameters

    def arguments(self) -> tuple[Floats, Floats, Floats, SafetyParameters]:
        """What a safety filter takes."""
        return self.position, self.nominal, hazards_of(self.circles, self.bars, self.walls, self.fires), self.safety


def scene(
    position: Sequence[Sequence[float]] | Floats,
    nominal: Sequence[Sequence[float]] | Floats,
    circles: Sequence[Sequence[float]] | Floats = (),
    bars: Sequence[Sequence[float]] | Floats = (),
    walls: Sequence[Sequence[float]] | Floats = (),
    fires: Sequence[Sequence[float]] | Floats = (),
    safety: SafetyParameters = SAFETY,
) -> Scene:
    """A scene whose burning fires are given as (x, y, radius, growth)."""
    return Scene(
        position=floats(position, -1, 2),
        nominal=floats(nominal, -1, 2),
        circles=floats(circles, -1, 3),
        bars=floats(bars, -1, 5),
        walls=floats(walls, -1, 3),
        fires=floats(fires, -1, 4),
        safety=safety,
    )


def filtered(given: Scene) -> tuple[Floats, Ints, Bools]:
    """What the distributed filter makes of a scene."""
    return filter_velocities(*given.arguments())


def random_scene(rng: np.random.Generator, robots: int) -> Scene:
    """A narrow place with growing fires, where some robots start in violation and some are trapped."""
    side = float(rng.choice([30.0, 60.0, 120.0]))
    position = rng.uniform(0.0, side, (robots, 2))
    if rng.random() < 0.5:
        packed = 26.0 * np.array([divmod(k, 3) for k in range(robots)], dtype=float)
        position = packed + rng.uniform(-1.0, 1.0, (robots, 2))
    circles, bars, fires = rng.integers(0, 3), rng.integers(0, 2), rng.integers(0, 3)
    walls = np.array([[1.0, 0.0, -rng.uniform(5.0, 40.0)], [-1.0, 0.0, -side - rng.uniform(5.0, 40.0)]])
    return scene(
        position,
        rng.normal(size=(robots, 2)) * rng.choice([5.0, 90.0]),
        np.c_[rng.uniform(-60.0, side + 60.0, (circles, 2)), rng.uniform(5.0, 30.0, circles)],
        np.c_[rng.uniform(-60.0, side + 60.0, (bars, 4)), rng.uniform(1.0, 10.0, bars)],
        walls[: rng.integers(0, 3)],
        np.c_[
            rng.uniform(-40.0, side + 40.0, (fires, 2)),
            rng.uniform(3.0, 30.0, fires),
            rng.choice([0.0, 1.0, 5.0], fires),
        ],
    )


def coupled_constraints(given: Scene) -> tuple[Floats, Floats]:
    """All rows A u <= b of the team, straight from the equations: A (R, 2 N), b (R,)."""
    p, s = given.position, given.safety
    lines: list[Floats] = []
    bounds: list[float] = []

    def class_k(h: float) -> float:
        return h**3 if h >= 0.0 else h

    def add(i: int, normal: Floats, bound: float, j: int = -1) -> None:
        line = np.zeros(p.size)
        line[2 * i : 2 * i + 2] = normal
        if j >= 0:
            line[2 * j : 2 * j + 2] = -normal
        lines.append(line)
        bounds.append(max(bound, -s.speed_limit * (2.0 if j >= 0 else 1.0)))

    def add_obstacle(i: int, r: Floats, radius: float, rate: float = 0.0) -> None:
        clearance, distance = radius + s.obstacle_clearance, math.hypot(*r)
        grown = (clearance + rate * s.control_period) ** 2 - clearance**2
        margin = 0.5 * s.obstacle_gain * clearance**2 * class_k(distance**2 / clearance**2 - 1.0)
        add(i, -r / distance, (margin - grown / (2.0 * s.control_period)) / distance)

    for i in range(len(p)):
        for j in range(i + 1, len(p)):
            r = p[i] - p[j]
            distance = math.hypot(*r)
            h = distance**2 / s.robot_clearance**2 - 1.0
            add(i, -r / distance, 0.5 * s.pair_gain * s.robot_clearance**2 * class_k(h) / distance, j)
        for x, y, radius in given.circles:
            add_obstacle(i, p[i] - (x, y), radius)
        for bar in given.bars:
            a, along = bar[:2], bar[2:4] - bar[:2]
            share = min(max(float((p[i] - a) @ along / (along @ along)), 0.0), 1.0)
            add_obstacle(i, p[i] - a - share * along, bar[4])
        for x, y, offset in given.walls:
            h = (x * p[i, 0] + y * p[i, 1] - offset) / s.obstacle_clearance - 1.0
            add(i, np.array([-x, -y]), s.obstacle_gain * s.obstacle_clearance * class_k(h))
        for x, y, radius, growth in given.fires:
            add_obstacle(i, p[i] - (x, y), radius, growth)
    return np.array(lines).reshape(-1, p.size), np.array(bounds)


def half_constraints(given: Scene) -> tuple[Floats, Floats]:
    """The distributed rows: every pair row split into its two halves."""
    matrix, bound = coupled_constraints(given)
    lines: list[Floats] = []
    bounds: list[float] = []
    for line, b in zip(matrix, bound, strict=True):
        robots = np.flatnonzero(np.abs(line).reshape(-1, 2).sum(axis=1))
        for robot in robots:
            half = np.zeros_like(line)
            half[2 * robot : 2 * robot + 2] = line[2 * robot : 2 * robot + 2]
            lines.append(half)
            bounds.append(b / len(robots))
    return np.array(lines).reshape(-1, matrix.shape[1]), np.array(bounds)


def least_violation(matrix: Floats, bound: Floats, speed_limit: float) -> float:
    """The smallest largest violation of the rows, the speed limit replaced by a polygon within it."""
    robots = matrix.shape[1] // 2
    angle = 2.0 * np.pi / POLYGON * np.arange(POLYGON)
    sides = np.kron(np.eye(robots), np.c_[np.cos(angle), np.sin(angle)])
    apothem = speed_limit * math.cos(np.pi / POLYGON)
    result = linprog(
        np.r_[np.zeros(2 * robots), 1.0],
        A_ub=np.r_[np.c_[matrix, -np.ones(len(matrix))], np.c_[sides, np.zeros(len(sides))]],
        b_ub=np.r_[bound, np.full(len(sides), apothem)],
        bounds=[(None, None)] * (2 * robots) + [(-speed_limit, None)],
        method="highs",
    )
    return float(result.fun)


def projection_by_enumeration(velocity: Floats, rows: Floats, speed_limit: float) -> Floats | None:
    """The nearest velocity among all points where it can be: tops of rows, their corners, their ends on the disc."""
    speed = math.hypot(*velocity)
    wanted = velocity if speed <= speed_limit else velocity * speed_limit / speed
    normal, bound = rows[:, :2], rows[:, 2]
    tried = [wanted]
    for k in range(len(rows)):
        tried.append(wanted - (normal[k] @ wanted - bound[k]) * normal[k])
        if abs(bound[k]) <= speed_limit:
            end = math.sqrt(speed_limit**2 - bound[k] ** 2) * np.array([-normal[k, 1], normal[k, 0]])
            tried += [bound[k] * normal[k] + end, bound[k] * normal[k] - end]
    pairs = np.stack(np.tril_indices(len(rows), -1), axis=1)
    pairs = pairs[np.abs(np.linalg.det(normal[pairs])) > 1e-9]
    points = np.concatenate([np.array(tried), np.linalg.solve(normal[pairs], bound[pairs][..., None])[..., 0]])
    allowed = (points @ normal.T <= bound + 1e-9 * speed_limit).all(axis=1)
    allowed &= np.hypot(*points.T) <= speed_limit * (1.0 + 1e-9)
    if not allowed.any():
        return None
    points = points[allowed]
    return points[np.argmin(((points - wanted) ** 2).sum(axis=1))]


def clearance(given: Scene) -> float:
    """Smallest distance beyond the clearance between robots, to obstacles, fires and walls [m]."""
    p, s = given.position, given.safety
    gaps = [math.inf]
    for i in range(len(p)):
        gaps += [math.dist(p[i], p[j]) - s.robot_clearance for j in range(i)]
        gaps += [math.dist(p[i], c[:2]) - c[2] - s.obstacle_clearance for c in given.circles]
        for bar in given.bars:
            a, along = bar[:2], bar[2:4] - bar[:2]
            share = min(max(float((p[i] - a) @ along / (along @ along)), 0.0), 1.0)
            gaps.append(math.dist(p[i], a + share * along) - bar[4] - s.obstacle_clearance)
        gaps += [float(w[:2] @ p[i]) - w[2] - s.obstacle_clearance for w in given.walls]
        gaps += [math.dist(p[i], fire[:2]) - fire[2] - s.obstacle_clearance for fire in given.fires]
    return min(gaps)


def speeds(velocity: Floats) -> Floats:
    """(N,) [m/s]."""
    return np.hypot(velocity[:, 0], velocity[:, 1])
