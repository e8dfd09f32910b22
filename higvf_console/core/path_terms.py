"""The terms on which a drawn path is followed: one record for the console, scripts, scenarios and the reducer.

`StrokeEnd` and `ShapePath` carry the terms as fields of their own, as recordings have them; here they become a record.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from higvf_console.core.commands import PATH_ENDINGS, ShapePath, StrokeEnd, StrokeUse
from higvf_console.core.state import PathEnding

# By the words that people write and read.
ENDINGS: Mapping[str, PathEnding] = MappingProxyType(dict(zip(PATH_ENDINGS, PathEnding, strict=True)))
SLOWEST, FASTEST = 0.2, 1.5  # pace along a path


class PathTerms(NamedTuple):
    """How a stroke becomes a path, and how that path is followed.

    Attributes:
        ending: a word of `ENDINGS`: what happens at the end of the path.
        pace: share of their velocity that those who are led along it take, in [SLOWEST, FASTEST].
        duration: how long it is followed [s]; 0 = as long as it takes.
        smoothing: standard deviation by which the path may leave its stroke [m]; None = the scenario's.
    """

    ending: str = "release"
    pace: float = 1.0
    duration: float = 0.0
    smoothing: float | None = None


USUAL_TERMS = PathTerms()


def stroke_end(
    terms: PathTerms, use: StrokeUse = StrokeUse.PATH, robot: int | None = None, *, preview: bool = False
) -> StrokeEnd:
    """The end of a stroke whose path is followed on some terms; the other arguments are as in `StrokeEnd`."""
    return StrokeEnd(**terms._asdict(), use=use.value, robot=robot, preview=preview)


def terms_of_stroke(end: StrokeEnd) -> PathTerms:
    """The terms on which the path is followed that a stroke becomes."""
    return PathTerms(end.ending, end.pace, end.duration, end.smoothing)


def changed_terms(terms: PathTerms, change: ShapePath) -> PathTerms:
    """The terms of a path after a command that leaves some of them as they are."""
    given = {"ending": change.ending, "pace": change.pace, "duration": change.duration}
    return terms._replace(**{name: value for name, value in given.items() if value is not None})
