"""What the cards say: the briefing, the result and the scenarios to choose from."""

import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.runtime.history import Entry
from higvf_console.runtime.phase import EndReason
from higvf_console.runtime.result import RunResult, WithoutOperator
from higvf_console.runtime.session import Session
from higvf_console.scenario.kept import Recent
from higvf_console.scenario.scenario import load_scenario, parse_scenario, scenario_names
from higvf_console.ui.cards.briefing import end_line, hidden_lines, mission_lines, ready_html
from higvf_console.ui.cards.picture import MOST_ROBOTS, scenario_svg
from higvf_console.ui.cards.result_sheet import actions_html, losses_html, order_line, result_html
from higvf_console.ui.cards.scenarios import recent_choices, scenarios_html, shipped_choices

PLAIN = """
version: 1
title: <b>Two</b> & more
arena: {size_m: [600, 300]}
robots: {start_m: [[100, 150], [100, 200]]}
fires: [{at_m: [500, 150], radius_m: 5}]
briefing: Mind the <bar>.
"""
BAR = "obstacles: {bars: [{from_m: [300, 20], to_m: [300, 280], half_width_m: 5}]}\n"


def told(text: str) -> str:
    return ready_html(Session(parse_scenario(text, "t.yaml"), []).snapshot)


def test_the_briefing_names_the_fire_that_no_robot_sees_and_what_hides_it() -> None:
    assert "No robot sees fire 1: bar 1 hides it." in told(PLAIN + BAR)
    short = "parameters: {perception: {perception_range: 150}}\n"
    lines = hidden_lines(Session(parse_scenario(PLAIN + short, "t.yaml"), []).snapshot)
    assert lines == ["No robot sees fire 1: it is too far away.", "Robots see fires up to 150 m away."]
    assert "Every robot sees every fire now" in told(PLAIN)


def test_the_firefighting_briefing_tells_of_the_hidden_fire() -> None:
    assert any("fire 5" in line for line in hidden_lines(Session(load_scenario("firefighting"), []).snapshot))


def test_the_briefing_shows_the_scenario_s_texts_as_text() -> None:
    html = told(PLAIN)
    assert "&lt;b&gt;Two&lt;/b&gt; &amp; more" in html
    assert "Mind the &lt;bar&gt;." in html


def test_the_mission_says_how_many_robots_each_fire_takes_and_when_the_run_ends() -> None:
    lines = mission_lines(Session(parse_scenario(PLAIN, "t.yaml"), []).snapshot)
    assert lines == [
        "1 fire to put out; it takes 2 of 2 robots.",
        "The run ends when all fires are out, or after 2:00.0.",
    ]


@pytest.mark.parametrize(
    ("ends", "line"),
    [
        ("{when: never}", "The run has no end: take your time."),
        ("{when: path_finished, after_s: 3}", "The run ends 3 s after the path is finished, or after 2:00.0."),
    ],
)
def test_every_end_is_told(ends: str, line: str) -> None:
    assert end_line(parse_scenario(f"{PLAIN}ends: {ends}\n", "t.yaml"), fires=True) == line


RESULT = RunResult(
    reason=EndReason.ALL_FIRES_OUT,
    time=64.7,
    loss_area=floats([1898.0, 31240.0]),
    order=(1, 0),
    without=WithoutOperator(73.9, floats([1898.2, 36943.0]), (0, 1)),
    min_clearance=1.8,
    infeasible_ticks=0,
    deadlock_s=0.0,
    actions=(Entry(46.2, "Robot 1 follows <a path>.", False),),
)


def test_the_result_compares_each_fire_and_all_of_them() -> None:
    html = losses_html(RESULT)
    assert '<td class="dim">same</td>' in html
    assert "\u22125\u202f703 (\u221215.4\u00a0%)" in html
    assert "\u22125\u202f703 (\u221214.7\u00a0%)" in html
    assert "NaN" not in losses_html(RESULT._replace(without=None)).replace("nan", "NaN")
    assert "No fires" in losses_html(RESULT._replace(loss_area=floats([])))


def test_the_result_names_reason_order_clearance_and_actions() -> None:
    html = result_html(RESULT, "Firefighting")
    assert "All fires are out" in html
    assert "1:04.7" in html
    assert "2 \u2192 1" in html
    assert "without operator: 1 \u2192 2, all out after 1:13.9" in html
    assert "1.8 m" in html
    assert "Robot 1 follows &lt;a path&gt;." in html
    assert set(re.findall(r'data-act="(\w+)"', html)) == {"again", "continue", "report", "scenarios"}


def test_a_result_with_no_end_of_the_other_run_says_up_to_when_it_was_compared() -> None:
    early = RESULT._replace(without=WithoutOperator(64.7, floats([1.0, 2.0]), (0,)), min_clearance=math.inf)
    assert "without operator: 1, by 1:04.7" in order_line(early)
    assert "nothing near" in result_html(early, "Firefighting")


def test_a_long_list_of_actions_is_cut_and_counted() -> None:
    assert "and 10 more" in actions_html(tuple(Entry(float(n), "Pause.", False) for n in range(50)))


def test_every_shipped_scenario_has_a_picture_that_is_the_same_each_time() -> None:
    choices = shipped_choices()
    assert [choice.value for choice in choices] == [f"shipped:{name}" for name in scenario_names()]
    for choice in choices:
        ET.fromstring(choice.picture)
        assert "nan" not in choice.picture
        assert len(choice.picture) < 12_000
    assert choices == shipped_choices()


def test_a_picture_shows_each_thing_once_and_of_a_swarm_some() -> None:
    svg = scenario_svg(load_scenario("firefighting"))
    assert svg.count("<circle") == 5 + 5 + 3
    assert svg.count("stroke-linecap") == 1
    assert svg.count("var(--hg-robot)") == 3
    assert scenario_svg(load_scenario("swarm")).count("var(--hg-robot)") <= MOST_ROBOTS


def test_north_is_up_in_a_picture() -> None:
    robots = re.findall(r'cy="([\d.]+)"[^>]*--hg-robot', scenario_svg(parse_scenario(PLAIN, "t.yaml")))
    assert float(robots[0]) > float(robots[1])


def test_a_line_without_ends_is_drawn_within_reach() -> None:
    line = parse_scenario(f"{PLAIN}path: {{line: {{at_m: [100, 100], angle_deg: 30}}}}\n", "t.yaml")
    numbers = [float(number) for number in re.findall(r"-?\d+\.\d", scenario_svg(line))]
    assert np.abs(numbers).max() < 1000.0


def test_the_scenario_that_runs_is_marked_and_one_that_cannot_be_used_says_why() -> None:
    recent = recent_choices([Recent("Mine", "mine.yaml", PLAIN), Recent("Broken", "broken.yaml", "version: 9\n")])
    html = scenarios_html(shipped_choices(), recent, PLAIN)
    assert html.count("aria-current") == 1
    assert html.count(" disabled") == 1
    assert "broken.yaml" in html
