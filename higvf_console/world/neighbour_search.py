"""Nearest-neighbour search among many points; SciPy, slow to import, is loaded when it is first used."""

from typing import TYPE_CHECKING

from higvf_console.core.arrays import Floats

if TYPE_CHECKING:
    from scipy.spatial import KDTree


def kd_tree(points: Floats) -> "KDTree":
    """The k-d tree of points (n, 2)."""
    from scipy.spatial import KDTree  # noqa: PLC0415

    return KDTree(points)
