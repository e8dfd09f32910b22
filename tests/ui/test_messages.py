"""One line tells the latest message, or an alarm that still stands."""

from typing import Any

from higvf_console.core.events import Event, Severity
from higvf_console.ui.messages import STAY_S, LatestMessage, newer


def event(kind: str, severity: Severity = Severity.INFO, text: str = "It happened.", **about: Any) -> Event:
    return Event(1.0, severity, kind, text, **about)


STOP = event("stop", Severity.ALARM)


def test_the_latest_message_is_shown_and_then_the_alarm_that_still_stands() -> None:
    line = LatestMessage()
    refused = event("refused", Severity.WARNING, "Not done.")
    assert line.chosen([STOP], [STOP], 0.0) is STOP
    assert line.chosen([refused], [STOP], 1.0) is refused
    assert line.chosen([], [STOP], 1.1 + STAY_S[Severity.WARNING]) is STOP
    assert line.chosen([], [], 20.0) is refused, "the cause has ended; what came last stays"


def test_an_alarm_that_was_withdrawn_leaves_the_line() -> None:
    line = LatestMessage()
    assert line.chosen([STOP], [STOP], 0.0) is STOP
    assert line.chosen([], [], 1.0) is STOP, "but not before it could be read"
    assert line.chosen([], [], 1.0 + STAY_S[Severity.ALARM]) is None


def test_a_message_keeps_the_line_for_a_while_against_lesser_ones() -> None:
    line = LatestMessage()
    out, target = event("extinguished", Severity.GOOD, "Fire 1 is out."), event("target")
    assert line.chosen([STOP, out], [STOP], 0.0) is STOP
    assert line.chosen([out, target], [STOP], 1.0 + STAY_S[Severity.ALARM]) is out
    assert line.chosen([target], [], 100.0) is target


def test_an_answer_to_what_was_done_is_not_covered_by_other_warnings() -> None:
    line = LatestMessage()
    refused, busy = (event(kind, Severity.WARNING) for kind in ("refused", "busy"))
    assert line.chosen([refused], [], 0.0) is refused
    assert line.chosen([busy], [], 1.0) is refused
    assert line.chosen([STOP], [STOP], 2.0) is STOP
    assert line.chosen([refused], [STOP], 3.0) is refused


def test_what_the_operator_has_just_done_is_only_logged() -> None:
    assert LatestMessage().chosen([event("resumed"), event("path"), event("picked")], [], 0.0) is None
    target = event("target")
    assert LatestMessage().chosen([target], [], 0.0) is target


def test_only_events_after_the_last_seen_are_new() -> None:
    a, b, c = (event("target", text=text) for text in "abc")
    assert newer([a, b, c], a) == [b, c]
    assert newer([a, b, c], c) == []
    assert newer([b, c], a) == [b, c]


def test_two_equal_events_are_two() -> None:
    first, second = event("target"), event("target")
    assert newer([first, second], first) == [second]
