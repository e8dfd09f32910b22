"""Array types, and the gate that every array passes on its way into a compiled kernel.

A kernel is compiled for exact types: one integer where a float was, one sliced or read-only array, and it would be
compiled again in the middle of a run. So arrays are made by `floats`, `ints` and `bools`, and never left to chance.
"""

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Bools: TypeAlias = NDArray[np.bool_]


def floats(values: ArrayLike, *shape: int) -> Floats:
    """A fresh, writable, C-contiguous float64 array; `shape` may hold one -1."""
    array = np.array(values, dtype=np.float64, order="C")
    return array.reshape(shape) if shape else array


def ints(values: ArrayLike, *shape: int) -> Ints:
    """A fresh, writable, C-contiguous int64 array; `shape` may hold one -1."""
    array = np.array(values, dtype=np.int64, order="C")
    return array.reshape(shape) if shape else array


def bools(values: ArrayLike, *shape: int) -> Bools:
    """A fresh, writable, C-contiguous bool array; `shape` may hold one -1."""
    array = np.array(values, dtype=np.bool_, order="C")
    return array.reshape(shape) if shape else array
