"""Exact planar distances between discs, capsules and filled polygons."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from higvf_console.core.arrays import Bools, Floats, floats


class Shape(NamedTuple):
    """All points within `radius` of the edges, and all points inside them if they bound an area.

    Attributes:
        edges: (E, 4) ax, ay, bx, by [m]; a disc has one edge of length zero.
        radius: [m].
        filled: whether the edges are a closed chain that bounds an area.
        centre: (2,) centre of a bounding circle [m].
        bounding_radius: radius of that circle [m].
    """

    edges: Floats
    radius: float
    filled: bool
    centre: Floats
    bounding_radius: float


def disc(x: float, y: float, radius: float) -> Shape:
    """The disc of `radius` [m] about (x, y) [m]."""
    return _shape(floats([[x, y, x, y]]), radius, filled=False)


def capsule(ax: float, ay: float, bx: float, by: float, half_width: float) -> Shape:
    """All points within `half_width` [m] of the segment from (ax, ay) to (bx, by) [m]."""
    return _shape(floats([[ax, ay, bx, by]]), half_width, filled=False)


def polygon(corners: Floats) -> Shape:
    """The filled polygon with `corners` (n, 2) [m], in order along its boundary."""
    return _shape(chain(corners), 0.0, filled=True)


def chain(corners: Floats) -> Floats:
    """The edges (n, 4) of the closed chain through `corners` (n, 2) [m]."""
    return floats(np.hstack([corners, np.roll(corners, -1, axis=0)]))


def hull(shape: Shape) -> Shape:
    """The convex hull of a shape; the shape itself if it has one edge."""
    if len(shape.edges) < 2:
        return shape
    corners = shape.edges[:, :2]
    return polygon(corners[ConvexHull(corners).vertices])._replace(radius=shape.radius)


def distances(points: Floats, shape: Shape) -> Floats:
    """Distances (n,) of points (n, 2) from the surface of a shape [m], negative inside."""
    apart = _to_edges(points, shape.edges).min(axis=1)
    if shape.filled:
        apart = np.where(_inside(points, shape.edges), -apart, apart)
    return apart - shape.radius


def gap(one: Shape, other: Shape) -> float:
    """Minimum distance between the surfaces of two shapes [m]; not positive if they touch."""
    ends = [shape.edges.reshape(-1, 2) for shape in (one, other)]
    least = min(
        float(distances(ends[0], other).min()) - one.radius, float(distances(ends[1], one).min()) - other.radius
    )
    return min(least, 0.0) if _crossing(one.edges, other.edges) else least


def clear_of(shape: Shape, others: list[Shape], least: float) -> bool:
    """Whether the gap of a shape to each of the others is at least `least` [m]."""
    for other in others:
        near = np.hypot(*(shape.centre - other.centre)) - shape.bounding_radius - other.bounding_radius
        if near < least and gap(shape, other) < least:
            return False
    return True


def _shape(edges: Floats, radius: float, filled: bool) -> Shape:
    ends = edges.reshape(-1, 2)
    centre = (ends.min(axis=0) + ends.max(axis=0)) / 2.0
    return Shape(edges, radius, filled, centre, float(np.hypot(*(ends - centre).T).max()) + radius)


def _to_edges(points: Floats, edges: Floats) -> Floats:
    """Distances (n, E) of points (n, 2) from edges (E, 4) [m]."""
    start, along = edges[:, :2], edges[:, 2:] - edges[:, :2]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    offset = points[:, None, :] - start
    share = np.clip((offset * along).sum(axis=2) / square, 0.0, 1.0)
    return np.linalg.norm(offset - share[..., None] * along, axis=2)


def _inside(points: Floats, edges: Floats) -> Bools:
    """(n,) whether a ray from each point towards +x crosses the closed chain of edges an odd number of times."""
    ax, ay, bx, by = edges.T
    x, y = points[:, :1], points[:, 1:]
    straddles = (ay > y) != (by > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = x < ax + (y - ay) / (by - ay) * (bx - ax)
    return (straddles & beyond).sum(axis=1) % 2 == 1


def _crossing(one: Floats, other: Floats) -> bool:
    """Whether an edge of `one` (E, 4) crosses one of `other` (F, 4)."""
    return bool((_separates(one, other) & _separates(other, one).T).any())


def _separates(edges: Floats, lines: Floats) -> Bools:
    """(E, F) whether the line through each of `lines` (F, 4) separates the ends of each of `edges` (E, 4)."""
    start, along = lines[:, :2], lines[:, 2:] - lines[:, :2]
    orientation = [
        along[:, 0] * (edges[:, None, k + 1] - start[:, 1]) - along[:, 1] * (edges[:, None, k] - start[:, 0])
        for k in (0, 2)
    ]
    return orientation[0] * orientation[1] < 0.0
