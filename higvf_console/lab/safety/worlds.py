"""Seeded random worlds as scenario files: obstacles of all kinds, still and moving, growing fires, all kinds of robots.

A world may be anything that a scenario file may say and that the console accepts as a start: fires and obstacles may
come faster than robots can yield, gaps may be too narrow, noise may reach its limit.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from higvf_console.core.errors import ScenarioError
from higvf_console.core.reading.document import yaml_text
from higvf_console.scenario.scenario import Scenario, parse_scenario
from higvf_console.scenario.sections import FilterKind

_NOISIEST = 0.8  # [m]; a world whose noise exceeds its limit is refused and drawn anew
_TRIES = 20  # to place something clear of the team
_Content = dict[str, Any]


def random_world(rng: np.random.Generator, name: str, kind: FilterKind = FilterKind.DISTRIBUTED) -> Scenario:
    """A random world that the console accepts; the same generator gives the same text.

    Args:
        rng: source of the random numbers.
        name: of the scenario.
        kind: which safety filter runs.
    """
    while True:
        content = {**_world(rng, name), "filter": kind.value}
        try:
            scenario = parse_scenario(yaml_text(content), name)
            scenario.setup(0)
        except ScenarioError:
            continue  # robots on obstacles, parameters that do not fit: the console refuses it, and so there is no run
        return scenario


class _Ground(NamedTuple):
    """Where things may be placed: in the arena, and mostly clear of the team.

    Attributes:
        width: of the arena [m].
        height: of the arena [m].
        centre: of the team [m].
        reach: of the team with its clearances [m].
    """

    width: float
    height: float
    centre: tuple[float, float]
    reach: float

    def place(self, rng: np.random.Generator, size: float = 0.0) -> list[float]:
        """A point [m]; what has so large a size [m] does not reach the team there, if a few tries find such a point."""
        x = y = 0.0
        for _ in range(_TRIES):
            x, y = rng.uniform(0.0, self.width), rng.uniform(0.0, self.height)
            if math.hypot(x - self.centre[0], y - self.centre[1]) > self.reach + size:
                break
        return _rounded([x, y])


def _world(rng: np.random.Generator, name: str) -> _Content:
    width, height = rng.uniform(300.0, 900.0), rng.uniform(250.0, 600.0)
    count, spacing = int(rng.integers(1, 9)), round(rng.uniform(26.0, 60.0), 2)
    radius = 0.75 * spacing * math.ceil(math.sqrt(count))
    centre = tuple(
        _rounded([rng.uniform(min(radius, side / 2), max(side - radius, side / 2)) for side in (width, height)])
    )
    ground = _Ground(width, height, (centre[0], centre[1]), radius + 15.0)
    return {
        "version": 1,
        "name": name,
        "arena": {"size_m": _rounded([width, height]), "walls": bool(rng.random() < 0.8)},
        "robots": {
            "count": count,
            "spacing_m": spacing,
            "centre_m": list(centre),
            "heading_deg": round(rng.uniform(-180.0, 180.0), 1),
        },
        "fires": [_fire(rng, count, ground) for _ in range(int(rng.integers(0, 4)))],
        "obstacles": {
            "circles": [_circle(rng, ground) for _ in range(int(rng.integers(0, 4)))],
            "bars": [_bar(rng, ground) for _ in range(int(rng.integers(0, 3)))],
            "polygons": [_polygon(rng, ground) for _ in range(int(rng.integers(0, 2)))],
        },
        "influenced": int(rng.integers(1, count + 1)),
        "parameters": _parameters(rng),
        "forms": "zero-in" if rng.random() < 0.1 else "corrected",
        "duration_s": 600.0,
    }


def _parameters(rng: np.random.Generator) -> _Content:
    if rng.random() < 0.4:
        return {}
    cruise = rng.uniform(5.0, 100.0)
    found: _Content = {
        "blending": {"cruise_speed": cruise},
        "safety": {
            "speed_limit": cruise * rng.uniform(0.8, 2.0),
            "robot_clearance": rng.uniform(8.0, 30.0),
            "obstacle_clearance": rng.uniform(4.0, 16.0),
            "pair_gain": 10.0 ** rng.uniform(-0.5, 1.7),
            "obstacle_gain": 10.0 ** rng.uniform(-0.5, 1.7),
            "control_period": float(rng.choice([0.01, 0.02, 0.02, 0.05])),
        },
        "formation": {"formation_rate": rng.uniform(0.0, 1.0)},
        "fires": {"stand_off": rng.uniform(15.0, 40.0), "start_delay": float(rng.choice([0.0, 2.0]))},
    }
    if rng.random() < 0.3:
        found["formation"]["communication_range"] = rng.uniform(40.0, 200.0)
    if rng.random() < 0.6:
        found["robots"] = _disturbed(rng)
    return found


def _disturbed(rng: np.random.Generator) -> _Content:
    unicycles = rng.random() < 0.5
    return {
        "look_ahead": rng.uniform(2.0, 8.0) if unicycles else 0.0,
        **({"turn_rate_limit": rng.uniform(1.0, 8.0)} if unicycles else {}),
        "position_noise": rng.uniform(0.0, _NOISIEST) if rng.random() < 0.5 else 0.0,
        "packet_loss": rng.uniform(0.0, 1.0) if rng.random() < 0.5 else 0.0,
    }


def _fire(rng: np.random.Generator, robots: int, ground: _Ground) -> _Content:
    growth = rng.uniform(0.0, 3.0) if rng.random() < 0.8 else rng.uniform(0.0, 100.0)
    radius = round(rng.uniform(2.0, 40.0), 2)
    return {
        "at_m": ground.place(rng, radius),
        "radius_m": radius,
        "growth_m_per_s": round(growth, 3),
        "robots_needed": int(rng.integers(1, robots + 1)),
    }


def _circle(rng: np.random.Generator, ground: _Ground) -> _Content:
    radius = round(rng.uniform(1.0, 45.0), 2)
    return {"at_m": ground.place(rng, radius), "radius_m": radius, **_course(rng, ground)}


def _bar(rng: np.random.Generator, ground: _Ground) -> _Content:
    half, angle = rng.uniform(5.0, 100.0), rng.uniform(0.0, math.pi)
    along = half * math.cos(angle), half * math.sin(angle)
    x, y = ground.place(rng, half)
    return {
        "from_m": _rounded([x - along[0], y - along[1]]),
        "to_m": _rounded([x + along[0], y + along[1]]),
        "half_width_m": round(rng.uniform(1.0, 10.0), 2),
        **_course(rng, ground),
    }


def _course(rng: np.random.Generator, ground: _Ground) -> _Content:
    """How an obstacle moves; half of them stand still, and a few are faster than robots."""
    if rng.random() < 0.5:
        return {}
    speed = rng.uniform(1.0, 40.0) if rng.random() < 0.8 else rng.uniform(1.0, 100.0)
    if rng.random() < 0.3:
        angle = rng.uniform(0.0, 2.0 * math.pi)
        return {"velocity_m_per_s": _rounded([0.99 * speed * math.cos(angle), 0.99 * speed * math.sin(angle)])}
    points = [ground.place(rng, -math.inf) for _ in range(int(rng.integers(1, 4)))]
    return {"path_m": points, "speed_m_per_s": round(speed, 2), "loop": bool(rng.random() < 0.5)}


def _polygon(rng: np.random.Generator, ground: _Ground) -> _Content:
    size = rng.uniform(8.0, 60.0)
    x, y = ground.place(rng, size)
    return {"points_m": _rounded(outline(rng, x, y, size))}


def outline(rng: np.random.Generator, x: float, y: float, size: float) -> Any:
    """Corners (n, 2) round a point, at 0.3 to 1 of a size [m]."""
    count = int(rng.integers(3, 9))
    angle = (np.arange(count) + rng.uniform(-0.35, 0.35, count)) * 2.0 * math.pi / count
    radius = size * rng.uniform(0.3, 1.0, count)
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


def _rounded(values: Any) -> Any:
    return np.round(values, 2).tolist()
