"""Dwelling gaze presses the button once, and not again during the refractory time."""

from collections.abc import Callable, Iterable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from higvf_console.core.commands import StrokeBegin, StrokeEnd, StrokePoints
from higvf_console.core.errors import InputError
from higvf_console.core.interface import InputSpec, OperatorContext
from higvf_interfaces.gaze.dwell_button import DWELL, IDLE, REFRACTORY, DwellButton, step
from higvf_interfaces.gaze.interface import open_gaze

TICK = 0.02


def rested(on: Iterable[bool]) -> list[DwellButton]:
    """The button after each tick."""
    button, history = IDLE, list[DwellButton]()
    for count, here in enumerate(on):
        button = step(button, count * TICK, here)
        history.append(button)
    return history


def presses(history: list[DwellButton]) -> list[float]:
    return [count * TICK for count, button in enumerate(history) if button.pressed]


def test_dwelling_gaze_presses_once_per_dwell_and_refractory_time() -> None:
    times = presses(rested([True] * 130))
    assert times == pytest.approx([DWELL, DWELL + REFRACTORY + DWELL], abs=2 * TICK)


def test_progress_grows_to_one_and_falls_to_zero_when_gaze_leaves() -> None:
    growing = [button.progress for button in rested([True] * 41)]
    assert growing == sorted(growing)
    assert growing[-1] == 1.0
    assert rested([True] * 30 + [False] * 10)[-1].progress == 0.0


def test_a_blink_keeps_the_progress_and_a_glance_away_does_not() -> None:
    assert presses(rested([True] * 20 + [False] * 4 + [True] * 30)) == pytest.approx([DWELL], abs=2 * TICK)
    assert presses(rested([True] * 20 + [False] * 8 + [True] * 30)) == []


@given(on=st.lists(st.booleans(), max_size=300))
def test_presses_are_at_least_dwell_and_refractory_time_apart(on: list[bool]) -> None:
    history = rested(on)
    times = presses(history)
    assert all(later - earlier >= DWELL + REFRACTORY - 1e-9 for earlier, later in pairwise(times))
    assert all(0 <= button.progress <= 1 for button in history)


def test_resting_on_the_button_starts_and_ends_a_stroke_without_drawing_the_button(
    write: Callable[..., str], at: Callable[..., OperatorContext]
) -> None:
    stops = [(0.05, 0.95), (0.3, 0.5), (0.5, 0.5), (0.7, 0.4), (0.8, 0.3), (0.05, 0.95), (0.5, 0.5)]
    rests = [(x, y) for x, y in stops for _ in range(100)]
    rows = "".join(f"{k / 100},{x},{y}\n" for k, (x, y) in enumerate(rests))
    options = {"frame": "unit", "clutch": "dwell", "screen": "1200x700"}
    gaze = open_gaze(InputSpec("gaze", write("time,x,y\n" + rows), options))
    commands = [c for k in range(350) for c in gaze.poll(at(k * TICK))]
    strokes = [(type(c), c.time) for c in commands if isinstance(c, StrokeBegin | StrokeEnd)]
    assert [kind for kind, _ in strokes] == [StrokeBegin, StrokeEnd]
    assert [time for _, time in strokes] == pytest.approx([0.8, 5.8], abs=0.05)
    drawn = [point for c in commands if isinstance(c, StrokePoints) for point in c.points.tolist()]
    np.testing.assert_allclose(drawn, [[360, 350], [600, 350], [840, 420], [960, 490]], atol=1.0)


def test_a_button_off_the_screen_is_refused(write: Callable[..., str]) -> None:
    file = write("time,x [px],y [px]\n0,1,2\n")
    with pytest.raises(InputError, match=r"button: \[0.9, 0.0, 1.1, 1.0\] is not \[left, top, right, bottom\]"):
        open_gaze(InputSpec("gaze", file, settings={"clutch": "dwell", "button": [0.9, 0.0, 1.1, 1.0]}))


def test_the_report_of_the_button_has_its_outline_and_progress(
    write: Callable[..., str], at: Callable[..., OperatorContext]
) -> None:
    rows = "".join(f"{k / 100},0.05,0.95\n" for k in range(300))
    file = write("time,x,y\n" + rows)
    options = {"frame": "unit", "clutch": "dwell", "screen": "1200x700"}
    gaze = open_gaze(InputSpec("gaze", file, options))
    for k in range(21):
        gaze.poll(at(k * TICK))
    report = gaze.dwell_report()
    assert report is not None
    assert report.progress == pytest.approx(0.4 / DWELL, abs=0.05)
    np.testing.assert_allclose(report.outline, [[0, 105], [120, 105], [120, 0], [0, 0], [0, 105]], atol=1e-9)
    held = open_gaze(InputSpec("gaze", file, {**options, "clutch": "held"}))
    held.poll(at(0.2))
    assert held.dwell_report() is None
