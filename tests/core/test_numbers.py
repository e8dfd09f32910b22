"""Numbers as people read them."""

from higvf_console.core.numbers import percent


def test_a_percent_sign_stands_behind_a_space_that_does_not_break() -> None:
    assert percent(0.124) == "12\u00a0%"
    assert percent(0.0819, 1) == "8.2\u00a0%"
