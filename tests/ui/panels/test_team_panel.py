"""What the Team panel says and does; without a browser."""

import re
from contextlib import suppress
from typing import Any

import numpy as np
import viser

from higvf_console.core.commands import AskArm, Disarm, EmergencyStop, OperatorCommand, StopRobot
from higvf_console.core.team import RobotLink
from higvf_console.team.state import opened
from higvf_console.ui.panels.team import TeamPanel
from higvf_console.ui.widgets.team_tables import LIT, MOST_ROWS, arming_html, lamps_html, robot_word, robots_html
from higvf_console.ui.widgets.why_tables import guard_html
from tests.fake_interfaces import FakeConsole
from tests.rehearsal import Rehearsal


def lamps(run: Rehearsal) -> list[str]:
    return re.findall(r">([^<]+)</span>", lamps_html(run.team))


def test_the_three_lamps_of_a_stop_are_lit_one_after_the_other() -> None:
    run = Rehearsal("latency_s=0.06").arm()
    run.last(3.0)
    assert "No robot is told to stand" in lamps_html(run.team)
    run.give(EmergencyStop())
    assert [lamp[0] == LIT for lamp in lamps(run)] == [True, False, False]
    run.last(0.1)
    assert [lamp[0] == LIT for lamp in lamps(run)] == [True, True, False]
    run.last(0.5)
    assert [lamp[0] == LIT for lamp in lamps(run)] == [True, True, True]


def test_a_team_that_confirms_nothing_has_no_lit_lamp_for_it() -> None:
    run = Rehearsal()
    run.plant.relink = lambda links: (RobotLink(),) * len(links)
    run.last(1.0)
    assert any("acknowledged: unknown" in lamp for lamp in lamps(run))
    assert not run.team.acknowledged.any()


def test_each_robot_has_a_word_the_gravest_first() -> None:
    run = Rehearsal().arm()
    run.last(3.0)
    assert [robot_word(run.team, robot)[0] for robot in range(3)] == ["drives"] * 3
    run.give(StopRobot(1))
    run.last(1.0)
    assert [robot_word(run.team, robot)[0] for robot in range(3)] == ["drives", "stopped", "drives"]
    team = run.team._replace(disobedient=np.array([False, True, False]), stale=np.array([True, False, False]))
    assert [robot_word(team, robot) for robot in range(3)] == [
        ("not seen", "warn"),
        ("drives on", "alarm"),
        ("drives", ""),
    ]
    assert "must stand" in guard_html(run.session.snapshot.last.guard, 1)
    assert "must stand" not in guard_html(run.session.snapshot.last.guard, 0)


def test_a_large_team_has_a_row_only_where_something_is_the_matter() -> None:
    run = Rehearsal()
    run.beat()
    rules = run.session.snapshot.rules
    assert rules is not None
    team = opened(100)
    seen = team.track._replace(measured_at=np.where(np.arange(100) == 7, -np.inf, 0.0), anchored_at=np.full(100, -1.0))
    html = robots_html(team._replace(track=seen), rules, np.zeros(100), 3)
    assert html.count("<tr") == 2
    assert "<td>8</td>" in html
    assert "and 99 more robots" in html
    assert robots_html(team, rules, np.zeros(100), 3).count("<tr") == MOST_ROWS + 1


def test_words_of_an_adapter_are_no_markup() -> None:
    team = opened(1)._replace(failure="<b>x</b>", links=(RobotLink(detail='"><i>'),))
    run = Rehearsal()
    run.beat()
    rules = run.session.snapshot.rules
    assert rules is not None
    assert "<b>x" not in arming_html(team)
    assert "<i>" not in robots_html(team, rules, np.zeros(1), 3)


class Gui:
    """Widgets that remember what they are given."""

    def __init__(self) -> None:
        self.made: list[Any] = []

    def __getattr__(self, _kind: str) -> Any:
        def make(label: str = "", *_: Any, **options: Any) -> Any:
            class Widget:
                def on_click(self, act: Any) -> None:
                    self.act = act

                on_update = on_click

            widget = Widget()
            vars(widget).update(label=label, content="", value=None, update_timestamp=0.0, **options)
            self.made.append(widget)
            return widget

        return make


def press(widget: Any) -> None:
    """A page presses a button."""
    event = viser.GuiEvent(client=None, client_id=1, target=widget)
    with suppress(StopIteration):
        widget.act(event).send(None)


def test_the_buttons_arm_in_two_steps_and_stop_one_robot() -> None:
    run, sink, gui = Rehearsal(), FakeConsole(), Gui()
    panel = TeamPanel(gui, 3, sink)  # type: ignore[arg-type]
    arm, disarm, one = (widget for widget in gui.made if hasattr(widget, "icon"))

    def pressed(widget: Any) -> list[OperatorCommand]:
        sink.plan.clear()
        press(widget)
        return [command for _, command in sink.plan]

    run.last(0.5)
    panel.update(run.session.snapshot)
    assert (arm.label, arm.disabled, disarm.disabled) == ("Check the team", False, True)
    (asked,) = pressed(arm)
    assert isinstance(asked, AskArm)
    run.give(asked)
    panel.update(run.session.snapshot)
    assert arm.disabled
    run.last(2.0)
    panel.update(run.session.snapshot)
    assert arm.label == "Arm: let the team drive"
    run.give(*pressed(arm))
    assert run.team.armed
    run.give(*pressed(one))
    assert run.team.stopped.tolist() == [True, False, False]
    panel.update(run.session.snapshot)
    assert one.label == "Release this robot"
    run.give(*pressed(one))
    assert not run.team.stopped.any()
    (disarmed,) = pressed(disarm)
    assert isinstance(disarmed, Disarm)
