"""Helpers of binocular formats: the mean of both eyes, and cells that mean true or false."""

import math
from collections.abc import Iterable

Eye = tuple[float, float]  # x, y; NaN where missing
NO_EYE: Eye = (math.nan, math.nan)
_NO = ("0", "0.0", "false", "no", "invalid", "n/a", "nan")


def both(eyes: Iterable[Eye]) -> Eye:
    """Return the mean of the eyes with known gaze; NaN without one."""
    seen = [eye for eye in eyes if eye[0] == eye[0] and eye[1] == eye[1]]
    if not seen:
        return NO_EYE
    return sum(eye[0] for eye in seen) / len(seen), sum(eye[1] for eye in seen) / len(seen)


def says_yes(text: str) -> bool:
    """Return whether a cell means true: any text except an empty cell and the values of `says_no`."""
    return text != "" and not says_no(text)


def says_no(text: str) -> bool:
    """Return whether a cell means false: 0, False, Invalid and similar; False for an empty cell."""
    return text.casefold() in _NO
