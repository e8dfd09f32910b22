"""Values that no public function can use where it expects an array, and those that it converts."""

from collections.abc import Callable

import numpy as np

from higvf_console.core.arrays import Floats

# By name: what stands in the place of a good array (n, 2).
USELESS: dict[str, object] = {
    "None": None,
    "a text": "positions",
    "texts": [["a", "b"]],
    "an object": object(),
    "a dict": {"x": 1.0},
    "objects": np.array([[object(), object()]]),
    "ragged lists": [[1.0, 2.0], [3.0]],
    "a number": 3.0,
    "a 0-d array": np.array(1.0),
    "one row": np.zeros(2),
    "three columns": np.zeros((3, 3)),
    "three dimensions": np.zeros((1, 3, 2)),
    "complex numbers": np.zeros((3, 2), complex),
    "truth values": np.zeros((3, 2), bool),
    "dates": np.zeros((3, 2), "datetime64[s]"),
    "a masked array": np.ma.masked_less(np.arange(6.0).reshape(3, 2), 3.0),
    "no columns": np.zeros((0, 3)),
}


def spoilt(good: Floats) -> dict[str, object]:
    """A good array (n, 2) with one element, or one row, too bad."""
    nan, infinite, huge = good.copy(), good.copy(), good.copy()
    nan[-1, -1], infinite[0, 0], huge[0, 1] = np.nan, -np.inf, 1e300
    return {
        "NaN": nan,
        "infinite": infinite,
        "huge": huge,
        "a row too few": good[:-1],
        "a row too many": np.vstack([good, good[:1] + 9.0]),
    }


def _locked(array: Floats) -> Floats:
    locked = array.copy()
    locked.setflags(write=False)
    return locked


# By name: other forms of the same whole numbers.
FORMS: dict[str, Callable[[Floats], object]] = {
    "lists": lambda array: array.tolist(),
    "tuples": lambda array: tuple((x, y) for x, y in array.tolist()),
    "integers": lambda array: array.astype(np.int32),
    "float32": lambda array: array.astype(np.float32),
    "big endian": lambda array: array.astype(">f8"),
    "Fortran order": np.asfortranarray,
    "a slice": lambda array: np.repeat(array, 2, axis=0)[::2],
    "columns of a wider one": lambda array: np.hstack([array, array])[:, :2],
    "read-only": _locked,
    "a matrix": lambda array: array.view(np.matrix),
}
