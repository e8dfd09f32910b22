"""The console, scripts, scenarios and recordings give the terms of a path as one record."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.control.guidance.paths import sketch_path
from higvf_console.core.arrays import floats
from higvf_console.core.commands import ShapePath, StrokeEnd, StrokeUse
from higvf_console.core.errors import PathError
from higvf_console.core.path_terms import (
    ENDINGS,
    FASTEST,
    SLOWEST,
    PathTerms,
    changed_terms,
    stroke_end,
    terms_of_stroke,
)
from higvf_console.operator.path_commands import shaped, terms_of, with_terms

PATH = sketch_path(floats([[100, 100], [200, 150], [300, 100]]), 0.0)
TERMS = st.builds(
    PathTerms,
    ending=st.sampled_from(list(ENDINGS)),
    pace=st.floats(SLOWEST, FASTEST),
    duration=st.just(0.0) | st.floats(0.1, 1e4),
    smoothing=st.none() | st.floats(0.0, 50.0),
)


def test_a_stroke_that_says_nothing_has_the_usual_terms() -> None:
    assert terms_of_stroke(StrokeEnd()) == PathTerms() == ("release", 1.0, 0.0, None)
    assert terms_of(PATH) == PathTerms()


@given(TERMS)
def test_a_stroke_carries_its_terms_and_gives_them_back(terms: PathTerms) -> None:
    end = stroke_end(terms, StrokeUse.REDRAW, 2, preview=True)
    assert terms_of_stroke(end) == terms
    assert (end.use, end.robot, end.preview) == ("redraw", 2, True)


@given(TERMS)
def test_a_path_is_followed_on_the_terms_that_it_was_given(terms: PathTerms) -> None:
    path = with_terms(PATH, terms)
    assert terms_of(path, terms.smoothing) == terms
    assert path.spline is PATH.spline, "it goes the same way"
    assert path.duration == (terms.duration or math.inf)


@given(TERMS, st.sampled_from([{"ending": "loop"}, {"pace": 0.5}, {"duration": 7.0}, {"duration": 0.0}]))
def test_a_change_leaves_the_other_terms_as_they_are(terms: PathTerms, change: dict[str, object]) -> None:
    command = ShapePath(**change)  # pyright: ignore[reportArgumentType]
    assert changed_terms(terms, command) == terms._replace(**change)
    assert terms_of(shaped(with_terms(PATH, terms), command), terms.smoothing) == terms._replace(**change)


@pytest.mark.parametrize(
    ("terms", "said"),
    [
        (PathTerms(ending="stop"), "path ending: 'stop' is not one of release, hold, loop"),
        (PathTerms(pace=0.1), "pace 0.1 is outside 0.2 to 1.5"),
        (PathTerms(duration=-1.0), "duration -1 s is not at least 0 s"),
        (PathTerms(duration=math.nan), "duration nan s is not at least 0 s"),
    ],
)
def test_terms_that_cannot_be_are_refused(terms: PathTerms, said: str) -> None:
    with pytest.raises(PathError, match=said):
        with_terms(PATH, terms)
