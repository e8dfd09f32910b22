"""The browser's queue keeps order, and whatever it must drop, it never drops a STOP."""

import threading
from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.core.arrays import floats
from higvf_console.core.commands import (
    Cursor,
    EmergencyStop,
    OperatorCommand,
    Pause,
    Pick,
    StrokeBegin,
    StrokeCancel,
    StrokeEnd,
    StrokePoints,
)
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelState, InputSpec, OperatorContext
from higvf_interfaces.mouse import Mouse, open_mouse

ContextAt = Callable[..., OperatorContext]


def points(first: float, count: int = 2) -> StrokePoints:
    return StrokePoints(floats([[first + k, 0.0] for k in range(count)]))


def kinds(commands: list[OperatorCommand]) -> list[str]:
    return [type(command).__name__ for command in commands]


def test_commands_come_out_in_order_stamped_with_time_source_and_a_running_number(at: ContextAt) -> None:
    mouse = open_mouse(InputSpec("mouse"))
    mouse.push(StrokeBegin())
    mouse.push(points(1.0))
    first = mouse.poll(at(2.0))
    mouse.push(Pause(source="someone", sequence=99))
    second = mouse.poll(at(2.5))
    assert kinds(first + second) == ["StrokeBegin", "StrokePoints", "Pause"]
    assert [command.time for command in first + second] == [2.0, 2.0, 2.5]
    assert [command.sequence for command in first + second] == [0, 1, 2]
    assert {command.source for command in first + second} == {"mouse"}
    assert mouse.poll(at(3.0)) == []


def test_a_command_keeps_the_operator_that_it_names(at: ContextAt) -> None:
    mouse = Mouse()
    mouse.push(Pause(operator="Browser 2"))
    mouse.push(Pause())
    context = at(0.0)._replace(operator="ada")
    assert [command.operator for command in mouse.poll(context)] == ["Browser 2", "ada"]


def test_a_full_queue_drops_old_cursors_before_anything_else(at: ContextAt) -> None:
    mouse = Mouse(capacity=4)
    for x in range(4):
        mouse.push(Cursor(floats([x, 0.0])))
    mouse.push(Pick(1))
    taken = mouse.poll(at(0.0))
    assert kinds(taken) == ["Cursor", "Pick"]
    assert isinstance(taken[0], Cursor)
    assert taken[0].point[0] == 3


def test_a_full_queue_joins_stroke_points_without_losing_one(at: ContextAt) -> None:
    mouse = Mouse(capacity=8)
    mouse.push(StrokeBegin())
    for x in range(0, 200, 2):
        mouse.push(points(float(x)))
    mouse.push(StrokeEnd())
    taken = mouse.poll(at(0.0))
    drawn = np.concatenate([command.points for command in taken if isinstance(command, StrokePoints)])
    assert drawn[:, 0].tolist() == list(range(200))
    assert kinds(taken)[0] == "StrokeBegin"
    assert kinds(taken)[-1] == "StrokeEnd"


def test_stroke_points_of_two_strokes_are_not_joined(at: ContextAt) -> None:
    mouse = Mouse(capacity=5)
    for command in (StrokeBegin(), points(0.0), StrokeCancel(), StrokeBegin(), points(10.0), points(12.0)):
        mouse.push(command)
    assert kinds(mouse.poll(at(0.0))) == ["StrokeBegin", "StrokePoints", "StrokeCancel", "StrokeBegin", "StrokePoints"]


@pytest.mark.parametrize("place", [0, 5, 99])
def test_stop_survives_any_flood(at: ContextAt, place: int) -> None:
    mouse = Mouse(capacity=10)
    for k in range(100):
        mouse.push(EmergencyStop() if k == place else Pick(k))
    taken = mouse.poll(at(0.0))
    assert len(taken) == 10
    assert kinds(taken).count("EmergencyStop") == 1


def test_a_flood_of_points_stays_bounded(at: ContextAt) -> None:
    mouse = Mouse(capacity=4)
    for _ in range(300):
        mouse.push(points(0.0, count=500))
    assert sum(len(c.points) for c in mouse.poll(at(0.0)) if isinstance(c, StrokePoints)) < 40_000


def test_pushes_from_many_threads_all_arrive(at: ContextAt) -> None:
    mouse = open_mouse(InputSpec("mouse"))

    def click() -> None:
        for _ in range(200):
            mouse.push(Pick(1))

    threads = [threading.Thread(target=click) for _ in range(8)]
    for thread in threads:
        thread.start()
    taken: list[OperatorCommand] = []
    while any(thread.is_alive() for thread in threads):
        taken += mouse.poll(at(0.0))
    taken += mouse.poll(at(0.0))
    assert len(taken) == 1600
    assert [command.sequence for command in taken] == list(range(1600))


def test_a_hand_off_the_mouse_is_no_fault(at: ContextAt) -> None:
    mouse = open_mouse(InputSpec("mouse"))
    assert mouse.health(0.0).state is ChannelState.NEVER_SEEN
    mouse.push(Pause())
    mouse.poll(at(1.0))
    assert mouse.health(900.0)[:2] == (ChannelState.LIVE, "last used 899 s ago")
    assert mouse.health(900.0).last_seen is None, "no page has ever told that it is there, so none can be missed"


def test_once_a_page_has_told_that_it_is_there_its_silence_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    wall = [50.0]
    monkeypatch.setattr("higvf_interfaces.mouse.monotonic", lambda: wall[0])
    mouse = open_mouse(InputSpec("mouse"))
    mouse.heartbeat()
    wall[0] += 3.0
    assert mouse.health(20.0).last_seen == pytest.approx(17.0)
    mouse.heartbeat()
    assert mouse.health(20.0).last_seen == pytest.approx(20.0)


def test_an_unknown_option_is_refused() -> None:
    with pytest.raises(InputError, match=r"stle: unknown key"):
        open_mouse(InputSpec("mouse", options={"stle": "5"}))


def test_a_file_is_refused() -> None:
    with pytest.raises(InputError, match=r"input mouse=look\.tsv: the mouse is the browser's and reads no file"):
        open_mouse(InputSpec("mouse", "look.tsv"))
