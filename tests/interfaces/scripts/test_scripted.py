"""A script fires each entry once, at its time or event, and refuses what it does not know."""

from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.core.commands import (
    Clutch,
    Command,
    EmergencyStop,
    MovePathPoint,
    OperatorCommand,
    Pause,
    Pick,
    ResetRun,
    Resume,
    StrokeBegin,
    StrokeEnd,
    StrokePoints,
    Undo,
)
from higvf_console.core.edits import AddEntity
from higvf_console.core.errors import InputError, ScriptError
from higvf_console.core.interface import ChannelState, InputSpec, OperatorContext
from higvf_interfaces.scripts.file import DETAILS
from higvf_interfaces.scripts.interface import ScriptPlayer, open_script

WITH = {
    "stroke": ", points_m: [[0, 0], [1, 1]]",
    "pick": ", robot: 1",
    "stop_robot": ", robot: 1",
    "release_robot": ", robot: 1",
    "clutch": ", closed: true",
    "add": ", kind: fire, at_m: [1, 2]",
    "add_outline": ", points_m: [[0, 0], [9, 0], [0, 9]]",
    "move": ", kind: bar, number: 2, at_m: [3, 4.5]",
    "change": ", kind: bar, number: 1, name: half width, value: 7",
    "delete": ", kind: polygon, number: 3",
    "link": ", robots: [1, 3]",
    "set_arena": ", sides_m: [0, -1, 10, 20]",
    "set_parameters": ", parameters: {safety: {pair_gain: 9}, boundaries: {bump_in: 0.2, bump_out: 0.3}}",
    "prioritise": ", fires: [2, 3], robot: 1, factor: 4",
    "shape_path": ", ending: hold, duration_s: 3",
    "move_path_point": ", grip_m: [1, 2], to_m: [3, 4]",
    "take_up_path": ", number: 1",
    "forget_path": ", number: 2",
}
ContextAt = Callable[..., OperatorContext]
Write = Callable[..., str]


def script(file: str) -> ScriptPlayer:
    return open_script(InputSpec("script", file))


def types(commands: list[OperatorCommand]) -> list[type[Command]]:
    return [type(command) for command in commands]


def test_entries_fire_once_in_order_of_time_and_then_of_the_file(write: Write, at: ContextAt) -> None:
    player = script(
        write("- {at_s: 2, do: stop}\n- {at_s: 1, do: pause}\n- {at_s: 2, do: resume}\n- {at_s: 0, do: next_task}\n")
    )
    assert [type(c).__name__ for c in player.poll(at(0.0))] == ["NextTask"]
    assert types(player.poll(at(5.0))) == [Pause, EmergencyStop, Resume]
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
    text = "".join(f"- {{at_s: 0, do: {action}{WITH.get(action, '')}}}\n" for action in DETAILS)
    given = script(write(text)).poll(at(0.0))
    assert [type(c).__name__ for c in given] == [
        "StrokeBegin", "StrokePoints", "StrokeEnd", "Pick", "StopRobot", "ReleaseRobot", "Clutch", "Pause", "Resume",
        "EmergencyStop", "AskReset", "ResetEmergencyStop", "ClearPath", "ReversePath", "NextTask", "ResetRun",
        "Confirm", "Discard", "Acknowledge", "Undo", "Redo", "Disarm", "AskArm", "Arm", "AddEntity", "AddOutlines",
        "MoveEntity", "ChangeEntity", "DeleteEntity", "ToggleLink", "LinkByRange", "SetArena", "SetParameters",
        "Prioritise", "ShapePath", "MovePathPoint", "TakeUpPath", "ForgetPath",
    ]  # fmt: skip
    assert [c.closed for c in given if isinstance(c, Clutch)] == [True]


def given(write: Write, at: ContextAt, entry: str) -> dict[str, object]:
    """The fields of the last command of an entry, without where it comes from."""
    command = script(write(f"- {{at_s: 0, do: {entry}}}\n")).poll(at(0.0))[-1]
    return {name: value for name, value in vars(command).items() if name not in vars(Undo())}


def test_numbers_of_people_count_from_one_and_those_of_commands_from_zero(write: Write, at: ContextAt) -> None:
    assert given(write, at, "delete" + WITH["delete"]) == {"kind": "polygon", "index": 2}
    assert given(write, at, "link" + WITH["link"]) == {"first": 0, "second": 2}
    assert given(write, at, "prioritise" + WITH["prioritise"]) == {"fires": (1, 2), "robot": 0, "factor": 4.0}
    assert given(write, at, "prioritise") == {"fires": (), "robot": None, "factor": None}
    assert given(write, at, "take_up_path" + WITH["take_up_path"]) == {"number": 0}
    change = given(write, at, "change" + WITH["change"])
    assert change == {"kind": "bar", "index": 0, "name": "half width", "value": 7.0}
    moved = given(write, at, "move" + WITH["move"])
    assert (moved["kind"], moved["index"]) == ("bar", 1)
    np.testing.assert_array_equal(moved["point"], [3.0, 4.5])  # pyright: ignore[reportArgumentType]


def test_parameters_are_given_as_in_a_scenario(write: Write, at: ContextAt) -> None:
    values = {"safety.pair_gain": 9.0, "boundaries.bump_in": 0.2, "boundaries.bump_out": 0.3}
    assert given(write, at, "set_parameters" + WITH["set_parameters"]) == {"values": values}


def test_what_is_left_out_of_the_shape_of_a_path_stays_as_it_is(write: Write, at: ContextAt) -> None:
    shape = given(write, at, "shape_path" + WITH["shape_path"])
    assert shape == {"ending": "hold", "pace": None, "duration": 3.0, "closed": None}


def test_a_stroke_says_what_it_is_for_and_how_its_path_is_followed(write: Write, at: ContextAt) -> None:
    end = given(write, at, "stroke, points_m: [[0, 0], [1, 1]], use: redraw, ending: loop, pace: 0.5, duration_s: 9")
    bend = given(write, at, "move_path_point, grip_m: [1, 2], to_m: [3, 4], preview: true")
    assert bend["preview"] is True
    assert (end["use"], end["ending"], end["pace"], end["duration"]) == ("redraw", "loop", 0.5, 9.0)


def test_a_script_may_use_the_robots_that_it_adds(write: Write) -> None:
    file = write("- {at_s: 1, do: add, kind: robot, at_m: [0, 0]}\n- {at_s: 2, do: pick, robot: 4}\n")
    open_script(InputSpec("script", file, robots=3))
    file = write("- {at_s: 1, do: prioritise, fires: [1], robot: 4}\n")
    with pytest.raises(ScriptError, match="there is no robot 4"):
        open_script(InputSpec("script", file, robots=3))


def test_a_run_that_starts_again_fires_again_but_not_the_scripts_own_reset(write: Write, at: ContextAt) -> None:
    player = script(write("- {at_s: 1, do: pause}\n- {at_s: 2, do: reset_run}\n- {at_s: 3, do: resume}\n"))
    assert types(player.poll(at(2.0))) == [Pause, ResetRun]
    assert player.poll(at(0.0)) == []
    assert types(player.poll(at(9.0))) == [Pause, Resume]


def test_health_counts_what_is_done(write: Write, at: ContextAt) -> None:
    player = script(write("- {at_s: 1, do: pause}\n- {at_s: 5, do: resume}\n"))
    player.poll(at(2.0))
    assert player.health(2.0)[:2] == (ChannelState.LIVE, "1 of 2 actions done")
    player.poll(at(5.0))
    assert player.health(5.0)[:2] == (ChannelState.ENDED, "2 of 2 actions done")
    player.close()
    player.close()


def test_a_robot_that_is_not_there_is_refused_when_the_script_is_opened(write: Write) -> None:
    file = write("- {at_s: 50, do: pick, robot: 4}\n")
    with pytest.raises(ScriptError, match=r"file.txt, entry 1: robot: there is no robot 4; give 1 to 3"):
        open_script(InputSpec("script", file, robots=3))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("- {at_s: 1, do: dance}", "entry 1: do: 'dance' is not one of stroke, pick, stop_robot"),
        ("- {at_s: 1}", "entry 1: do: None is not one of stroke"),
        ("- {at_s: 1, do: pause}\n- {at_s: 1, do: pause, robot: 1}", "entry 2: robot: unknown key; value 1"),
        ("- {do: pause}", "entry 1: give either at_s: SECONDS or when: {EVENT: NUMBER}"),
        ("- {at_s: 1, when: {extinguished: 1}, do: pause}", "entry 1: give either at_s"),
        ("- {at_s: 1, after_s: 1, do: pause}", "entry 1: after_s goes with when:"),
        ("- {at_s: -1, do: pause}", "entry 1: at_s: -1 is not a number from 0 to 1e+06 s"),
        ("- {at_s: .nan, do: pause}", "entry 1: at_s: nan is not a number"),
        ("- {at_s: '1', do: pause}", "entry 1: at_s: '1' is not a number"),
        ("- {at_s: true, do: pause}", "entry 1: at_s: True is not a number"),
        ("- {when: {burnt: 1}, do: pause}", "entry 1: when.burnt: unknown key; value 1; known keys: extinguished"),
        ("- {when: {extinguished: 0}, do: pause}", "entry 1: when.extinguished: 0 is not a whole number from 1 up"),
        ("- {when: {}, do: pause}", "entry 1: when: give one event"),
        ("- {when: 3, do: pause}", "entry 1: when: 3 is not a section with the keys extinguished"),
        ("- {at_s: 1, do: pick}", "entry 1: the key 'robot' is missing; known keys: at_s"),
        ("- {at_s: 1, do: pick, robot: 0}", "entry 1: robot: 0 is not a whole number from 1 up"),
        ("- {at_s: 1, do: clutch, closed: 1}", "entry 1: closed: 1 is not true or false"),
        ("- {at_s: 1, do: stroke}", "entry 1: the key 'points_m' is missing"),
        ("- {at_s: 1, do: stroke, points_m: []}", "entry 1: points_m: 0 points are too few; give at least 1"),
        ("- {at_s: 1, do: stroke, points_m: [[0, 0], [1]]}", "entry 1: points_m[2]: [1] is not a point [x, y]"),
        ("- {at_s: 1, do: stroke, points_m: [[0, .inf]]}", "entry 1: points_m[1][2]: inf is not a number"),
        ("- {at_s: 1, do: add, at_m: [0, 0]}", "entry 1: the key 'kind' is missing"),
        ("- {at_s: 1, do: add, kind: polygon, at_m: [0, 0]}", "'polygon' is not one of robot, fire, circle, bar"),
        ("- {at_s: 1, do: move, kind: lake, number: 1, at_m: [0, 0]}", "kind: 'lake' is not one of robot, fire"),
        ("- {at_s: 1, do: move, kind: bar, number: 0, at_m: [0, 0]}", "number: 0 is not a whole number from 1 up"),
        ("- {at_s: 1, do: move, kind: bar, number: 1, at_m: 3}", "at_m: 3 is not a list of 2 numbers"),
        ("- {at_s: 1, do: link, robots: [1]}", "robots: [1] is not a pair of robots such as [1, 2]"),
        ("- {at_s: 1, do: link, robots: [1, x]}", "robots[2]: 'x' is not a whole number from 1 up"),
        ("- {at_s: 1, do: prioritise, fires: 2}", "fires: 2 is not a list"),
        ("- {at_s: 1, do: prioritise, factor: 0}", "factor: 0 is not a number from 1 to"),
        ("- {at_s: 1, do: shape_path}", "give at least one of ending, pace, duration_s, closed"),
        ("- {at_s: 1, do: shape_path, ending: stop}", "ending: 'stop' is not one of release, hold, loop"),
        ("- {at_s: 1, do: set_parameters}", "the key 'parameters' is missing"),
        ("- {at_s: 1, do: set_parameters, parameters: {safety: 3}}", "parameters.safety: 3 is not a mapping"),
        ("- {at_s: 1, do: set_parameters, parameters: {safety: {pair_gain: on}}}", "safety.pair_gain: 'on' is not"),
        ("- {at_s: 1, do: stroke, points_m: [[0, 0]], use: paint}", "use: 'paint' is not one of path, redraw"),
        ("- {at_s: 1, do: [pause]}", "entry 1: do: ['pause'] is not one of"),
        ("- pause", "entry 1: 'pause' is not an entry"),
        ("at_s: 1", "a script is a list of entries"),
        ("[]", "a script is a list of entries"),
        ("- {at_s: 1, do: add, thing: bar, kind: bar, at_m: [0, 0]}", "thing is the former name of kind"),
        ("- {at_s: 1, at_s: 2, do: pause}", "line 1: key 'at_s' is given twice"),
        ("- {at_s: 1", "file.txt: line 1: "),
        ("[" * 200, "brackets are nested over 100 deep"),
    ],
)  # fmt: skip
def test_a_wrong_script_is_refused_with_place_value_and_choices(write: Write, text: str, message: str) -> None:
    with pytest.raises(ScriptError) as refusal:
        script(write(text))
    assert message in str(refusal.value)
    assert "file.txt" in str(refusal.value)


OLD = """
- {at_s: 0, do: add, thing: circle, at_m: [1, 2]}
- {at_s: 0, do: bend_path, grip_m: [1, 2], to_m: [3, 4]}
- {at_s: 0, do: stroke, points_m: [[0, 0], [1, 1]], use: amend}
"""


def test_former_names_are_read_and_the_present_ones_are_named(write: Write, at: ContextAt) -> None:
    player = script(write(OLD))
    given = player.poll(at(0.0))
    assert types(given) == [AddEntity, MovePathPoint, StrokeBegin, StrokePoints, StrokeEnd]
    assert [vars(given[0])["kind"], vars(given[-1])["use"]] == ["circle", "redraw"]
    entries = [warning.partition("file.txt, ")[2] for warning in player.warnings]
    assert entries == [
        "entry 1: thing: renamed; write kind",
        "entry 2: do: bend_path is renamed; write move_path_point",
        "entry 3: use: amend is renamed; write redraw",
    ]


def test_a_script_with_the_names_of_today_warns_of_nothing(write: Write) -> None:
    assert script(write("- {at_s: 1, do: add, kind: circle, at_m: [1, 2]}")).warnings == ()


def test_a_missing_script_and_any_option_are_refused(write: Write) -> None:
    with pytest.raises(ScriptError, match=r"nowhere.yaml: No such file"):
        script("nowhere.yaml")
    with pytest.raises(InputError, match="a script has no option 'start'; options of every channel: latency, jitter"):
        open_script(InputSpec("script", write("- {at_s: 1, do: pause}\n"), options={"start": "1"}))
