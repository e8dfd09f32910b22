"""Neighbour lists by a cell list, and connected components.

The lists have the CSR format: the neighbours of robot i are `to[start[i]:start[i + 1]]`, sorted by index. Sorting costs
nothing extra: the relation is symmetric, so transposing the unsorted lists fills each one in the order of the robots.
"""

import math

import numpy as np

from higvf_console.control.kernel import kernel
from higvf_console.core.arrays import Floats, Ints


@kernel
def within(position: Floats, max_distance: float) -> tuple[Ints, Ints]:
    """Lists the neighbours of every robot within a distance, in O(N) for bounded density.

    A robot whose position is not finite has no neighbours.

    Args:
        position: (N, 2) [m].
        max_distance: largest distance of neighbours [m]; inf gives the complete graph.

    Returns:
        start (N + 1,) and to (E,): robot i's neighbours are `to[start[i]:start[i + 1]]`, sorted by index.
    """
    columns, rows, x_min, y_min, width = _grid(position, max_distance)
    if columns * rows <= 9:
        return _among_all(position, max_distance)
    cell, cell_start, members = _cells(position, columns, rows, x_min, y_min, width)
    count = position.shape[0]
    square = max_distance * max_distance
    start = np.zeros(count + 1, np.int64)
    to = np.empty(8 * count, np.int64)
    used = 0
    for i in range(count):
        if cell[i] >= 0:
            column, row = cell[i] % columns, cell[i] // columns
            for near_row in range(max(row - 1, 0), min(row + 2, rows)):
                first = cell_start[near_row * columns + max(column - 1, 0)]
                last = cell_start[near_row * columns + min(column + 1, columns - 1) + 1]
                if used + last - first > to.shape[0]:
                    to = np.concatenate((to, np.empty(to.shape[0] + last - first, np.int64)))
                for k in range(first, last):
                    j = members[k]
                    dx, dy = position[i, 0] - position[j, 0], position[i, 1] - position[j, 1]
                    if dx * dx + dy * dy <= square and j != i:
                        to[used] = j
                        used += 1
        start[i + 1] = used
    return start, _transposed(start, to)


@kernel
def components(start: Ints, to: Ints) -> Ints:
    """Connected component (N,) of each robot in symmetric neighbour lists, named by its smallest robot index."""
    count = start.shape[0] - 1
    label = np.full(count, -1, np.int64)
    stack = np.empty(count, np.int64)
    for seed in range(count):
        if label[seed] < 0:
            label[seed] = seed
            stack[0] = seed
            height = 1
            while height > 0:
                height -= 1
                i = stack[height]
                for k in range(start[i], start[i + 1]):
                    j = to[k]
                    if label[j] < 0:
                        label[j] = seed
                        stack[height] = j
                        height += 1
    return label


@kernel
def _grid(position: Floats, max_distance: float) -> tuple[int, int, float, float, float]:
    """Columns, rows, origin [m] and width [m] of O(N) square cells, at least `max_distance` wide; few robots: one."""
    count = position.shape[0]
    x_min, x_max, y_min, y_max = np.inf, -np.inf, np.inf, -np.inf
    for i in range(count):
        x, y = position[i, 0], position[i, 1]
        if math.isfinite(x) and math.isfinite(y):
            x_min, x_max = min(x_min, x), max(x_max, x)
            y_min, y_max = min(y_min, y), max(y_max, y)
    across, up = x_max - x_min, y_max - y_min
    if not (count > 16 and max_distance >= 0.0 and across >= 0.0):
        return 1, 1, 0.0, 0.0, 1.0
    width = max(max_distance * (1.0 + 1e-9), math.sqrt(across * up / count), max(across, up) / count)
    if not 0.0 < width < np.inf:
        return 1, 1, 0.0, 0.0, 1.0
    return int(across / width) + 1, int(up / width) + 1, x_min, y_min, width


@kernel
def _cells(
    position: Floats, columns: int, rows: int, x_min: float, y_min: float, width: float
) -> tuple[Ints, Ints, Ints]:
    """Cell (N,) of each robot, -1 for a position that is not finite, and the robots of each cell in CSR format."""
    count = position.shape[0]
    cell = np.full(count, -1, np.int64)
    cell_start = np.zeros(columns * rows + 1, np.int64)
    for i in range(count):
        x, y = position[i, 0], position[i, 1]
        if math.isfinite(x) and math.isfinite(y):
            cell[i] = int((y - y_min) / width) * columns + int((x - x_min) / width)
            cell_start[cell[i] + 1] += 1
    for c in range(columns * rows):
        cell_start[c + 1] += cell_start[c]
    fill = cell_start.copy()
    members = np.empty(cell_start[-1], np.int64)
    for i in range(count):
        if cell[i] >= 0:
            members[fill[cell[i]]] = i
            fill[cell[i]] += 1
    return cell, cell_start, members


@kernel
def _among_all(position: Floats, max_distance: float) -> tuple[Ints, Ints]:
    """Neighbour lists by testing every pair."""
    count = position.shape[0]
    square = max_distance * max_distance if max_distance >= 0.0 else -1.0
    start = np.zeros(count + 1, np.int64)
    to = np.empty(count * max(count - 1, 0), np.int64)
    used = 0
    for i in range(count):
        for j in range(count):
            dx, dy = position[i, 0] - position[j, 0], position[i, 1] - position[j, 1]
            if dx * dx + dy * dy <= square and j != i:
                to[used] = j
                used += 1
        start[i + 1] = used
    return start, to[:used].copy()


@kernel
def _transposed(start: Ints, to: Ints) -> Ints:
    """The same symmetric neighbour lists, each sorted by index."""
    fill = start[:-1].copy()
    turned = np.empty(start[-1], np.int64)
    for i in range(start.shape[0] - 1):
        for k in range(start[i], start[i + 1]):
            j = to[k]
            turned[fill[j]] = i
            fill[j] += 1
    return turned
