"""What the two-eyed formats share: the point that both eyes see, and cells that mean yes."""

import math
from collections.abc import Iterable

Eye = tuple[float, float]  # x, y; NaN where missing
NO_EYE: Eye = (math.nan, math.nan)
_NO = ("0", "0.0", "false", "no", "invalid", "n/a", "nan")


def both(eyes: Iterable[Eye]) -> Eye:
    """Mean of the eyes that are there; NaN where none is."""
    seen = [eye for eye in eyes if eye[0] == eye[0] and eye[1] == eye[1]]
    if not seen:
        return NO_EYE
    return sum(eye[0] for eye in seen) / len(seen), sum(eye[1] for eye in seen) / len(seen)


def says_yes(text: str) -> bool:
    """Whether a cell affirms: 1, True, Valid and the like; an empty one does not."""
    return text != "" and not says_no(text)


def says_no(text: str) -> bool:
    """Whether a cell denies: 0, False, Invalid and the like; an empty one does not."""
    return text.casefold() in _NO
