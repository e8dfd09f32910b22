"""The playhead returns each index of a log once, on the session clock."""

from higvf_console.core.arrays import floats
from higvf_interfaces.streams import Playhead


def test_each_index_is_returned_once_when_it_is_due() -> None:
    playhead = Playhead(floats([0.0, 1.0, 1.0, 3.0]))
    assert [list(playhead.advance(now)) for now in (0.0, 0.5, 1.0, 2.0, 9.0, 9.5)] == [[0], [], [1, 2], [], [3], []]


def test_an_entry_at_the_time_of_a_tick_is_due_on_that_tick() -> None:
    assert list(Playhead(floats([0.3])).advance(0.1 + 0.2 - 1e-12)) == [0]


def test_a_clock_that_goes_back_restarts_the_log() -> None:
    playhead = Playhead(floats([0.0, 1.0]))
    playhead.advance(5.0)
    assert playhead.ended
    assert list(playhead.advance(0.0)) == [0]
    assert not playhead.ended
    assert list(playhead.advance(1.0)) == [1]


def test_entries_before_the_run_are_never_played() -> None:
    playhead = Playhead(floats([-2.0, -1.0, 0.5]))
    assert list(playhead.advance(0.0)) == []
    assert not playhead.started
    assert list(playhead.advance(1.0)) == [2]
