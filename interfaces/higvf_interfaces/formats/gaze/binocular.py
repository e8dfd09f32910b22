"""Helpers of binocular formats: the mean of both eyes, and cells that mean true or false."""

import math
from collections.abc import Iterable, Sequence

from higvf_console.core.errors import InputError
from higvf_interfaces.formats.text import Column, TextFile, cell

Eye = tuple[float, float]  # x, y; NaN where missing
NO_EYE: Eye = (math.nan, math.nan)
_YES = ("1", "1.0", "true", "t", "yes", "valid")
_NO = ("0", "0.0", "false", "f", "no", "invalid", "n/a", "nan")


def both(eyes: Iterable[Eye]) -> Eye:
    """Return the mean of the eyes with known gaze; NaN without one."""
    seen = [eye for eye in eyes if eye[0] == eye[0] and eye[1] == eye[1]]
    if not seen:
        return NO_EYE
    return sum(eye[0] for eye in seen) / len(seen), sum(eye[1] for eye in seen) / len(seen)


def says_yes(file: TextFile, row: list[str], column: Column, empty: bool = False) -> bool:
    """Return whether the cell of a validity column means true; `empty` if it is empty.

    Raises:
        InputError: If the cell means neither true nor false.
    """
    text = cell(row, column)
    plain = text.casefold()
    if plain in _YES:
        return True
    if plain in _NO:
        return False
    if not text:
        return empty
    if cut_word(file, plain, (*_YES, *_NO)):
        return False
    raise InputError(
        f"{file.path}, column {column.title[:60]}: {text[:40]!r} means neither valid nor invalid; known: "
        f"{', '.join(_YES)}; {', '.join(_NO)}"
    )


def cut_word(file: TextFile, text: str, known: Sequence[str]) -> bool:
    """Return whether a word may be a known one that the end of a truncated file cuts off."""
    begun = text.rstrip("\N{REPLACEMENT CHARACTER}")
    return (begun != text or not file.complete) and any(word.startswith(begun) for word in known)
