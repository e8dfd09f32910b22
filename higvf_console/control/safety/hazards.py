"""Hazards: all that a robot keeps clear of, other robots apart, as one table that everything about safety reads.

    table                       one row per hazard: obstacles, walls, burning fires, in this order
    hazard_constraint           the linear constraint a.v <= b of one row
    hazard_outruns              whether it comes faster than a robot can retreat
    hazard_activation_distance  from where on it cannot matter; infinite for a wall, of which `hazard_matters` decides
    hazard_gap, hazard_word     how far its surface is, and what people call it

What depends on the kind of a hazard is decided here alone; whoever reads the table calls these functions.

A row is kind, ax, ay, bx, by, radius, vx, vy, growth: a capsule round the spine a-b [m] (of a circle or a fire a
point), its velocity [m/s] and the growth of its radius [m/s] over the coming control period. A wall has its unit inward
normal in ax, ay and its offset w in `radius`: inside means n.p >= w.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from higvf_console.control.forms import PRINTED
from higvf_console.control.guidance.obstacles import capsule_table, spine_point
from higvf_console.control.kernel import kernel
from higvf_console.control.parameters import SafetyParameters
from higvf_console.control.safety.barriers.arena import wall_constraint
from higvf_console.control.safety.barriers.capsule import (
    capsule_activation_distance,
    capsule_constraint,
    capsule_outruns,
)
from higvf_console.control.safety.barriers.linear_constraint import class_k
from higvf_console.core.arrays import Bools, Floats, bools, floats
from higvf_console.core.state import MOVER_PART, MOVER_SPEED, World

OBSTACLE, WALL, FIRE = 0, 1, 2  # kinds
KIND, AX, AY, BX, BY, RADIUS, VX, VY, GROWTH = range(9)  # columns
COLUMNS = 9


def hazards_of(circles: ArrayLike, bars: ArrayLike, walls: ArrayLike, fires: ArrayLike) -> Floats:
    """The table of hazards (H, 9) that stand still, for tests, benchmarks and scripts.

    Args:
        circles: (P, 3) x, y, radius [m].
        bars: (Q, 5) ax, ay, bx, by, half width [m].
        walls: (W, 3) unit inward normal and offset [m].
        fires: (B, 4) burning ones: x, y, radius [m], growth [m/s].
    """
    fire = floats(fires, -1, 4)
    position, radius, growth = floats(fire[:, :2]), floats(fire[:, 2]), floats(fire[:, 3])
    capsules = capsule_table(circles, bars)
    still, burning = np.zeros((len(capsules), 2)), bools([True] * len(fire))
    return hazard_table(capsules, still, floats(walls, -1, 3), position, radius, growth, burning)


def worst_hazards(world: World, fire_radius: Floats) -> Floats:
    """The table of hazards (H, 9) of a world whose fires, of radii (M,) [m], all burn; each as fast as it ever is."""
    burning, fastest = bools([True] * len(fire_radius)), np.zeros((len(world.capsules), 2))
    fastest[world.mover[:, MOVER_PART].astype(np.int64), 0] = world.mover[:, MOVER_SPEED]
    return hazard_table(
        world.capsules, fastest, world.walls, world.fire_position, fire_radius, world.fire_growth, burning
    )  # fmt: skip


@kernel
def hazard_table(
    capsules: Floats, velocity: Floats, walls: Floats, fire_position: Floats, fire_radius: Floats,
    fire_growth: Floats, fire_burning: Bools,
) -> Floats:  # fmt: skip
    """The table of hazards (H, 9).

    Args:
        capsules: (K, 5) obstacles: spine ax, ay, bx, by and radius [m].
        velocity: (K, 2) of the obstacles over the coming control period [m/s].
        walls: (W, 3) unit inward normal and offset [m].
        fire_position: (M, 2) [m].
        fire_radius: (M,) [m].
        fire_growth: (M,) over the coming control period [m/s].
        fire_burning: (M,) extinguished fires are no hazards.
    """
    burning = 0
    for j in range(fire_burning.shape[0]):
        burning += fire_burning[j]
    hazards = np.zeros((capsules.shape[0] + walls.shape[0] + burning, COLUMNS))
    row = 0
    for k in range(capsules.shape[0]):
        for column in range(5):
            hazards[row, AX + column] = capsules[k, column]
        hazards[row, VX], hazards[row, VY] = velocity[k, 0], velocity[k, 1]
        row += 1
    for k in range(walls.shape[0]):
        hazards[row, KIND] = WALL
        hazards[row, AX], hazards[row, AY], hazards[row, RADIUS] = walls[k, 0], walls[k, 1], walls[k, 2]
        row += 1
    for j in range(fire_position.shape[0]):
        if fire_burning[j]:
            hazards[row, KIND] = FIRE
            hazards[row, AX] = hazards[row, BX] = fire_position[j, 0]
            hazards[row, AY] = hazards[row, BY] = fire_position[j, 1]
            hazards[row, RADIUS], hazards[row, GROWTH] = fire_radius[j], fire_growth[j]
            row += 1
    return hazards


@kernel
def hazard_constraint(
    x: float, y: float, hazards: Floats, k: int, safety: SafetyParameters
) -> tuple[float, float, float]:
    """The linear constraint of hazard k on the velocity of a robot at (x, y) [m].

    Returns:
        ax, ay, b of a.v <= b with a unit vector a; b is not limited to what the robot can do.
    """
    kind = hazards[k, KIND]
    if kind == WALL:
        return wall_constraint(x, y, hazards[k, AX], hazards[k, AY], hazards[k, RADIUS], safety)
    ax, ay, b = capsule_constraint(
        x, y, hazards[k, AX], hazards[k, AY], hazards[k, BX], hazards[k, BY], float(hazards[k, RADIUS]),
        hazards[k, VX], hazards[k, VY], float(hazards[k, GROWTH]), safety,
    )  # fmt: skip
    if safety.h_index == PRINTED and kind == OBSTACLE:
        return ax, ay, _misindexed(x, y, hazards, safety)
    return ax, ay, b


@kernel
def hazard_outruns(x: float, y: float, hazards: Floats, k: int, safety: SafetyParameters) -> bool:
    """Whether hazard k comes to a robot at (x, y) [m] faster than any robot can retreat; a wall never does."""
    return hazards[k, KIND] != WALL and capsule_outruns(
        x, y, hazards[k, AX], hazards[k, AY], hazards[k, BX], hazards[k, BY], float(hazards[k, RADIUS]),
        hazards[k, VX], hazards[k, VY], float(hazards[k, GROWTH]), safety,
    )  # fmt: skip


@kernel
def hazard_activation_distance(hazards: Floats, k: int, safety: SafetyParameters) -> float:
    """Distance [m] from hazard k's spine at which its constraint stops to matter; inf for a wall."""
    if hazards[k, KIND] == WALL:
        return math.inf
    return capsule_activation_distance(
        float(hazards[k, RADIUS]), hazards[k, VX], hazards[k, VY], float(hazards[k, GROWTH]), safety
    )


@kernel
def within_distance(x: float, y: float, hazards: Floats, k: int, distance: float) -> bool:
    """Whether (x, y) is nearer than `distance` [m] to hazard k's spine; a wall is always near."""
    if hazards[k, KIND] == WALL:
        return True
    near_x, near_y = spine_point(x, y, hazards[k, AX], hazards[k, AY], hazards[k, BX], hazards[k, BY])
    return (x - near_x) ** 2 + (y - near_y) ** 2 < distance * distance


@kernel
def hazard_matters(hazards: Floats, k: int, b: float, speed_limit: float) -> bool:
    """Whether a.v <= b of hazard k can constrain a robot that is near; everybody is near a wall, so its b decides."""
    return hazards[k, KIND] != WALL or b < speed_limit


def bounded(hazards: Floats) -> Bools:
    """(H,) which hazards have an activation distance; a wall has none."""
    return hazards[:, KIND] != WALL


def radius_varies(hazards: Floats) -> Bools:
    """(H,) which hazards have a radius of their own in every tick: fires."""
    return hazards[:, KIND] == FIRE


def hazard_gap(x: float, y: float, hazard: Floats) -> float:
    """Distance [m] from (x, y) to the surface of a hazard (9,); negative inside an obstacle, or beyond a wall."""
    if hazard[KIND] == WALL:
        return float(hazard[AX] * x + hazard[AY] * y - hazard[RADIUS])
    near_x, near_y = spine_point(x, y, hazard[AX], hazard[AY], hazard[BX], hazard[BY])
    return float(((x - near_x) ** 2 + (y - near_y) ** 2) ** 0.5 - hazard[RADIUS])


def hazard_word(hazard: Floats) -> str:
    """What people call a hazard (9,): "circle", "bar", "fire" or "wall"."""
    if hazard[KIND] == WALL:
        return "wall"
    if hazard[KIND] == FIRE:
        return "fire"
    return "circle" if hazard[AX] == hazard[BX] and hazard[AY] == hazard[BY] else "bar"


@kernel
def _misindexed(x: float, y: float, hazards: Floats, safety: SafetyParameters) -> float:
    """[27] as printed has h_ij for h_ik: all obstacles get the margin of one, here of the first. Bound b [m/s]."""
    near_x, near_y = spine_point(x, y, hazards[0, AX], hazards[0, AY], hazards[0, BX], hazards[0, BY])
    clearance = hazards[0, RADIUS] + safety.obstacle_clearance
    square = (x - near_x) ** 2 + (y - near_y) ** 2
    margin = 0.5 * safety.obstacle_gain * clearance * clearance * class_k(square / (clearance * clearance) - 1.0)
    return margin / math.sqrt(square)
