"""Refusals in the log: each kind once a minute, short, on one line."""

import logging

import pytest

from higvf_console.ui.page.refusals import MOST_CHARACTERS, Refusals, cut


def test_each_kind_is_logged_once_a_minute_with_a_count(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    now = [100.0]
    monkeypatch.setattr("higvf_console.ui.page.refusals.monotonic", lambda: now[0])
    refusals = Refusals()
    for _ in range(1000):
        refusals.tell("stroke", "page 1", "stroke points: no number")
        refusals.tell("click", "page 1", "click point: no number")
    assert len(caplog.messages) == 2
    now[0] += 61.0
    refusals.tell("stroke", "page 2", "stroke points: no number")
    assert caplog.messages[2:] == [
        "refused from page 2: stroke points: no number (1000 of this kind since the last report)"
    ]


def test_what_came_from_outside_is_cut_and_stays_on_its_line() -> None:
    assert cut("short") == "short"
    assert len(cut("x" * 1_000_000)) == MOST_CHARACTERS
    assert cut("first\nforged line\x1b[31m") == r"first\nforged line\x1b[31m"


def test_a_failure_of_our_own_comes_with_its_traceback(caplog: pytest.LogCaptureFixture) -> None:
    Refusals().tell("failed", "page 1", "key", failure=KeyError("name"))
    assert caplog.records[0].levelno == logging.ERROR
    assert caplog.records[0].exc_info is not None
