"""Groups static obstacles with impassable gaps, and computes the way out of the pockets that they form.

Computed once per world. Two parts with a gap below 2 R_o belong to one group, and so do groups whose convex hulls have
such a gap; the vector field circulates round the hull of a group. A robot inside a hull (in a U, between two arms)
leaves along the shortest way that keeps R_o, found by Dijkstra's algorithm on a grid.
"""
# SciPy's sparse graphs have no types.
# pyright: reportUnknownArgumentType=false, reportUnknownMemberType=false, reportUnknownVariableType=false

import math
from typing import NamedTuple

import numpy as np

from higvf_console.control.guidance.boundaries import capsule_corners, convex_hull
from higvf_console.core.arrays import Bools, Floats, Ints, floats, ints
from higvf_console.core.state import CAPSULE, GRID_COLUMNS

_BLOCK = 1_000_000  # pairs of boxes that are looked at in one piece
_CELLS = 48  # most cells of a pocket's grid along its longer side
_LEAST_CELL = 4.0  # at the usual scale [m]
_CROWDED = 30.0  # extra cost of a metre where a robot violates the clearance
_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1), (1, 2), (2, 1), (1, -2), (2, -1))  # offsets to half of the neighbours


class Groups(NamedTuple):
    """Groups of parts; fields as in `state.World`."""

    boundary: Floats
    boundary_start: Ints
    hull: Floats
    part: Ints
    pocket: Floats


def group_obstacles(parts: Floats, clearance: float, scale: float) -> Groups:
    """Groups the obstacle parts of a world, and computes the hull and the pocket of each group.

    Args:
        parts: (K, 5) capsules ax, ay, bx, by, radius [m].
        clearance: R_o [m].
        scale: of lengths.
    """
    members = _members(_labels(parts, 2.0 * clearance))
    boundary = np.zeros((len(members), GRID_COLUMNS + 1))
    hulls, pockets = [np.zeros((0, 2))], [np.zeros((0, 3))]
    for g, group in enumerate(members):
        if len(group) == 1:
            boundary[g, :CAPSULE] = parts[group[0]]
            hulls.append(np.zeros((0, 2)))
            pockets.append(np.zeros((0, 3)))
            continue
        hull = _hull(parts[group])
        centre = (hull.min(axis=0) + hull.max(axis=0)) / 2
        boundary[g, :CAPSULE] = [*centre, *centre, np.hypot(*(hull - centre).T).max()]
        boundary[g, CAPSULE:], pocket = _pocket(parts[group], hull, clearance, _LEAST_CELL * scale)
        hulls.append(hull)
        pockets.append(pocket)
    starts = [np.cumsum([len(piece) for piece in pieces]) for pieces in (hulls, pockets)]
    part_start = np.concatenate([[0], np.cumsum([len(group) for group in members])])
    return Groups(
        floats(boundary),
        ints([starts[0], part_start, starts[1]]),
        floats(np.concatenate(hulls)),
        ints(np.concatenate(members) if members else [], -1),
        floats(np.concatenate(pockets)),
    )


def _labels(parts: Floats, least: float) -> Ints:
    """Group (n,) of each part: by the gaps between parts, then repeatedly by the gaps between the hulls."""
    low = np.minimum(parts[:, :2], parts[:, 2:4]) - parts[:, 4:]
    high = np.maximum(parts[:, :2], parts[:, 2:4]) + parts[:, 4:]
    pairs = _near_boxes(low, high, least)
    label = _joined(len(parts), pairs[_gaps(parts[pairs[:, 0]], parts[pairs[:, 1]]) < least])
    corners = [capsule_corners(floats(part)) for part in parts]
    low, high = (floats([extreme(points, axis=0) for points in corners], -1, 2) for extreme in (np.min, np.max))
    while True:
        members = _members(label)
        groups = len(members)
        group_low, group_high = np.full((groups, 2), np.inf), np.full((groups, 2), -np.inf)
        np.minimum.at(group_low, label, low)
        np.maximum.at(group_high, label, high)
        hulls: dict[int, Floats] = {}
        near: list[tuple[int, int]] = []
        for i, j in _near_boxes(group_low, group_high, least).tolist():
            if len(members[i]) > 1 or len(members[j]) > 1:
                a, b = (_hull_of(k, members, corners, hulls) for k in (i, j))
                if _polygon_gap(a, b) < least:
                    near.append((i, j))
        if not near:
            return label
        label = _joined(groups, ints(near, -1, 2))[label]


def _members(label: Ints) -> list[Ints]:
    """Rows of each group, in ascending order, by the groups (n,) of all rows."""
    sizes = np.bincount(label)
    return (
        [ints(rows) for rows in np.split(np.argsort(label, kind="stable"), np.cumsum(sizes)[:-1])] if len(sizes) else []
    )


def _hull_of(group: int, members: list[Ints], corners: list[Floats], hulls: dict[int, Floats]) -> Floats:
    """Hull (h, 2) of a group [m]; kept in `hulls`."""
    if group not in hulls:
        hulls[group] = convex_hull(floats(np.concatenate([corners[k] for k in members[group]])))
    return hulls[group]


def _joined(count: int, pairs: Ints) -> Ints:
    """Component (count,) of each node of a graph with edges (E, 2)."""
    from scipy.sparse import coo_array  # noqa: PLC0415 (slow to import)
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

    if count == 0:
        return ints([])
    edges = coo_array((np.ones(len(pairs), np.bool_), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return ints(connected_components(edges, directed=False)[1])


def _near_boxes(low: Floats, high: Floats, least: float) -> Ints:
    """Pairs (E, 2) i < j of boxes, from corners (n, 2) `low` to `high` [m], that are nearer than `least` on both axes.

    The boxes are swept from left to right, so that memory grows with the number of pairs and not with its square.
    """
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    last = np.searchsorted(low[:, 0], high[:, 0] + least, side="left")  # behind the last box that begins in reach
    pairs: list[Ints] = [ints([], 0, 2)]
    first = 0
    while first < len(low):
        count = np.maximum(last[first:] - np.arange(first + 1, len(low) + 1), 0)
        block = max(1, int(np.searchsorted(np.cumsum(count), _BLOCK, side="right")))
        count = count[:block]
        i = np.repeat(np.arange(first, first + len(count)), count)
        j = i + 1 + np.arange(len(i)) - np.repeat(np.cumsum(count) - count, count)
        near = np.maximum(low[j, 1] - high[i, 1], low[i, 1] - high[j, 1]) < least
        found = order[np.stack([i[near], j[near]], axis=1)]
        pairs.append(ints(np.sort(found, axis=1)))
        first += len(count)
    return ints(np.concatenate(pairs))


def _hull(parts: Floats) -> Floats:
    return convex_hull(floats(np.concatenate([capsule_corners(floats(part)) for part in parts])))


def _gaps(first: Floats, second: Floats) -> Floats:
    """Gaps (E,) between capsules (E, 5) and (E, 5) [m]; at most 0 where they touch."""
    a, b, c, d = first[:, :2], first[:, 2:4], second[:, :2], second[:, 2:4]
    ends = (_to_spine(a, c, d), _to_spine(b, c, d), _to_spine(c, a, b), _to_spine(d, a, b))
    distance = np.minimum(np.minimum(ends[0], ends[1]), np.minimum(ends[2], ends[3]))
    across = _orientation(a, b, c) * _orientation(a, b, d) < 0.0
    distance[across & (_orientation(c, d, a) * _orientation(c, d, b) < 0.0)] = 0.0
    return distance - first[:, 4] - second[:, 4]


def _orientation(a: Floats, b: Floats, points: Floats) -> Floats:
    """Orientation (E,) of points (E, 2) about the lines through a (E, 2) and b (E, 2); positive to the left."""
    along, to = b - a, points - a
    return along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]


def _to_spine(points: Floats, a: Floats, b: Floats) -> Floats:
    """Distance (E,) of points (E, 2) from the segments a-b (E, 2), each from its own [m]."""
    along, to = b - a, points - a
    share = np.clip((to * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-300), 0.0, 1.0)
    return np.hypot(*(to - share[:, None] * along).T)


def _to_spines(points: Floats, a: Floats, b: Floats) -> Floats:
    """Distance (m, n) of points (m, 2) from the segments a-b (n, 2) [m]."""
    along, to = (b - a)[None], points[:, None] - a[None]
    share = np.clip((to * along).sum(axis=2) / np.maximum((along * along).sum(axis=2), 1e-300), 0.0, 1.0)
    return np.hypot(*np.moveaxis(to - share[..., None] * along, 2, 0))


def _polygon_gap(a: Floats, b: Floats) -> float:
    """Gap between two convex polygons [m]; 0 if they overlap, that is, if no edge of either separates them."""
    if not (_separated(a, b) or _separated(b, a)):
        return 0.0
    return float(min(_to_spines(b, a, np.roll(a, -1, 0)).min(), _to_spines(a, b, np.roll(b, -1, 0)).min()))


def _separated(a: Floats, b: Floats) -> bool:
    """Whether an edge of convex polygon `a` separates it from `b`."""
    along = np.roll(a, -1, 0) - a
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    return bool((((b[None] - a[:, None]) * outward[:, None]).sum(axis=2).min(axis=1) > 0.0).any())


def _pocket(parts: Floats, hull: Floats, clearance: float, least_cell: float) -> tuple[Floats, Floats]:
    """Grid of directions out of a hull; empty, with 0 columns, if the hull has no room for a robot.

    Args:
        parts: (n, 5) capsules of the group [m].
        hull: (h, 2) corners of its convex hull [m].
        clearance: R_o [m].
        least_cell: width of a cell, at least [m].

    Returns:
        (4,) x, y of the first node and cell width [m], number of columns.
        (rows * columns, 3) unit vector out and distance to the parts [m] of each node, row by row.
    """
    from scipy.ndimage import label  # noqa: PLC0415

    low, high = hull.min(axis=0), hull.max(axis=0)
    cell = max(least_cell, float((high - low).max()) / _CELLS)
    columns, rows = (math.ceil(extent / cell) + 3 for extent in high - low)
    xs, ys = low[0] + cell * (np.arange(columns) - 1), low[1] + cell * (np.arange(rows) - 1)
    nodes = np.stack([axis.ravel() for axis in np.meshgrid(xs, ys)], axis=1)
    depth = _depth(hull, nodes)
    pieces = np.array_split(parts, math.ceil(len(parts) * len(nodes) / _BLOCK))
    room = np.min([(_to_spines(nodes, p[:, :2], p[:, 2:4]) - p[None, :, 4]).min(axis=1) for p in pieces], axis=0)
    free = (room >= clearance).reshape(rows, columns)
    region = np.zeros(free.shape, np.int64)
    label(free, output=region)
    region = region.ravel()
    open_regions = np.unique(region[free.ravel() & (depth <= 0.0)])
    if not (np.isin(region, open_regions) & free.ravel() & (depth > 0.0)).any():
        return np.zeros(4), np.zeros((0, 3))
    way = _travel(room, depth <= 0.0, clearance, cell, rows, columns)
    down, across = np.gradient(-way.reshape(rows, columns))
    length = np.maximum(np.hypot(across, down), 1e-300)
    way_out = [(across / length).ravel(), (down / length).ravel(), room]
    return floats([xs[0], ys[0], cell, columns]), np.stack(way_out, axis=1)


def _depth(hull: Floats, points: Floats) -> Floats:
    """Depth (n,) of points (n, 2) inside a convex polygon [m]; negative outside."""
    along = np.roll(hull, -1, 0) - hull
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    return -((points[:, None] - hull[None]) * outward[None]).sum(axis=2).max(axis=1)


def _travel(room: Floats, out: Bools, clearance: float, cell: float, rows: int, columns: int) -> Floats:
    """Cost (n,) of the cheapest way from each node to the outside of the hull [m]."""
    from scipy.sparse import coo_array  # noqa: PLC0415
    from scipy.sparse.csgraph import dijkstra  # noqa: PLC0415

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
