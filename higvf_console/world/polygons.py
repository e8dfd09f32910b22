"""Irregular obstacles as closed chains of points: orientation, edges as bars, crossings, distances.

A chain (n, 2) [m] closes from its last point to its first. Counter-clockwise it bounds an obstacle; clockwise it bounds
a free area that the obstacle before it encloses. An obstacle is thus one chain and the clockwise ones that follow it.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from higvf_console.core.arrays import Bools, Floats, floats
from higvf_console.core.errors import ScenarioError
from higvf_console.core.outline import enclosed

_AT_ONCE = 2000  # points whose distances from all edges are found together
LEAST_AREA = 1e-6  # of a polygon [m^2]
MOST_EDGES = 500  # of all irregular obstacles together: each is a barrier of every robot near it


def signed_area(chain: Floats) -> float:
    """Area [m^2] inside a chain (n, 2), positive when it runs counter-clockwise."""
    x, y = (chain - chain[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def oriented(chain: Floats, *, clockwise: bool = False) -> Floats:
    """The chain, run counter-clockwise or clockwise."""
    return floats(chain[::-1] if (signed_area(chain) < 0.0) is not clockwise else chain)


def without_repeats(points: Floats) -> Floats:
    """The points (n, 2) without those equal to the one before them; the first follows the last."""
    return floats(points[(points != np.roll(points, 1, axis=0)).any(axis=1)])


def edges(chains: Iterable[Floats]) -> Floats:
    """Edges (E, 4) ax, ay, bx, by [m] of the chains, in order."""
    found = [np.concatenate([chain, np.roll(chain, -1, axis=0)], axis=1) for chain in chains]
    return np.concatenate(found) if found else floats([], 0, 4)


def obstacles_of(chains: Iterable[Floats]) -> list[tuple[Floats, ...]]:
    """The chains by obstacle: each counter-clockwise one with the clockwise ones that follow it."""
    found: list[tuple[Floats, ...]] = []
    for chain in chains:
        if signed_area(chain) > 0.0 or not found:
            found.append((chain,))
        else:
            found[-1] = (*found[-1], chain)
    return found


def crossing(chains: Sequence[Floats]) -> tuple[int, int] | None:
    """Two edges, as rows of `edges`, that touch although they are not neighbours, or fold back on each other."""
    spines = edges(chains)
    a, b = spines[:, :2], spines[:, 2:]
    following = np.concatenate(
        [np.roll(np.arange(len(c)), -1) + s for c, s in zip(chains, _starts(chains), strict=True)]
    )
    touching = _touching(a, b)
    index = np.arange(len(a))
    touching[index, following] = touching[following, index] = False
    along, onward = b - a, (b - a)[following]
    turn = along[:, 0] * onward[:, 1] - along[:, 1] * onward[:, 0]
    touching[index, following] |= (turn == 0.0) & ((along * onward).sum(axis=1) < 0.0)
    first, second = np.nonzero(np.triu(touching | touching.T, 1))
    return (int(first[0]), int(second[0])) if len(first) else None


def _starts(chains: Sequence[Floats]) -> list[int]:
    return np.cumsum([0, *[len(chain) for chain in chains[:-1]]]).tolist()


def _touching(a: Floats, b: Floats) -> Bools:
    """Which of the segments a-b (E, 2) have a point in common (E, E)."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    near = ((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2)
    side_a, side_b = _sides(a, b, a), _sides(a, b, b)
    split = side_a * side_b <= 0.0
    return near & split & split.T


def _sides(a: Floats, b: Floats, points: Floats) -> Floats:
    """On which side of line i the point j lies (E, E): -1, 0, 1."""
    along = b - a
    dx, dy = (points[None, :, k] - a[:, None, k] for k in (0, 1))
    return np.sign(along[:, :1] * dy - along[:, 1:] * dx)


def segment_distance(points: Floats, start: Floats, end: Floats) -> Floats:
    """Distance (N,) [m] of points (N, 2) from the segment between two points (2,)."""
    along = end - start
    share = (points - start) @ along / max(float(along @ along), 1e-12)
    return np.hypot(*(points - start - np.clip(share, 0.0, 1.0)[:, None] * along).T)


def signed_distance(chains: Sequence[Floats], points: Floats) -> Floats:
    """Distance (N,) [m] of points (N, 2) from the edge of one obstacle, negative inside it.

    Args:
        chains: its outline, and the outlines of the free areas in it; inside is what an odd number of them encloses.
        points: (N, 2) [m].
    """
    spines = edges(chains)
    parts: list[Floats] = []
    for part in np.array_split(points, len(points) // _AT_ONCE + 1):
        inside = np.zeros(len(part), np.bool_)
        for chain in chains:
            inside ^= enclosed(chain, part)
        nearest = spine_distance(part, spines).min(axis=1)
        parts.append(np.where(inside, -nearest, nearest))  # pyright: ignore[reportUnknownArgumentType]
    return np.concatenate(parts)


def spine_distance(points: Floats, spines: Floats) -> Floats:
    """Distance (n, E) [m] of points (n, 2) from segments (E, 4), each from ax, ay to bx, by."""
    ax, ay, bx, by = spines.T
    along_x, along_y = bx - ax, by - ay
    dx, dy = points[:, :1] - ax, points[:, 1:] - ay
    share = np.clip((dx * along_x + dy * along_y) / np.maximum(along_x**2 + along_y**2, 1e-12), 0.0, 1.0)
    return np.hypot(dx - share * along_x, dy - share * along_y)


def closed_outline(corners: Floats) -> Floats:
    """The outline of an obstacle, counter-clockwise, of corners (n, 2) [m].

    Raises:
        ScenarioError: too few or too many corners, edges that cross or touch, or hardly an area.
    """
    points = without_repeats(corners)
    distinct = len(np.unique(points, axis=0))
    if distinct < 3:
        raise ScenarioError(f"a polygon needs at least 3 distinct points; this one has {distinct}")
    if len(points) > MOST_EDGES:
        raise ScenarioError(f"the polygon has {len(points)} edges; at most {MOST_EDGES} are possible")
    pair = crossing([points])
    if pair is not None:
        first, second = (_edge(points, k) for k in pair)
        raise ScenarioError(f"the polygon crosses or touches itself: {first} and {second}")
    area = abs(signed_area(points))
    if area < LEAST_AREA:
        raise ScenarioError(f"the polygon has an area of {area:.3g} m^2; give it at least {LEAST_AREA:g} m^2")
    return oriented(points)


def _edge(points: Floats, k: int) -> str:
    ax, ay, bx, by = edges([points])[k]
    return f"edge {k + 1} from ({ax:g}, {ay:g}) to ({bx:g}, {by:g})"
