"""Which still obstacles the field treats as one: parts that leave no way between them, and how to leave their pockets.

Computed once for a world. Two parts with a gap below 2 R_o are one group, and so are groups whose hulls come as near;
a group's ring is its convex hull. A robot that finds itself inside a hull (in a U, between two arms) is led out along
the shortest way that keeps R_o, found on a grid.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import label as label_regions
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, dijkstra

from higvf_console.arrays import Bools, Floats, Ints, floats, ints
from higvf_console.control.rings import capsule_corners, convex_hull

_CELLS = 48  # of a pocket's grid along its longer side, at most
_LEAST_CELL = 4.0  # [m]
_CROWDED = 30.0  # how much longer a metre counts where a robot would be too near to a part
_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1), (1, 2), (2, 1), (1, -2), (2, -1))  # to half of a cell's neighbours


class Groups(NamedTuple):
    """Groups of parts, as `state.World` holds them; see there."""

    ring: Floats
    ring_start: Ints
    hull: Floats
    part: Ints
    pocket: Floats


def group_obstacles(circles: Floats, bars: Floats, clearance: float) -> Groups:
    """Groups the parts of a world.

    Args:
        circles: (P, 3) x, y, radius [m].
        bars: (Q, 5) ax, ay, bx, by, half width [m].
        clearance: R_o [m].
    """
    parts = np.concatenate([circles[:, [0, 1, 0, 1, 2]], bars]) if len(circles) + len(bars) else np.zeros((0, 5))
    label = _labels(parts, 2.0 * clearance)
    members = [np.flatnonzero(label == name) for name in range(label.max(initial=-1) + 1)]
    ring = np.zeros((len(members), 9))
    hulls, pockets = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for g, group in enumerate(members):
        if len(group) == 1:
            ring[g, :5] = parts[group[0]]
            hulls.append(np.zeros((0, 2)))
            pockets.append(np.zeros((0, 2)))
            continue
        hull = _hull(parts[group])
        centre = (hull.min(axis=0) + hull.max(axis=0)) / 2
        ring[g, :5] = [*centre, *centre, np.hypot(*(hull - centre).T).max()]
        ring[g, 5:], pocket = _pocket(parts[group], hull, clearance)
        hulls.append(hull)
        pockets.append(pocket)
    starts = [np.cumsum([len(piece) for piece in pieces]) for pieces in (hulls, pockets)]
    part_start = np.concatenate([[0], np.cumsum([len(group) for group in members])])
    return Groups(
        floats(ring),
        ints([starts[0], part_start, starts[1]]),
        floats(np.concatenate(hulls)),
        ints(np.concatenate(members) if members else [], -1),
        floats(np.concatenate(pockets)),
    )


def _labels(parts: Floats, least: float) -> Ints:
    """Group number (n,) of each part: first by the parts' gaps, then by the gaps of the hulls that these make."""
    count = len(parts)
    label = _joined(count, [(i, j) for i in range(count) for j in range(i) if _gap(parts[i], parts[j]) < least])
    while True:
        groups = label.max(initial=-1) + 1
        hulls = [_hull(parts[label == name]) for name in range(groups)]
        sizes = np.bincount(label, minlength=groups)
        pairs = [
            (i, j)
            for i in range(groups)
            for j in range(i)
            if max(sizes[i], sizes[j]) > 1 and _polygon_gap(hulls[i], hulls[j]) < least
        ]
        if not pairs:
            return label
        label = _joined(groups, pairs)[label]


def _joined(count: int, pairs: list[tuple[int, int]]) -> Ints:
    edges = ints(pairs, -1, 2)
    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    return ints(connected_components(graph, directed=False)[1]) if count else ints([])


def _hull(parts: Floats) -> Floats:
    return convex_hull(floats(np.concatenate([capsule_corners(floats(part)) for part in parts])))


def _gap(a: Floats, b: Floats) -> float:
    """Gap between two capsules (5,) [m]; at most 0 where they touch."""
    return _segment_distance(a[:2], a[2:4], b[:2], b[2:4]) - a[4] - b[4]


def _segment_distance(a: Floats, b: Floats, c: Floats, d: Floats) -> float:
    def side(p: Floats, q: Floats, r: Floats) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    if side(a, b, c) * side(a, b, d) < 0.0 and side(c, d, a) * side(c, d, b) < 0.0:
        return 0.0
    return float(min(_to_spine(p, q, r[None])[0] for p, q, r in ((c, d, a), (c, d, b), (a, b, c), (a, b, d))))


def _to_spine(a: Floats, b: Floats, points: Floats) -> Floats:
    """Distance (n,) of points (n, 2) from the segment a-b [m]."""
    along = b - a
    share = np.clip((points - a) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
    return np.hypot(*(points - a - share[:, None] * along).T)


def _polygon_gap(a: Floats, b: Floats) -> float:
    """Gap between two convex polygons [m]: the widest strip that an edge of either opens; 0 where they overlap."""
    apart = max(_widest_strip(a, b), _widest_strip(b, a))
    if apart <= 0.0:
        return 0.0
    sides = [(one[k - 1], one[k], other) for one, other in ((a, b), (b, a)) for k in range(len(one))]
    return float(min(_to_spine(start, end, other).min() for start, end, other in sides))


def _widest_strip(a: Floats, b: Floats) -> float:
    along = np.roll(a, -1, 0) - a
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    return float(((b[None] - a[:, None]) @ outward[:, :, None]).min(axis=(1, 2)).max())


def _pocket(parts: Floats, hull: Floats, clearance: float) -> tuple[Floats, Floats]:
    """The way out of a hull, on a grid: none, with 0 columns, for a hull without room for a robot.

    Returns:
        (4,) x, y of the first node and cell width [m], number of columns.
        (rows * columns, 2) unit vectors, row by row.
    """
    low, high = hull.min(axis=0), hull.max(axis=0)
    cell = max(_LEAST_CELL, float((high - low).max()) / _CELLS)
    columns, rows = (math.ceil(side / cell) + 3 for side in high - low)
    xs, ys = low[0] + cell * (np.arange(columns) - 1), low[1] + cell * (np.arange(rows) - 1)
    nodes = np.stack([axis.ravel() for axis in np.meshgrid(xs, ys)], axis=1)
    depth = -_outside(hull, nodes)
    room = np.min([_to_spine(part[:2], part[2:4], nodes) - part[4] for part in parts], axis=0)
    free = (room >= clearance).reshape(rows, columns)
    region = np.zeros(free.shape, np.int64)
    label_regions(free, output=region)
    region = region.ravel()
    open_regions = np.unique(region[free.ravel() & (depth <= 0.0)])
    if not (np.isin(region, open_regions) & free.ravel() & (depth > 0.0)).any():
        return np.zeros(4), np.zeros((0, 2))
    way = _travel(room, depth <= 0.0, clearance, cell, rows, columns)
    down, across = np.gradient(-way.reshape(rows, columns))
    length = np.maximum(np.hypot(across, down), 1e-300)
    return floats([xs[0], ys[0], cell, columns]), np.stack([(across / length).ravel(), (down / length).ravel()], axis=1)


def _outside(hull: Floats, points: Floats) -> Floats:
    """Signed distance (n,) of points from the lines of a convex polygon [m]; at most 0 inside."""
    along = np.roll(hull, -1, 0) - hull
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    return ((points[:, None] - hull[None]) * outward[None]).sum(axis=2).max(axis=1)


def _travel(room: Floats, out: Bools, clearance: float, cell: float, rows: int, columns: int) -> Floats:
    """Shortest travel (n,) from each node to the outside of the hull [m]."""
    index = np.arange(rows * columns).reshape(rows, columns)
    cost = np.where(room >= clearance, 1.0, 1.0 + _CROWDED * (1.0 - np.maximum(room, 0.0) / clearance))
    starts, stops, lengths = [], [], []
    for down, right in _STEPS:
        at = index[: rows - down, max(0, -right) : columns - max(0, right)].ravel()
        to = index[down:, max(0, right) : columns + min(0, right)].ravel()
        starts.append(at)
        stops.append(to)
        lengths.append(cell * math.hypot(down, right) * (cost[at] + cost[to]) / 2)
    graph = coo_array(
        (np.concatenate(lengths), (np.concatenate(starts), np.concatenate(stops))), shape=(rows * columns,) * 2
    )
    return floats(dijkstra(graph.tocsr(), directed=False, indices=np.flatnonzero(out), min_only=True))
