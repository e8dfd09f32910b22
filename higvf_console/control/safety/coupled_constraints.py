"""The rows of the whole team as one list that stays the same for many ticks, so that a solver keeps its structure.

A Verlet list: everything that is near enough to matter, and a skin more. It holds while no robot has moved, and no fire
has grown, by half the skin; only the numbers in the rows change in the meantime.
"""

import numpy as np

from higvf_console.control.guidance.obstacles import spine_point
from higvf_console.control.intention.neighbours import within
from higvf_console.control.kernel import kernel
from higvf_console.control.safety.barriers.arena import wall_constraint
from higvf_console.control.safety.barriers.fire import fire_constraint
from higvf_console.control.safety.barriers.obstacle import capsule_constraint, circle_constraint
from higvf_console.control.safety.barriers.robot_pair import pair_constraint, sensing_radius
from higvf_console.control.safety.barriers.surroundings import Surroundings
from higvf_console.control.safety.nearest_point import Constraints, empty_constraints
from higvf_console.core.arrays import Ints

_PAIR, _CIRCLE, _BAR, _WALL, _FIRE = 0, 1, 2, 3, 4


@kernel
def constraint_list(around: Surroundings, skin: float) -> Ints:
    """Every row that can matter before something has moved half the skin.

    Args:
        around: from `barriers.surroundings.survey`.
        skin: [m].

    Returns:
        (R, 3) kind, robot, and index of the other robot, obstacle or fire; for `listed_constraints`.
    """
    position = around.position
    start, to = within(position, sensing_radius(around.safety) + skin)
    still = around.circles.shape[0] + around.bars.shape[0] + around.walls.shape[0] + around.fires.shape[0]
    listing = np.empty((to.shape[0] + position.shape[0] * still, 3), np.int64)
    used = 0
    for i in range(position.shape[0]):
        for k in range(start[i], start[i + 1]):
            if to[k] > i:
                used = _listed(listing, used, _PAIR, i, to[k])
        x, y = position[i, 0], position[i, 1]
        for k in range(around.circles.shape[0]):
            if _near(x, y, around.circles[k, 0], around.circles[k, 1], around.circle_activation[k], skin):
                used = _listed(listing, used, _CIRCLE, i, k)
        for k in range(around.bars.shape[0]):
            bar = around.bars[k]
            near_x, near_y = spine_point(x, y, bar[0], bar[1], bar[2], bar[3])
            if _near(x, y, near_x, near_y, around.capsule_activation[k], skin):
                used = _listed(listing, used, _BAR, i, k)
        for k in range(around.walls.shape[0]):
            used = _listed(listing, used, _WALL, i, k)
        for k in range(around.fires.shape[0]):
            if _near(x, y, around.fires[k, 0], around.fires[k, 1], around.fire_activation_distance[k], skin):
                used = _listed(listing, used, _FIRE, i, k)
    return listing[:used].copy()


@kernel
def listed_constraints(listing: Ints, around: Surroundings) -> Constraints:
    """The coupled rows of a list at the present positions: a.u_i <= b, and a.(u_i - u_j) <= 2 b for pairs, [22]."""
    rows = empty_constraints(around.position.shape[0], listing.shape[0])
    position, safety = around.position, around.safety
    for r in range(listing.shape[0]):
        kind, i, k = listing[r, 0], listing[r, 1], listing[r, 2]
        x, y = position[i, 0], position[i, 1]
        rows.ends[r, 0] = i
        if kind == _PAIR:
            rows.ends[r, 1] = k
            ax, ay, b = pair_constraint(x, y, position[k, 0], position[k, 1], True, safety)
            b *= 2.0
        elif kind == _CIRCLE:
            circle = around.circles[k]
            ax, ay, b = circle_constraint(x, y, circle[0], circle[1], circle[2], safety)
        elif kind == _BAR:
            bar = around.bars[k]
            ax, ay, b = capsule_constraint(x, y, bar[0], bar[1], bar[2], bar[3], bar[4], safety)
        elif kind == _WALL:
            wall = around.walls[k]
            ax, ay, b = wall_constraint(x, y, wall[0], wall[1], wall[2], safety)
        else:
            fire = around.fires[k]
            ax, ay, b = fire_constraint(x, y, fire[0], fire[1], fire[2], fire[3], safety)
        rows.row[r, 0], rows.row[r, 1], rows.row[r, 2] = ax, ay, b
    return rows


@kernel
def _near(x: float, y: float, other_x: float, other_y: float, square: float, skin: float) -> bool:
    far = np.sqrt(square) + skin
    return (x - other_x) ** 2 + (y - other_y) ** 2 < far * far


@kernel
def _listed(listing: Ints, used: int, kind: int, robot: int, other: int) -> int:
    listing[used, 0], listing[used, 1], listing[used, 2] = kind, robot, other
    return used + 1
