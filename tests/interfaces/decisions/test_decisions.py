"""Decoded labels become commands by the label map; other labels are counted and reported."""

from collections.abc import Callable

import pytest

from higvf_console.core.commands import (
    AskReset,
    ClearPath,
    Clutch,
    Command,
    EmergencyStop,
    NextTask,
    OperatorCommand,
    Pause,
    Pick,
    ResetEmergencyStop,
    ResetRun,
    Resume,
    ReversePath,
)
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelState, InputSpec, OperatorContext
from higvf_interfaces.decisions.bci import open_bci
from higvf_interfaces.decisions.emg import open_emg
from higvf_interfaces.decisions.interface import DecisionReplay

ContextAt = Callable[..., OperatorContext]
Write = Callable[..., str]


def log(*labels: str, spacing: float = 1.0) -> str:
    """A log with one of `labels` every `spacing` seconds, starting at `spacing`; `label,0.5` has a confidence."""
    return "time,label,confidence\n" + "".join(f"{(k + 1) * spacing},{label}\n" for k, label in enumerate(labels))


def emg(file: str, **settings: object) -> DecisionReplay:
    return open_emg(InputSpec("emg", file, settings=settings))


def types(commands: list[OperatorCommand]) -> list[type[Command]]:
    return [type(command) for command in commands]


def test_gestures_give_their_default_commands_at_their_own_times(write: Write, at: ContextAt) -> None:
    replay = emg(write(log("fist,0.9", "pinch", "spread", "open", "rest")))
    given = [command for k in range(60) for command in replay.poll(at(k * 0.1))]
    assert types(given) == [Pause, Clutch, Clutch, Resume]
    assert [command.time for command in given] == [1, 2, 3, 4]
    assert [command.confidence for command in given] == [0.9, None, None, None]
    assert [c.closed for c in given if isinstance(c, Clutch)] == [True, False]
    assert {command.source for command in given} == {"emg"}
    assert "ignored" not in replay.health(6.0).detail, "a label that means nothing is not an unknown one"


def test_every_action_is_a_label_by_its_own_name(write: Write, at: ContextAt) -> None:
    expected = {
        "pause": Pause, "resume": Resume, "stop": EmergencyStop, "ask_reset": AskReset,
        "reset_stop": ResetEmergencyStop, "clear_path": ClearPath, "reverse_path": ReversePath, "next_task": NextTask,
        "reset_run": ResetRun,
        "clutch_close": Clutch, "clutch_open": Clutch,
    }  # fmt: skip
    given = emg(write(log(*expected))).poll(at(99.0))
    assert types(given) == list(expected.values())


@pytest.mark.parametrize("label", ["robot2", "2", "Robot2", " robot2 "])
def test_a_bci_class_picks_the_robot_of_that_number(write: Write, at: ContextAt, label: str) -> None:
    given = open_bci(InputSpec("bci", write(log(label)))).poll(at(9.0))
    assert [command.robot for command in given if isinstance(command, Pick)] == [1]


def test_the_scenarios_labels_override_the_defaults(write: Write, at: ContextAt) -> None:
    labels = {"fist": "stop", "point": "robot:3", "open": "none", 7: "pause", "spread": None}
    replay = emg(write(log("fist", "point", "open", "7", "spread", "pinch")), labels=labels)
    assert types(replay.poll(at(99.0))) == [EmergencyStop, Pick, Pause, Clutch]


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        ({"fist": "jump"}, "labels: fist: 'jump' is not an action; known actions: pause, resume, stop, ask_reset"),
        ({"fist": "robot:0"}, "'robot:0' is not an action"),
        ({True: "pause"}, "True is not text; put it in quotation marks"),
        (["fist"], "labels: ['fist'] is not a mapping"),
    ],
)
def test_a_wrong_label_map_is_refused_with_the_known_actions(write: Write, labels: object, message: str) -> None:
    with pytest.raises(InputError) as refusal:
        emg(write(log("fist")), labels=labels)
    assert message in str(refusal.value)


def test_unknown_labels_are_ignored_and_counted(write: Write, at: ContextAt) -> None:
    replay = emg(write(log("wave", "fist", "wave", "nod")))
    assert types(replay.poll(at(9.0))) == [Pause]
    detail = replay.health(9.0).detail
    assert "2 x unknown label 'wave'" in detail
    assert "1 x unknown label 'nod'" in detail


def test_the_status_shows_the_most_frequent_of_many_unknown_labels(write: Write, at: ContextAt) -> None:
    replay = emg(write(log(*(f"noise{k}" for k in range(500)), "wave", "wave")))
    replay.poll(at(999.0))
    assert "2 x unknown label 'wave'" in replay.health(999.0).detail
    assert len(replay.health(999.0).detail) < 300


def test_an_unknown_robot_is_not_selected(write: Write, at: ContextAt) -> None:
    replay = open_bci(InputSpec("bci", write(log("4", "3"))))
    assert [command.robot for command in replay.poll(at(9.0, robots=3)) if isinstance(command, Pick)] == [2]
    assert "there is no robot 4" in replay.health(9.0).detail


def test_the_threshold_rejects_low_confidence_and_passes_unknown_confidence(write: Write, at: ContextAt) -> None:
    replay = emg(write(log("fist,0.3", "fist,0.6", "fist")), threshold=0.6)
    assert [command.confidence for command in replay.poll(at(9.0))] == [0.6, None]
    assert "1 x confidence below 0.6" in replay.health(9.0).detail


def test_a_label_does_not_repeat_within_its_refractory_time(write: Write, at: ContextAt) -> None:
    replay = emg(write(log("fist", "fist", "open", "fist", "fist", spacing=0.5)), refractory=1.2)
    given = replay.poll(at(9.0))
    assert [(type(command), command.time) for command in given] == [(Pause, 0.5), (Resume, 1.5), (Pause, 2.0)]


def test_start_shifts_the_log_and_drops_entries_before_the_run(write: Write, at: ContextAt) -> None:
    file = write(log("fist", "open"))
    later = open_emg(InputSpec("emg", file, options={"start": "10"}))
    assert later.poll(at(10.9)) == []
    assert [command.time for command in later.poll(at(12.0))] == [11, 12]
    assert types(open_emg(InputSpec("emg", file, options={"start": "-1.5"})).poll(at(9.0))) == [Resume]


def test_a_run_that_starts_again_plays_the_log_again_but_not_its_own_reset(write: Write, at: ContextAt) -> None:
    replay = emg(write(log("fist", "reset_run", "open")), refractory=0.5)
    assert types(replay.poll(at(2.0))) == [Pause, ResetRun]
    assert replay.poll(at(0.0)) == []
    assert types(replay.poll(at(5.0))) == [Pause, Resume]


def test_health_runs_from_never_seen_over_live_to_ended(write: Write, at: ContextAt) -> None:
    replay = emg(write(log("fist,0.93", "open")))
    replay.poll(at(0.5))
    assert replay.health(0.5).state is ChannelState.NEVER_SEEN
    replay.poll(at(1.5))
    assert replay.health(1.5)[:2] == (ChannelState.LIVE, "latest: fist (0.93)")
    replay.poll(at(2.5))
    assert replay.health(2.5)[:2] == (ChannelState.ENDED, "replayed to its end; latest: open")
    replay.close()
    replay.close()


def test_wrong_options_are_refused_with_the_known_ones(write: Write) -> None:
    with pytest.raises(InputError, match=r"threshold: 2.0 is not a number from 0 to 1"):
        open_emg(InputSpec("emg", write(log("fist")), options={"threshold": "2"}))
    with pytest.raises(
        InputError, match=r"frame: unknown key.*; value .*; known keys: labels, threshold, refractory, start, format"
    ):
        open_emg(InputSpec("emg", write(log("fist")), options={"frame": "screen"}))
