"""What a public function was given: checked before any of it reaches compiled code, refused in one line.

Each function returns the argument, converted where that loses nothing, or raises an `ArgumentError` that names the
argument, what was found and what is expected. Arrays: `core.arrays`.
"""

import math
import operator
import reprlib
from collections.abc import Collection
from typing import Any, TypeVar

from higvf_console.core.errors import ArgumentError, ArgumentTypeError, closest

_Kind = TypeVar("_Kind")
_BRIEF = reprlib.Repr()
_BRIEF.maxlevel = 2
_BRIEF.maxstring = _BRIEF.maxother = _BRIEF.maxlong = 60


def brief(value: object) -> str:
    """A value in a few words on one line, for an error."""
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        return f"an array of shape {shape} and type {getattr(value, 'dtype', '?')}"
    return " ".join(_BRIEF.repr(value).split())


def instance(name: str, value: object, *kinds: type[_Kind]) -> _Kind:
    """`value`, which is of one of `kinds`.

    Raises:
        ArgumentTypeError: it is of none.
    """
    if isinstance(value, kinds):
        return value
    wanted = " or ".join(kind.__name__ for kind in kinds)
    raise ArgumentTypeError(f"{name} is {brief(value)}; expected {wanted}")


def number(name: str, value: object, low: float = -math.inf, high: float = math.inf) -> float:
    """`value` as a float within [low, high]; infinite only where an end of the range is.

    Raises:
        ArgumentTypeError: not a number.
        ArgumentError: NaN, or out of range.
    """
    try:
        if isinstance(value, bool | str | bytes) or value is None:
            raise TypeError
        found = float(value)  # pyright: ignore[reportArgumentType] (what has no __float__ raises TypeError)
    except (TypeError, ValueError, OverflowError) as problem:
        raise ArgumentTypeError(f"{name} is {brief(value)}; expected {_range(low, high)}") from problem
    if not low <= found <= high:
        raise ArgumentError(f"{name} is {found:g}; expected {_range(low, high)}")
    return found


def positive(name: str, value: object, high: float = math.inf) -> float:
    """`value` as a finite float above 0, at most `high`.

    Raises:
        ArgumentTypeError: not a number.
        ArgumentError: NaN, not above 0 or above `high`.
    """
    found = number(name, value)
    if not 0.0 < found <= high or found == math.inf:
        raise ArgumentError(f"{name} is {found:g}; expected a number above 0" + ("" if high == math.inf else
                            f" and at most {high:g}"))  # fmt: skip
    return found


def whole(name: str, value: object, low: int, high: int | None = None) -> int:
    """`value` as an int within [low, high].

    Raises:
        ArgumentTypeError: not a whole number.
        ArgumentError: out of range.
    """
    wanted = f"a whole number from {low}" + ("" if high is None else f" to {high}")
    try:
        if isinstance(value, bool):
            raise TypeError
        found = operator.index(value)  # pyright: ignore[reportArgumentType] (what has no __index__ raises TypeError)
    except TypeError as problem:
        raise ArgumentTypeError(f"{name} is {brief(value)}; expected {wanted}") from problem
    if found < low or (high is not None and found > high):
        raise ArgumentError(f"{name} is {brief(found)}; expected {wanted}")
    return found


def one_of(where: str, value: object, known: Collection[str], error: type[Exception] = ArgumentError) -> str:
    """`value`, one of the words `known`.

    Args:
        where: what it is given as: an argument, a field, a place in a file.
        value: what was given.
        known: the choices.
        error: class of the error.

    Raises:
        Exception: of class `error`: it is none; the message names place, value, choices, and the nearest choice.
    """
    if isinstance(value, str) and value in known:
        return str(value)
    raise error(f"{where}: {not_one_of(value, known)}")


def not_one_of(value: object, known: Collection[str]) -> str:
    """That a value is none of the words `known`, which of them it may mean, for an error."""
    hint = closest(value, tuple(known)) if isinstance(value, str) else ""
    return f"{brief(value)} is not one of {', '.join(known)}{hint}"


def sequence(name: str, value: object) -> tuple[Any, ...]:
    """`value` as a tuple: a list, a tuple or another finite collection, but no text.

    Raises:
        ArgumentTypeError: it cannot be iterated.
    """
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        return tuple(value)  # pyright: ignore[reportArgumentType, reportUnknownVariableType] (raises TypeError)
    except TypeError as problem:
        raise ArgumentTypeError(f"{name} is {brief(value)}; expected a list") from problem


def _range(low: float, high: float) -> str:
    if low == -math.inf and high == math.inf:
        return "a number"
    if high == math.inf:
        return f"a number from {low:g}"
    return f"a number from {low:g} to {high:g}" if low > -math.inf else f"a number up to {high:g}"
