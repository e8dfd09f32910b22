"""What the panels say, and what they take from a page; pure, without a browser."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from higvf_console.analysis.baseline import Baseline
from higvf_console.analysis.preview import Future, Preview
from higvf_console.control.guidance.paths import sketch_path
from higvf_console.core.arrays import floats
from higvf_console.core.events import Event, Severity
from higvf_console.core.interface import ChannelHealth, ChannelState
from higvf_console.core.state import PathStatus, SimState
from higvf_console.sim.simulation import advance
from higvf_console.ui.panels.fires import MOST_SAMPLES, LossHistory, summary_html
from higvf_console.ui.panels.preview import preview_html
from higvf_console.ui.panels.status import (
    filter_line,
    margin_line,
    steering_line,
)
from higvf_console.ui.widgets.channel_mark import CHANNEL_MARK, channel_html
from higvf_console.ui.widgets.chart import Curve, chart_svg
from higvf_console.ui.widgets.event_list import MOST_SHOWN, log_html
from higvf_console.ui.widgets.fire_table import fire_table_html
from higvf_console.ui.widgets.html import area, clock
from higvf_console.ui.widgets.speeds import nearest_speed
from tests.teams import team

SETUP = team(fires=[(500.0, 250.0, 20.0), (300.0, 450.0, 30.0)])
STATE, TRACE = advance(SETUP.start, SETUP.world, SETUP.params)


def with_intent(**changes: Any) -> SimState:
    return STATE._replace(intent=STATE.intent._replace(**changes))


def event(kind: str, severity: Severity = Severity.INFO, text: str = "It happened.") -> Event:
    return Event(1.0, severity, kind, text)


def test_the_steering_line_names_robot_and_progress_either_way_round() -> None:
    path = sketch_path(floats([[100, 100], [200, 100], [300, 100]]), 0.0)
    state = with_intent(influenced=2, path=path)
    quarter = state._replace(motion=state.motion._replace(path_parameter=50.0, path_status=int(PathStatus.FOLLOWING)))
    back = quarter._replace(intent=quarter.intent._replace(path=path._replace(direction=-1.0)))
    done = quarter._replace(motion=quarter.motion._replace(path_status=int(PathStatus.FINISHED)))
    assert "robot 3</span>, on its path, 25\u00a0%" in steering_line(quarter, near=300.0)
    assert "75\u00a0%" in steering_line(back, near=300.0)
    assert "finished" in steering_line(done, near=300.0)
    assert 'robot 1</span>, <span class="dim">no path yet' in steering_line(STATE, near=300.0)


def test_a_robot_far_from_its_path_is_heading_for_it() -> None:
    path = sketch_path(floats([[100, 100], [200, 100], [300, 100]]), 0.0)
    state = with_intent(path=path)
    far = state._replace(motion=state.motion._replace(path_status=int(PathStatus.FOLLOWING), path_parameter=0.0))
    assert steering_line(far, near=40.0).endswith("heading for its path")
    half_way = far._replace(motion=far.motion._replace(path_parameter=100.0))
    assert steering_line(half_way, near=40.0).endswith("heading for its path, 50\u00a0%")
    on_it = far.motion.position.copy()
    on_it[0] = (100.0, 139.0)
    assert steering_line(far._replace(motion=far.motion._replace(position=on_it)), near=40.0).endswith("on its path")


def test_a_violated_clearance_stands_out_and_where_nothing_is_near_that_is_said() -> None:
    assert "alarm" in margin_line(4.0, -0.2)
    assert "alarm" not in margin_line(4.0, 0.2)
    assert margin_line(math.inf, math.inf) == "nothing near so far"
    assert margin_line(4.13, 1.8) == '4.1 m<span class="dim">, minimum</span> 1.8 m'
    assert margin_line(math.inf, 0.2).startswith("nothing near")


def test_the_filter_line_counts_robots_without_a_safe_velocity() -> None:
    calm = SimpleNamespace(trace=TRACE, infeasible_ticks=0, deadlock_s=0.0)
    trouble = SimpleNamespace(
        trace=TRACE._replace(infeasible=np.array([True, True, False])), infeasible_ticks=7, deadlock_s=1.5
    )
    assert filter_line(calm) == "OK"  # pyright: ignore[reportArgumentType]
    assert "2 infeasible" in filter_line(trouble)  # pyright: ignore[reportArgumentType]
    assert "(7 ticks infeasible, robots held for 1.5 s)" in filter_line(trouble)  # pyright: ignore[reportArgumentType]


def test_the_filter_line_counts_robots_that_stand_too_near() -> None:
    near = SimpleNamespace(
        trace=TRACE._replace(barrier=np.array([-0.1, 0.0, -0.2])), infeasible_ticks=0, deadlock_s=0.0
    )
    assert "2 too near" in filter_line(near)  # pyright: ignore[reportArgumentType]


def test_what_devices_and_scenarios_say_is_never_markup() -> None:
    evil = "<img src=x onerror=alert(1)>"
    channel = channel_html(evil, ChannelHealth(ChannelState.STALE, f'"{evil}'))
    curve = Curve(evil, floats([0, 1]), floats([0, 1]), "#fff")
    for html in (channel, log_html([event("refused", text=evil)]), chart_svg([curve], "s", "m²")):
        assert "<img" not in html
        assert "&lt;img" in html


def test_times_and_areas_read_easily() -> None:
    assert [clock(t) for t in (0.0, 9.96, 59.96, 754.2)] == ["0:00.0", "0:10.0", "1:00.0", "12:34.2"]
    assert area(1234567.4) == "1\u202f234\u202f567"


def test_the_log_is_newest_first_and_ends() -> None:
    events = [event("target", text=f"Number {i}.") for i in range(MOST_SHOWN + 5)]
    html = log_html(events)
    assert html.count("Number") == MOST_SHOWN
    assert html.index(f"Number {MOST_SHOWN + 4}.") < html.index(f"Number {MOST_SHOWN + 3}.")


def test_alarms_that_nobody_has_acknowledged_stand_out_in_the_log() -> None:
    read, unread = event("stop", Severity.ALARM, "first"), event("stop", Severity.ALARM, "second")
    html = log_html([read, unread], [unread])
    assert "class=alarm>second" in html
    assert "class=alarm>first" not in html


def test_the_loss_curve_thins_itself_and_starts_anew_with_the_run() -> None:
    history = LossHistory()
    for tick in range(200_000):
        history.add(0.02 * tick, float(tick))
    time, loss = history.curve()
    assert 100 < len(time) <= MOST_SAMPLES
    assert time[0] == 0.0
    assert time[-1] > 0.98 * 4000.0
    assert np.diff(time).max() < 1.1 * np.diff(time).min()
    assert loss == pytest.approx(time / 0.02)
    history.add(0.0, 1.0)
    assert history.curve()[0].tolist() == [0.0]


def test_the_chart_draws_the_other_run_dashed_and_marks_where_this_one_is() -> None:
    this_run = Curve("this run", floats([0, 10]), floats([0, 500]), "#ff0")
    other = Curve("without operator", floats([0, 20]), floats([0, 1000]), "#999", dashed=True)
    svg = chart_svg([this_run, other], "s", "m²")
    assert svg.count("<polyline") == 2
    assert svg.count("<circle") == 1
    assert 'stroke-dasharray="5 4"' in svg
    assert "nan" not in chart_svg([Curve("this run", floats([]), floats([]), "#ff0")], "s", "m²")


def test_the_summary_compares_at_the_same_time() -> None:
    loss = floats([1000, 2000, 3000])
    baseline = Baseline(floats([0, 10, 20]), loss, loss[:, None], np.ones((3, 1), np.bool_))
    assert "1\u202f500" in summary_html(5.0, 1200.0, baseline)
    assert "without operator" not in summary_html(5.0, 1200.0, None)


def test_the_fire_table_tells_burning_fought_and_out_apart() -> None:
    motion = STATE.motion._replace(fire_burning=np.array([False, True]), fire_progress=floats([1.0, 0.75]))
    burnt = floats([1256.6, 2827.4])
    shown = SimpleNamespace(setup=SETUP, state=STATE._replace(motion=motion), trace=TRACE, loss_area=burnt)
    html = fire_table_html(shown)  # pyright: ignore[reportArgumentType]
    assert ">out<" in html
    assert "50\u00a0% put out" in html
    assert "0/2" in html
    assert "1\u202f257" in html


def test_the_speed_list_shows_the_nearest_offered_speed() -> None:
    assert nearest_speed(1.0)[0] == "1"
    assert nearest_speed(0.3).startswith("0.25")
    assert nearest_speed(7.5)[0] == "8"


def preview(**changes: Any) -> Preview:
    path = sketch_path(floats([[100, 100], [200, 100], [300, 100]]), 0.0)
    futures = Future(((1, 4.0), (0, 9.0)), 3000.0), Future(((0, 6.0),), 4000.0)
    foreseen = Preview(
        with_intent(path=path), False, 20.0, np.zeros((3, 2, 2)), *futures, 2.5, None, None, None, 7.5,
        floats([], 0, 2, 2),
    )  # fmt: skip
    return foreseen._replace(**changes)


def test_the_preview_compares_with_doing_nothing() -> None:
    html = preview_html(preview())
    assert "3\u202f000 m²" in html
    assert "\u22121\u202f000 m², \u221225.0\u00a0%" in html
    assert "2 \u2192 1" in html
    assert "(without your path: 1)" in html
    assert "2.5 m" in html
    assert "finished in 7.5 s" in html
    assert "warn" not in html
    worse = preview_html(preview(otherwise=Future((), 2000.0)))
    assert '"warn">+1\u202f000 m²' in worse
    assert "as without it" in preview_html(preview(otherwise=Future((), 3000.2)))


def test_the_preview_warns_of_what_would_go_wrong() -> None:
    pieces = floats([[[0, 0], [30, 0]], [[30, 0], [30, 12]]])
    html = preview_html(preview(deadlock=3.0, infeasible=4.0, given_up=9.0, finish=None, repulsive=pieces))
    for words in ("Held by barriers in 3.0 s", "No safe velocity in 4.0 s", "given up after 9.0 s", "42 m of the path"):
        assert words in html
    assert "alarm" in preview_html(preview(clearance=-0.1))


def test_the_preview_says_when_it_begins_and_whom_it_would_pick() -> None:
    assert "from now" in preview_html(preview())
    assert "after Resume" in preview_html(preview(resumed=True))
    assert "robot 3" in preview_html(preview(), proposed=2)
    assert "takes longer than 20 s" in preview_html(preview(finish=None))


def test_every_state_of_an_input_has_a_shape_of_its_own_and_a_word_unless_it_is_live() -> None:
    assert set(CHANNEL_MARK) == set(ChannelState)
    assert len({mark for mark, _ in CHANNEL_MARK.values()}) == len(ChannelState), "colour alone tells nothing"
    for state in ChannelState:
        html = channel_html("gaze", ChannelHealth(state, "why"))
        assert (f">{state.value}<" in html) == (state is not ChannelState.LIVE)
