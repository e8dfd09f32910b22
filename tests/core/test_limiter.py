"""Reports of one kind are limited, and what stays silent is counted."""

from higvf_console.core.limiter import Limiter


def test_the_first_is_reported_at_once_and_the_next_with_the_count_of_those_between() -> None:
    limiter = Limiter(every=60.0)
    assert [limiter.due("flood", now) for now in (0.0, 1.0, 59.0, 60.0, 61.0)] == [1, 0, 0, 3, 0]


def test_kinds_are_counted_apart() -> None:
    limiter = Limiter(every=60.0)
    assert limiter.due("a", 0.0, 5) == 5
    assert limiter.due("b", 1.0) == 1
    assert limiter.due("a", 2.0) == 0


def test_endless_kinds_share_one_report() -> None:
    limiter = Limiter(every=60.0)
    assert sum(limiter.due(kind, 0.0) > 0 for kind in range(5000)) <= 1025
