"""The view yields to the control loop, and recovers."""

import pytest

from higvf_console.ui.frame_pace import FRAME, SLOWEST, FramePace


def test_the_view_slows_down_while_time_is_lost_and_recovers_in_steps() -> None:
    pace = FramePace()
    late = [pace.frame(0.1 * k, 0.5 * k) / FRAME for k in range(1, 12)]
    assert late == sorted(late)
    assert late[0] == 2.0
    assert late[-1] == SLOWEST
    after = [pace.frame(1.1, 5.5 + k) / FRAME for k in range(1, 40)]
    assert after[3] == SLOWEST
    assert after[-1] == 1.0
    assert after == sorted(after, reverse=True)


def test_a_run_in_time_is_shown_at_the_full_rate() -> None:
    pace = FramePace()
    assert [pace.frame(0.0, 0.1 * k) for k in range(100)] == pytest.approx([FRAME] * 100)
