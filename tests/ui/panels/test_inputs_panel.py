"""What the panel of inputs says; pure, without a browser."""

import numpy as np

from higvf_console.core.arrays import floats
from higvf_console.core.interface import ChannelHealth, ChannelState
from higvf_console.core.reports import AttentionReport, CalibrationReport, CaptureReport, DecisionReport
from higvf_console.core.viewport import Arena
from higvf_console.ui.widgets.inputs_tables import (
    MOST_ROBOTS,
    STAGE_WORDS,
    attention_html,
    calibration_html,
    channels_html,
    decisions_html,
)
from higvf_interfaces.decisions.debouncer import Stage

DECIDED = DecisionReport(
    label="fist", confidence=0.62, stage="hysteresis", votes=3, votes_needed=3, of=5, threshold=0.6, support=0.4,
    enter=0.8, leave=0.5, active="open", refractory=0.7, passed=4, proposed=1, unknown=2,
    held=(("threshold", 7), ("vote", 0), ("hysteresis", 1), ("onset", 0), ("refractory", 0)),
)  # fmt: skip


EYE = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def attention(fires: list[float], robots: list[float], elsewhere: float = 0.0) -> AttentionReport:
    heat, extent = np.zeros((7, 12)), Arena(0, 0, 1200, 700)
    return AttentionReport(
        heat=heat,
        extent=extent,
        degree=25.0,
        fires=floats(fires),
        robots=floats(robots),
        elsewhere=elsewhere,
        fixation_rate=2.5,
        fixation_duration=0.31,
        transition_entropy=0.42,
    )


def test_each_input_is_told_with_its_state_and_why() -> None:
    html = channels_html([("gaze", ChannelHealth(ChannelState.LOST, "last seen <3 s ago"))])
    assert "gaze" in html
    assert "lost" in html
    assert "last seen &lt;3 s ago" in html


def test_the_stages_of_a_debouncer_are_told_in_their_order_with_what_they_held() -> None:
    html = decisions_html("emg", DECIDED)
    for words in ("0.62", "3/5", "0.40", "0.8 / 0.5", "open", "0.7 s", "too little support", "2 unknown", "1 of them"):
        assert words in html
    order = [html.index(f"<td>{stage}</td>") for stage in ("Confidence", "Votes", "Support", "Onset", "Refractory")]
    assert order == sorted(order)
    assert html.count("<td>7</td>") == 1


def test_before_the_first_decision_nothing_is_made_up() -> None:
    fresh = DECIDED._replace(label="", confidence=None, stage="", votes=0, support=0.0, refractory=0.0)
    html = decisions_html("emg", fresh)
    assert "no decision yet" in html
    assert "0.00" not in html


def test_every_stage_has_words() -> None:
    assert {stage.value for stage in Stage} < set(STAGE_WORDS)


def test_a_label_is_never_markup() -> None:
    assert "<img" not in decisions_html("<img>", DECIDED._replace(label="<img>", active="<img>"))


def test_attention_is_told_in_seconds_and_shares() -> None:
    html = attention_html(attention([3.0, 0.0], [1.0], 4.0))
    shares = ("38\u00a0%", "12\u00a0%", "50\u00a0%")
    for words in ("Fire 1", "Robot 1", "Elsewhere", "3.0", *shares, "2.50 /s", "310 ms", "0.42"):
        assert words in html
    assert "No input reports" in attention_html(None)


def test_a_large_team_shares_one_line_and_loses_no_time() -> None:
    html = attention_html(attention([], [1.0] * (MOST_ROBOTS + 8)))
    assert f"Robots {MOST_ROBOTS + 1} to {MOST_ROBOTS + 8}" in html
    assert "<td>8.0</td>" in html


def test_the_calibration_is_told_with_its_error_and_file() -> None:
    points = ((0.0, 0.0),) * 5
    report = CalibrationReport(
        file="a<b.yaml",
        made="2026-03-02",
        screen_px=(1920.0, 1080.0),
        points_px=points,
        points_m=points,
        homography=EYE,
        residual_px=4.25,
        residual_m=1.5,
    )
    html = calibration_html([("gaze", report)], CaptureReport("", outcome="in use"))
    for words in ("5 points", "4.2 px", "1.50 m", "a&lt;b.yaml", "2026-03-02", "in use"):
        assert words in html
    assert "None in use" in calibration_html([], CaptureReport("gaze is replayed"))
    assert "Target 2 of 5, 50\u00a0%" in calibration_html([], CaptureReport("", floats([1, 2]), 2, 5, 0.5))
