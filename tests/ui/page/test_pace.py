"""How much a page may say, at which rate."""

from higvf_console.ui.page.pace import Bucket, Limits, Pace

LIMITS = Limits(messages=10.0, messages_at_once=20.0, bytes=1000.0, bytes_at_once=2000.0, excess=2.0)


def test_a_bucket_gives_what_it_holds_at_once_and_its_rate_on_and_on() -> None:
    bucket = Bucket(rate=2.0, burst=3.0)
    assert [bucket.take(1, 0.0) for _ in range(4)] == [True, True, True, False]
    assert [bucket.take(1, 1.0) for _ in range(3)] == [True, True, False]
    assert [bucket.take(1, 100.0) for _ in range(4)] == [True, True, True, False], "it never holds more than its burst"


def test_an_honest_pace_passes_for_ever() -> None:
    pace = Pace(LIMITS)
    assert all(pace.allows(100, second / 10) for second in range(1000))
    assert pace.dropped == 0


def test_messages_beyond_the_soft_limit_are_counted_and_borne_up_to_the_hard_one() -> None:
    pace = Pace(LIMITS)
    assert sum(pace.allows(1, 0.0) for _ in range(100)) == 20
    assert sum(pace.bears(1, 0.0) for _ in range(100)) == 40
    assert pace.dropped == 100


def test_bytes_are_limited_as_messages_are() -> None:
    pace = Pace(LIMITS)
    assert [pace.allows(1500, 0.0), pace.allows(1500, 0.0), pace.allows(1500, 1.0)] == [True, False, True]
    assert [pace.bears(3000, 1.0), pace.bears(3000, 1.0)] == [True, False]
