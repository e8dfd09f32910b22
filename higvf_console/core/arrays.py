"""Array types, and the gate that every array passes on its way into a compiled kernel.

A kernel is compiled for exact types: one integer where a float was, one sliced or read-only array, and it would be
compiled again in the middle of a run. And it trusts shapes: an array that is too short is read beyond its end. So the
engine makes its arrays by `floats`, `ints` and `bools`, and what a public function is given passes `given_floats`,
`given_ints` or `given_bools`, which check it.
"""

import math
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from higvf_console.core.arguments import brief
from higvf_console.core.errors import ArgumentError, ArgumentTypeError

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


Shape: TypeAlias = tuple[int | str, ...]  # an int is a size; a letter stands for any size, as in ("N", 2)
FARTHEST = 1e6  # [m] largest coordinate


def given_floats(
    name: str, value: object, shape: Shape, *, most: float = math.inf, finite: bool = True, why: str = ""
) -> Floats:
    """`value` as a writable, C-contiguous float64 array, itself where it is one.

    Args:
        name: of the argument, for errors.
        value: an array, or nested lists of numbers; an empty list stands for no rows.
        shape: expected, such as ("N", 2).
        most: largest magnitude of an element.
        finite: whether infinite values and NaN are refused.
        why: what the shape follows from, for errors.

    Raises:
        ArgumentTypeError: not an array of numbers.
        ArgumentError: another shape, NaN, infinite, or larger than `most`.
    """
    if _ready(value, shape, np.float64):
        array = cast(Floats, value)
    else:
        array = np.array(_shaped(name, value, shape, "fiu", why), np.float64, order="C")
    if array.size and not _within(array, most, finite):
        place = np.unravel_index(np.argmin(np.isfinite(array) & (np.abs(array) <= most)), array.shape)
        found = f"{name}[{', '.join(str(int(k)) for k in place)}] is {array[place]:g}"
        wanted = "finite numbers" if most == math.inf else f"numbers within +-{most:g}"
        raise ArgumentError(f"{found}; expected {wanted}")
    return array


def given_ints(name: str, value: object, shape: Shape, low: int, high: int, *, why: str = "") -> Ints:
    """`value` as a writable, C-contiguous int64 array of numbers within [low, high]; see `given_floats`.

    Raises:
        ArgumentTypeError: not an array of whole numbers.
        ArgumentError: another shape, or a number out of range.
    """
    ready = _ready(value, shape, np.int64)
    array = cast(Ints, value) if ready else _shaped(name, value, shape, "iu", why)
    if array.size and not (low <= int(array.min()) and int(array.max()) <= high):
        wanted = f"whole numbers from {low} to {high}" if low <= high else "none"
        raise ArgumentError(f"{name} has numbers from {array.min()} to {array.max()}; expected {wanted}")
    return array if ready else np.array(array, np.int64, order="C")


def given_bools(name: str, value: object, shape: Shape, *, why: str = "") -> Bools:
    """`value` as a writable, C-contiguous bool array; see `given_floats`.

    Raises:
        ArgumentTypeError: not an array of truth values.
        ArgumentError: another shape.
    """
    if _ready(value, shape, np.bool_):
        return cast(Bools, value)
    return np.array(_shaped(name, value, shape, "b", why), np.bool_, order="C")


def _ready(value: object, shape: Shape, kind: type[np.generic]) -> bool:
    """Whether `value` is such an array already."""
    return (
        type(value) is np.ndarray
        and value.dtype == kind
        and value.flags.carray
        and (value.shape == shape or _fits(value.shape, shape))
    )


def _fits(found: tuple[int, ...], shape: Shape) -> bool:
    return len(found) == len(shape) and all(size == k or isinstance(size, str) for size, k in zip(shape, found))  # noqa: B905


def _within(array: Floats, most: float, finite: bool) -> bool:
    """Whether all elements are; NaN is not within anything."""
    if most < math.inf:
        return bool(-most <= array.min() and array.max() <= most)
    return not finite or bool(np.isfinite(array).all())


_KINDS = {"fiu": "numbers", "iu": "whole numbers", "b": "truth values"}


def _shaped(name: str, value: object, shape: Shape, kinds: str, why: str) -> NDArray[Any]:
    """`value` as an array of that shape whose elements are of the NumPy `kinds`."""
    wanted = f"{_KINDS[kinds]} of shape {_shown(shape)}{why and f' ({why})'}"
    try:
        array = value if type(value) is np.ndarray else np.asarray(_plain(value))
    except (TypeError, ValueError, OverflowError) as problem:
        raise ArgumentTypeError(f"{name} is {brief(value)}, which is not an array; expected {wanted}") from problem
    if (
        array.size == 0
        and array.ndim <= 1
        and len(shape) > 0
        and shape[0] in (0, *_LETTERS)
        and array.dtype.kind in "fiub"
    ):
        return np.zeros([0 if isinstance(size, str) else size for size in shape], np.dtype(_EMPTY[kinds]))
    if array.dtype.kind not in kinds:
        raise ArgumentTypeError(f"{name} is {_found(value, array)}; expected {wanted}")
    if not _fits(array.shape, shape):
        raise ArgumentError(f"{name} has shape {array.shape}; expected {wanted}")
    return array


_LETTERS = tuple("NMKGSPQWHCE")
_EMPTY = {"fiu": np.float64, "iu": np.int64, "b": np.bool_}


def _plain(value: object) -> Any:
    """What NumPy may make an array of; masked values are refused, not read as what lies under the mask."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):  # pyright: ignore[reportUnknownArgumentType]
        raise TypeError
    return value  # pyright: ignore[reportUnknownVariableType]


def _found(value: object, array: NDArray[Any]) -> str:
    return brief(value if type(value) is np.ndarray or array.ndim == 0 else array)


def _shown(shape: Shape) -> str:
    return f"({', '.join(str(size) for size in shape)}{',' if len(shape) == 1 else ''})"
