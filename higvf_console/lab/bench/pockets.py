"""Random scenes with a U-shaped obstacle that opens towards the team and blocks the way to the end of the path.

One team in three starts inside the U. It consists of three bars or one polygon, is 90 to 220 m wide and 60 to 200 m
deep, and has a random orientation. Up to 5 obstacles and 1 or 2 fires lie around it, spaced as in `Kind.POCKETS`.
"""

import math
from typing import NamedTuple

import numpy as np

from higvf_console.core.arrays import Floats, floats
from higvf_console.core.viewport import Arena
from higvf_console.lab.bench.geometry import hull, polygon
from higvf_console.lab.bench.scenes import (
    END_CLEARANCE,
    GAPS,
    START_CLEARANCE,
    Kind,
    Obstacles,
    Scene,
    centimetres,
    compact_team,
    final_shape,
    finely,
    packed_scene,
    place_all,
    rotated,
    surface_distance,
    wavy_stroke,
)

_MARGIN = 220.0  # from the team, the U and the end of the path to the walls [m]


class _Pocket(NamedTuple):
    """A U that opens towards -x, with its opening centred at the origin: inner width and depth, half a wall [m]."""

    width: float
    depth: float
    half_wall: float


def pocket_scene(seed: int) -> Scene:
    """A scene of `Kind.POCKETS`."""
    rng = np.random.default_rng([list(Kind).index(Kind.POCKETS), seed])
    while True:
        scene = _tried(rng, seed)
        if scene is not None:
            return scene


def _tried(rng: np.random.Generator, seed: int) -> Scene | None:
    inside = bool(rng.random() < 1.0 / 3.0)
    pocket, robots = _team_inside(rng) if inside else _team_before(rng)
    end = np.array([pocket.depth + rng.uniform(150.0, 350.0), rng.uniform(-0.25, 0.25) * pocket.width])
    turn = rng.uniform(0.0, 2.0 * math.pi)
    pieces = _walls(pocket) if rng.random() < 0.5 else [_outline(pocket)]
    everything = rotated(np.vstack([robots, end[None], _outline(pocket)]), turn)
    shift = _MARGIN - everything.min(axis=0)
    arena = Arena(0.0, 0.0, *(math.ceil(size) for size in everything.max(axis=0) + shift + _MARGIN))

    def placed(points: Floats) -> Floats:
        return centimetres(rotated(points.reshape(-1, 2), turn) + shift)

    found = Obstacles([], [], [], [], [])
    for piece in pieces:
        if piece.ndim == 2:
            found.polygons.append(placed(piece))
        else:
            found.bars.append(floats([*placed(piece[:4]).ravel(), piece[4]]))
    found.shapes.append(hull(polygon(placed(_outline(pocket)))))  # keeps all other obstacles out of the pocket
    team, goal = placed(robots), placed(end)[0]
    influenced = int(rng.integers(len(team)))
    stroke = wavy_stroke(rng, team[influenced], goal, int(rng.integers(3, 7)), 15.0)
    walls = [final_shape(piece) for piece in (*found.bars, *found.polygons)]
    if surface_distance(finely(stroke), walls).min() >= 0.0:
        return None
    fires, count = int(rng.integers(1, 3)), int(rng.integers(0, 6))
    if not place_all(rng, arena, found, team, GAPS[Kind.POCKETS], fires, count):
        return None
    if surface_distance(goal[None], [hull(shape) for shape in found.shapes]).min() < END_CLEARANCE:
        return None
    return packed_scene(Kind.POCKETS, seed, arena, team, influenced, found, stroke)


def _team_inside(rng: np.random.Generator) -> tuple[_Pocket, Floats]:
    """A U, and 3 to 6 robots (N, 2) [m] inside it."""
    robots = compact_team(rng, int(rng.integers(3, 7)), columns=2)
    length, width = np.ptp(robots, axis=0) + 2.0 * START_CLEARANCE + 1.0
    pocket = _Pocket(
        rng.uniform(max(90.0, width), 220.0), rng.uniform(max(60.0, length), 200.0), rng.uniform(3.0, 10.0)
    )
    spare = pocket.depth - length
    return pocket, robots + np.array([length / 2.0 + rng.uniform(0.0, spare), 0.0])


def _team_before(rng: np.random.Generator) -> tuple[_Pocket, Floats]:
    """A U, and 3 to 10 robots (N, 2) [m] before its opening."""
    pocket = _Pocket(rng.uniform(90.0, 220.0), rng.uniform(60.0, 200.0), rng.uniform(3.0, 10.0))
    robots = compact_team(rng, int(rng.integers(3, 11)))
    return pocket, robots - np.array([rng.uniform(60.0, 150.0) + robots[:, 0].max(), 0.0])


def _walls(pocket: _Pocket) -> list[Floats]:
    """The U as three bars (5,) [m]: leg, base, leg."""
    leg, base = pocket.width / 2.0 + pocket.half_wall, pocket.depth + pocket.half_wall
    ends = [(0.0, -leg, base, -leg), (base, -leg, base, leg), (base, leg, 0.0, leg)]
    return [floats([*line, round(pocket.half_wall, 2)]) for line in ends]


def _outline(pocket: _Pocket) -> Floats:
    """The U as one polygon (8, 2) [m]."""
    inner, wall = pocket.width / 2.0, 2.0 * pocket.half_wall
    outer, base = inner + wall, pocket.depth + wall
    upper = [(pocket.depth, inner), (0.0, inner), (0.0, outer), (base, outer)]
    return floats([*[(x, -y) for x, y in reversed(upper)], *upper])
