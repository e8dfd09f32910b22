"""The geometry of what the operator sees, pure: outlines, marks, dashes, chevrons, arrows.

Outlines are closed polylines (n, 2); `segments` and `dashed` turn polylines into line segments (s, 2, 2). All lengths
are in metres, angles in radians.
"""

import math
from collections.abc import Sequence

import mapbox_earcut
import numpy as np

from higvf_console.core.arrays import Floats, floats, ints
from higvf_console.ui.scene.glyphs import Triangles

_AT_REST = 0.02  # of the cruise speed: a slower robot keeps its heading


def circle(x: float, y: float, radius: float, corners: int = 64) -> Floats:
    """The closed outline (corners + 1, 2) of a circle."""
    turn = np.linspace(0.0, 2 * np.pi, corners + 1)
    return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)


def capsule(a: Floats, b: Floats, radius: float, corners: int = 48) -> Floats:
    """The closed outline of all points within `radius` of the spine from a (2,) to b (2,); a circle where a = b."""
    angle = math.atan2(b[1] - a[1], b[0] - a[0])
    half = np.linspace(-np.pi / 2, np.pi / 2, corners // 2 + 1)
    round_b = b + radius * np.stack([np.cos(angle + half), np.sin(angle + half)], axis=1)
    round_a = a - radius * np.stack([np.cos(angle + half), np.sin(angle + half)], axis=1)
    return np.concatenate([round_b, round_a, round_b[:1]])


def rectangle(x_min: float, y_min: float, x_max: float, y_max: float) -> Floats:
    """The closed outline (5, 2) of a rectangle."""
    return floats([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max], [x_min, y_min]])


def filled(outline: Floats) -> Triangles:
    """The inside of a convex closed outline."""
    corners = len(outline) - 1
    fan = [[0, i, i + 1] for i in range(1, corners - 1)]
    return Triangles(outline[:-1].copy(), ints(fan, -1, 3))


def filled_between(chains: Sequence[Floats]) -> Triangles:
    """The inside of an outline of any shape without the areas that it encloses; points (n, 2) that close by themselves.

    Args:
        chains: the outline, then those of the enclosed areas; none may cross.
    """
    corners = np.concatenate(chains)
    ends = np.cumsum([len(chain) for chain in chains]).astype(np.uint32)
    return Triangles(corners, ints(mapbox_earcut.triangulate_float64(corners, ends), -1, 3))


def closed(chain: Floats) -> Floats:
    """The closed outline (n + 1, 2) of points (n, 2)."""
    return np.concatenate([chain, chain[:1]])


def inflated(hull: Floats, margin: float, corners: int = 48) -> Floats:
    """The closed outline of all points within `margin` of a convex polygon (n, 2) that runs counter-clockwise."""
    along = np.roll(hull, -1, axis=0) - hull
    angle = np.arctan2(along[:, 1], along[:, 0]) - np.pi / 2  # of each edge's outward normal
    before = np.roll(angle, 1)
    turn = (angle - before) % (2 * np.pi)
    arcs = [
        corner + margin * np.stack([np.cos(bearings), np.sin(bearings)], axis=1)  # pyright: ignore[reportUnknownArgumentType]
        for corner, start, sweep in zip(hull, before, turn, strict=True)
        for bearings in [start + np.linspace(0.0, sweep, max(2, math.ceil(sweep / (2 * np.pi) * corners)))]  # pyright: ignore[reportUnknownVariableType]
    ]
    return closed(np.concatenate(arcs))


def annulus(inner: float, outer: float, corners: int = 48) -> Triangles:
    """The ring between two circles round the origin."""
    inside, outside = circle(0, 0, inner, corners)[:-1], circle(0, 0, outer, corners)[:-1]
    i = np.arange(corners)
    j = (i + 1) % corners
    faces = np.concatenate([np.stack([i, i + corners, j + corners], 1), np.stack([i, j + corners, j], 1)])
    return Triangles(np.concatenate([inside, outside]), ints(faces))


def dart(length: float) -> Triangles:
    """A robot's mark: an arrow head of `length`, centred, pointing along x."""
    nose, tail, wing, notch = 0.58, -0.42, 0.40, -0.20
    corners = floats([[nose, 0.0], [tail, wing], [notch, 0.0], [tail, -wing]])
    return Triangles(length * corners, ints([[0, 1, 2], [0, 2, 3]]))


def headings(velocity: Floats, before: Floats, cruise_speed: float) -> Floats:
    """Where the robots head (N,) [rad]: along `velocity` (N, 2) [m/s], as `before` (N,) where they nearly rest."""
    moving = np.hypot(velocity[:, 0], velocity[:, 1]) > _AT_REST * cruise_speed
    return np.where(moving, np.arctan2(velocity[:, 1], velocity[:, 0]), before)


def segments(polyline: Floats) -> Floats:
    """The line segments (n - 1, 2, 2) of a polyline (n, 2); none of an empty one."""
    return np.stack([polyline[:-1], polyline[1:]], axis=1)


def clipped(lines: Floats, x_min: float, y_min: float, x_max: float, y_max: float) -> Floats:
    """The parts of line segments (s, 2, 2) inside a rectangle, by Liang and Barsky."""
    start, along = lines[:, 0], lines[:, 1] - lines[:, 0]
    room = np.stack([start - [x_min, y_min], [x_max, y_max] - start])  # to each side; leaving it, `along` uses it up
    speed = np.stack([-along, along])
    with np.errstate(divide="ignore", invalid="ignore"):
        share = room / speed
    enter = np.where(speed < 0.0, share, 0.0).max(axis=(0, 2), initial=0.0)
    leave = np.where(speed > 0.0, share, 1.0).min(axis=(0, 2), initial=1.0)
    seen = (enter < leave) & ~((speed == 0.0) & (room < 0.0)).any(axis=(0, 2))
    ends = np.stack([enter, leave], axis=1)[seen]
    return start[seen, None] + ends[..., None] * along[seen, None]


def dashed(polyline: Floats, dash: float, gap: float) -> Floats:
    """Dashes (s, 2, 2) of about `dash` and `gap` along a polyline (n, 2), fitted to a whole number of them."""
    arc = arc_lengths(polyline)
    count = max(1, round(float(arc[-1]) / (dash + gap)))
    starts = np.arange(count) * (arc[-1] / count)
    stops = starts + arc[-1] / count * dash / (dash + gap)
    ends = np.stack([starts, stops], axis=1)
    return np.stack([np.interp(ends, arc, polyline[:, 0]), np.interp(ends, arc, polyline[:, 1])], axis=2)


def arc_lengths(polyline: Floats) -> Floats:
    """Distance along a polyline (n, 2) from its start to each point (n,)."""
    steps = np.diff(polyline, axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])


def chevrons(polyline: Floats, spacing: float, size: float, direction: float) -> Triangles:
    """Arrow heads of `size` that ride on a polyline (n, 2) and point along its travel (`direction` = +-1)."""
    arc = arc_lengths(polyline)
    if arc[-1] <= 0.0:
        return Triangles(floats([], 0, 2), ints([], 0, 3))
    count = max(1, round(float(arc[-1]) / spacing))
    middle = (np.arange(count) + 0.5) * arc[-1] / count
    at = [np.stack([np.interp(middle + s, arc, polyline[:, k]) for k in (0, 1)], 1) for s in (-size / 2, 0, size / 2)]  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
    along = direction * (at[2] - at[0])
    along /= np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-9)[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    centre = at[1]  # pyright: ignore[reportUnknownVariableType]
    nose, notch = centre + 0.6 * size * along, centre - 0.1 * size * along
    left, right = centre - size * (0.4 * along - 0.5 * across), centre - size * (0.4 * along + 0.5 * across)
    vertices = np.stack([nose, left, notch, right], axis=1).reshape(-1, 2)
    first = 4 * np.arange(count)[:, None]
    faces = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    return Triangles(floats(vertices), ints(faces))


def arrows(points: Floats, vectors: Floats, length: float) -> Floats:
    """Arrows (3 G, 2, 2), a shaft and two barbs each, centred on points (G, 2).

    The longest vector (G, 2) gets `length`, shorter ones at least a third of it, so that direction is always seen.
    """
    size = np.hypot(vectors[:, 0], vectors[:, 1])
    shown = size > 1e-9 * max(1.0, float(size.max(initial=0.0)))
    points, vectors, size = points[shown], vectors[shown], size[shown]
    if not len(points):
        return floats([], 0, 2, 2)
    shaft = vectors / size[:, None] * (length * (1 / 3 + 2 / 3 * size / size.max()))[:, None]
    tip, tail = points + shaft / 2, points - shaft / 2
    across = np.stack([-shaft[:, 1], shaft[:, 0]], axis=1)
    left, right = tip - 0.32 * shaft + 0.2 * across, tip - 0.32 * shaft - 0.2 * across
    strokes = [np.stack([start, tip], axis=1) for start in (tail, left, right)]
    return np.stack(strokes, axis=1).reshape(-1, 2, 2)


def tick_spacing(extent: float, most: int) -> float:
    """The smallest of 1, 2, 5 x 10^k that divides `extent` into at most `most` parts."""
    rough = extent / most
    power = 10.0 ** math.floor(math.log10(rough))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= rough * (1 - 1e-9))


def ticks(low: float, high: float, spacing: float) -> Floats:
    """Multiples of `spacing` from `low` to `high`."""
    return floats(np.arange(math.ceil(low / spacing - 1e-9), math.floor(high / spacing + 1e-9) + 1) * spacing)
