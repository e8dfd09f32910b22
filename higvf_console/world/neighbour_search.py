"""Nearest-neighbour search among many points; SciPy, slow to import, is loaded when it is first used."""

from collections.abc import Sequence
from typing import Any, Protocol, cast

from higvf_console.core.arrays import Floats, Ints


class KDTree(Protocol):
    """What is used of SciPy's k-d tree, which has no types."""

    def query(self, points: Floats, k: int = 1) -> tuple[Floats, Ints]:
        """Distances to the `k` nearest points [m], and their indices: (n,) for k = 1, else (n, k)."""
        ...

    def query_pairs(self, r: float, *, output_type: str) -> Ints:
        """(P, 2) pairs that are at most `r` [m] apart, for the output type "ndarray"."""
        ...

    def query_ball_point(self, points: Floats, r: float) -> Sequence[list[int]]:
        """The points within `r` [m] of each point."""
        ...


def kd_tree(points: Floats) -> KDTree:
    """The k-d tree of points (n, 2)."""
    from scipy import spatial  # noqa: PLC0415

    return cast(Any, spatial).KDTree(points)
