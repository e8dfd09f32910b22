"""A script fires each entry once, at its time or event, and refuses what it does not know."""

from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.commands import (
    ChannelState,
    Clutch,
    Command,
    InputSpec,
    OperatorCommand,
    OperatorContext,
    Pause,
    Pick,
    ResetRun,
    Resume,
    Stop,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.errors import InputError, ScriptError
from higvf_interfaces.emulation import EmulatedInterface
from higvf_interfaces.script_file import DETAILS
from higvf_interfaces.scripted import ScriptPlayer, open_script

ContextAt = Callable[..., OperatorContext]
Write = Callable[..., str]


def script(file: str) -> ScriptPlayer | EmulatedInterface:
    return open_script(InputSpec("script", file))


def types(commands: list[OperatorCommand]) -> list[type[Command]]:
    return [type(command) for command in commands]


def test_entries_fire_once_in_order_of_time_and_then_of_the_file(write: Write, at: ContextAt) -> None:
    player = script(
        write("- {at_s: 2, do: stop}\n- {at_s: 1, do: pause}\n- {at_s: 2, do: resume}\n- {at_s: 0, do: next_task}\n")
    )
    assert [type(c).__name__ for c in player.poll(at(0.0))] == ["NextTask"]
    assert types(player.poll(at(5.0))) == [Pause, Stop, Resume]
    assert player.poll(at(6.0)) == []


def test_a_time_is_met_on_its_own_tick(write: Write, at: ContextAt) -> None:
    player = script(write("- {at_s: 0.3, do: pause}\n"))
    assert player.poll(at(0.28)) == []
    assert types(player.poll(at(0.1 + 0.2 - 1e-12))) == [Pause]


def test_an_event_fires_when_that_fire_is_out(write: Write, at: ContextAt) -> None:
    player = script(write("- when: {extinguished: 3}\n  do: pick\n  robot: 2\n"))
    assert player.poll(at(1.0, extinguished=(0, 1))) == []
    (pick,) = player.poll(at(2.0, extinguished=(0, 1, 2)))
    assert isinstance(pick, Pick)
    assert (pick.robot, pick.time, pick.source) == (1, 2.0, "script")
    assert player.poll(at(3.0, extinguished=(0, 1, 2))) == []


def test_an_event_counts_the_fires_that_are_out(write: Write, at: ContextAt) -> None:
    player = script(write("- {when: {extinguished_count: 2}, do: pause}\n"))
    assert player.poll(at(1.0, extinguished=(4,))) == []
    assert types(player.poll(at(2.0, extinguished=(4, 0)))) == [Pause]


def test_after_delays_an_entry_behind_its_event(write: Write, at: ContextAt) -> None:
    player = script(write("- {when: {extinguished: 1}, after_s: 0.5, do: pause}\n"))
    assert player.poll(at(1.0, extinguished=(0,))) == []
    assert player.poll(at(1.48, extinguished=(0,))) == []
    assert [command.time for command in player.poll(at(1.5, extinguished=(0,)))] == [1.5]


def test_a_stroke_without_duration_is_drawn_at_once(write: Write, at: ContextAt) -> None:
    file = write("- {at_s: 1, do: stroke, points_m: [[0, 0], [10, 5], [20, 0]], robot: 3, smoothing_m: 2}\n")
    begin, points, end = script(file).poll(at(1.0))
    assert isinstance(begin, StrokeBegin)
    assert isinstance(points, StrokePoints)
    assert points.points.tolist() == [[0, 0], [10, 5], [20, 0]]
    assert isinstance(end, StrokeEnd)
    assert (end.robot, end.smoothing) == (2, 2.0)


def test_a_stroke_with_a_duration_arrives_point_by_point(write: Write, at: ContextAt) -> None:
    player = script(write("- {at_s: 1, do: stroke, points_m: [[0, 0], [1, 0], [2, 0]], over_s: 2}\n"))
    assert types(player.poll(at(1.0))) == [StrokeBegin, StrokePoints]
    assert types(player.poll(at(1.9))) == []
    assert types(player.poll(at(2.0))) == [StrokePoints]
    assert types(player.poll(at(3.0))) == [StrokePoints, StrokeEnd]
    assert player.health(3.0).state is ChannelState.ENDED


def test_other_entries_fire_while_a_stroke_is_drawn_in_order_of_time(write: Write, at: ContextAt) -> None:
    file = write("- {at_s: 1, do: stroke, points_m: [[0, 0], [1, 0], [2, 0]], over_s: 2}\n- {at_s: 2.5, do: pause}\n")
    commands = script(file).poll(at(9.0))
    assert types(commands) == [StrokeBegin, StrokePoints, StrokePoints, Pause, StrokePoints, StrokeEnd]
    assert [command.sequence for command in commands] == list(range(6))


def test_a_new_stroke_takes_the_place_of_an_unfinished_one(write: Write, at: ContextAt) -> None:
    file = write(
        "- {at_s: 0, do: stroke, points_m: [[0, 0], [1, 0], [2, 0]], over_s: 4}\n"
        "- {at_s: 1, do: stroke, points_m: [[7, 7], [8, 8], [9, 9]]}\n"
    )
    commands = script(file).poll(at(9.0))
    assert types(commands) == [StrokeBegin, StrokePoints, StrokeBegin, StrokePoints, StrokeEnd]
    last = commands[3]
    assert isinstance(last, StrokePoints)
    np.testing.assert_array_equal(last.points, [[7, 7], [8, 8], [9, 9]])


def test_every_action_of_the_list_gives_its_command(write: Write, at: ContextAt) -> None:
    details = {"stroke": ", points_m: [[0, 0], [1, 1]]", "pick": ", robot: 1", "clutch": ", closed: true"}
    text = "".join(f"- {{at_s: 0, do: {action}{details.get(action, '')}}}\n" for action in DETAILS)
    given = script(write(text)).poll(at(0.0))
    assert [type(c).__name__ for c in given] == [
        "StrokeBegin", "StrokePoints", "StrokeEnd", "Pick", "Clutch", "Pause", "Resume", "Stop", "AskReset",
        "ResetStop", "ClearPath", "ReversePath", "NextTask", "ResetRun", "Confirm", "Discard",
    ]  # fmt: skip
    assert [c.closed for c in given if isinstance(c, Clutch)] == [True]


def test_a_run_that_starts_again_fires_again_but_not_the_scripts_own_reset(write: Write, at: ContextAt) -> None:
    player = script(write("- {at_s: 1, do: pause}\n- {at_s: 2, do: reset_run}\n- {at_s: 3, do: resume}\n"))
    assert types(player.poll(at(2.0))) == [Pause, ResetRun]
    assert player.poll(at(0.0)) == []
    assert types(player.poll(at(9.0))) == [Pause, Resume]


def test_health_counts_what_is_done(write: Write, at: ContextAt) -> None:
    player = script(write("- {at_s: 1, do: pause}\n- {at_s: 5, do: resume}\n"))
    player.poll(at(2.0))
    assert player.health(2.0) == (ChannelState.LIVE, "1 of 2 actions done")
    player.poll(at(5.0))
    assert player.health(5.0) == (ChannelState.ENDED, "2 of 2 actions done")
    player.close()
    player.close()


def test_a_robot_that_is_not_there_is_refused_when_the_script_is_opened(write: Write) -> None:
    file = write("- {at_s: 50, do: pick, robot: 4}\n")
    with pytest.raises(ScriptError, match=r"file.txt, entry 1: robot: there is no robot 4; give 1 to 3"):
        open_script(InputSpec("script", file, robots=3))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("- {at_s: 1, do: dance}", "entry 1: do: 'dance' is not an action; known actions: stroke, pick, clutch"),
        ("- {at_s: 1}", "entry 1: do: None is not an action"),
        ("- {at_s: 1, do: pause}\n- {at_s: 1, do: pause, robot: 1}", "entry 2: unknown key 'robot'; known keys: at_s"),
        ("- {do: pause}", "entry 1: give either at_s: SECONDS or when: {EVENT: NUMBER}"),
        ("- {at_s: 1, when: {extinguished: 1}, do: pause}", "entry 1: give either at_s"),
        ("- {at_s: 1, after_s: 1, do: pause}", "entry 1: after_s goes with when:"),
        ("- {at_s: -1, do: pause}", "entry 1: at_s: -1 is not a number from 0 to 1e+06 s"),
        ("- {at_s: .nan, do: pause}", "entry 1: at_s: nan is not a number"),
        ("- {at_s: '1', do: pause}", "entry 1: at_s: '1' is not a number"),
        ("- {at_s: true, do: pause}", "entry 1: at_s: True is not a number"),
        ("- {when: {burnt: 1}, do: pause}", "entry 1: when: unknown key 'burnt'; known keys: extinguished"),
        ("- {when: {extinguished: 0}, do: pause}", "entry 1: when: extinguished: 0 is not a whole number from 1 up"),
        ("- {when: {}, do: pause}", "entry 1: when: give one event"),
        ("- {when: 3, do: pause}", "entry 1: when: 3 is not a mapping"),
        ("- {at_s: 1, do: pick}", "entry 1: robot is missing"),
        ("- {at_s: 1, do: pick, robot: 0}", "entry 1: robot: 0 is not a whole number from 1 up"),
        ("- {at_s: 1, do: clutch, closed: 1}", "entry 1: closed: 1 is neither true nor false"),
        ("- {at_s: 1, do: stroke}", "entry 1: points_m is missing"),
        ("- {at_s: 1, do: stroke, points_m: []}", "entry 1: points_m: [] is not a list of points"),
        ("- {at_s: 1, do: stroke, points_m: [[0, 0], [1]]}", "entry 1: points_m: point 2: [1] is not [x, y] in metres"),
        ("- {at_s: 1, do: stroke, points_m: [[0, .inf]]}", "entry 1: points_m: point 1: [0, inf] is not [x, y]"),
        ("- {at_s: 1, do: [pause]}", "entry 1: do: ['pause'] is not an action"),
        ("- pause", "entry 1: 'pause' is not an entry"),
        ("at_s: 1", "a script is a list of entries"),
        ("[]", "a script is a list of entries"),
        ("- {at_s: 1, at_s: 2, do: pause}", "the key 'at_s' is given more than once"),
        ("- {at_s: 1", "is not YAML"),
        ("[" * 200, "brackets are nested over 100 deep"),
    ],
)  # fmt: skip
def test_a_wrong_script_is_refused_with_place_value_and_choices(write: Write, text: str, message: str) -> None:
    with pytest.raises(ScriptError) as refusal:
        script(write(text))
    assert message in str(refusal.value)
    assert "file.txt" in str(refusal.value)


def test_a_missing_script_and_any_option_are_refused(write: Write) -> None:
    with pytest.raises(ScriptError, match="cannot be read"):
        script("nowhere.yaml")
    with pytest.raises(InputError, match="unknown key 'start'"):
        open_script(InputSpec("script", write("- {at_s: 1, do: pause}\n"), options={"start": "1"}))


def test_a_scripted_stroke_may_wait_for_a_scripted_confirm(write: Write, at: ContextAt) -> None:
    text = """
- {at_s: 0, do: stroke, points_m: [[0, 0], [1, 1]], preview: true}
- {at_s: 1, do: confirm}
"""
    given = script(write(text)).poll(at(1.0))
    assert [type(c).__name__ for c in given][-2:] == ["StrokeEnd", "Confirm"]
    assert isinstance(given[2], StrokeEnd)
    assert given[2].preview
