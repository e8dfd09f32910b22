"""The browser's queue keeps order, and whatever it must drop, it never drops a STOP."""

import threading
from collections.abc import Callable

import numpy as np
import pytest

from higvf_console.channels.console import ConsoleChannel, open_console
from higvf_console.core.arrays import floats
from higvf_console.core.awake import AwakeClock
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

ContextAt = Callable[..., OperatorContext]


@pytest.fixture
def at() -> ContextAt:
    """A context at a session time, with what else a test changes."""

    def context(time: float, **changes: object) -> OperatorContext:
        plain = OperatorContext(time, "operator", None, False, False, 0, (), 3)
        return plain._replace(**changes)

    return context


def points(first: float, count: int = 2) -> StrokePoints:
    return StrokePoints(floats([[first + k, 0.0] for k in range(count)]))


def kinds(commands: list[OperatorCommand]) -> list[str]:
    return [type(command).__name__ for command in commands]


def test_commands_come_out_in_order_stamped_with_time_source_and_a_running_number(at: ContextAt) -> None:
    console = open_console(InputSpec("console"))
    console.push(StrokeBegin())
    console.push(points(1.0))
    first = console.poll(at(2.0))
    console.push(Pause(source="someone", sequence=99))
    second = console.poll(at(2.5))
    assert kinds(first + second) == ["StrokeBegin", "StrokePoints", "Pause"]
    assert [command.time for command in first + second] == [2.0, 2.0, 2.5]
    assert [command.sequence for command in first + second] == [0, 1, 2]
    assert {command.source for command in first + second} == {"console"}
    assert console.poll(at(3.0)) == []


def test_a_command_keeps_the_operator_that_it_names(at: ContextAt) -> None:
    console = ConsoleChannel()
    console.push(Pause(operator="Browser 2"))
    console.push(Pause())
    context = at(0.0)._replace(operator="ada")
    assert [command.operator for command in console.poll(context)] == ["Browser 2", "ada"]


def test_a_full_queue_drops_old_cursors_before_anything_else(at: ContextAt) -> None:
    console = ConsoleChannel(capacity=4)
    for x in range(4):
        console.push(Cursor(floats([x, 0.0])))
    console.push(Pick(1))
    taken = console.poll(at(0.0))
    assert kinds(taken) == ["Cursor", "Pick"]
    assert isinstance(taken[0], Cursor)
    assert taken[0].point[0] == 3


def test_a_full_queue_joins_stroke_points_without_losing_one(at: ContextAt) -> None:
    console = ConsoleChannel(capacity=8)
    console.push(StrokeBegin())
    for x in range(0, 200, 2):
        console.push(points(float(x)))
    console.push(StrokeEnd())
    taken = console.poll(at(0.0))
    drawn = np.concatenate([command.points for command in taken if isinstance(command, StrokePoints)])
    assert drawn[:, 0].tolist() == list(range(200))
    assert kinds(taken)[0] == "StrokeBegin"
    assert kinds(taken)[-1] == "StrokeEnd"


def test_stroke_points_of_two_strokes_are_not_joined(at: ContextAt) -> None:
    console = ConsoleChannel(capacity=5)
    for command in (StrokeBegin(), points(0.0), StrokeCancel(), StrokeBegin(), points(10.0), points(12.0)):
        console.push(command)
    assert kinds(console.poll(at(0.0))) == [
        "StrokeBegin",
        "StrokePoints",
        "StrokeCancel",
        "StrokeBegin",
        "StrokePoints",
    ]


@pytest.mark.parametrize("place", [0, 5, 99])
def test_stop_survives_any_flood(at: ContextAt, place: int) -> None:
    console = ConsoleChannel(capacity=10)
    for k in range(100):
        console.push(EmergencyStop() if k == place else Pick(k))
    taken = console.poll(at(0.0))
    assert len(taken) == 11  # STOP has a place of its own, and goes first
    assert kinds(taken)[0] == "EmergencyStop"
    assert kinds(taken).count("EmergencyStop") == 1


def test_a_flood_of_points_stays_bounded(at: ContextAt) -> None:
    console = ConsoleChannel(capacity=4)
    for _ in range(300):
        console.push(points(0.0, count=500))
    assert sum(len(c.points) for c in console.poll(at(0.0)) if isinstance(c, StrokePoints)) < 40_000


def test_pushes_from_many_threads_all_arrive(at: ContextAt) -> None:
    console = open_console(InputSpec("console"))

    def click() -> None:
        for _ in range(200):
            console.push(Pick(1))

    threads = [threading.Thread(target=click) for _ in range(8)]
    for thread in threads:
        thread.start()
    taken: list[OperatorCommand] = []
    while any(thread.is_alive() for thread in threads):
        taken += console.poll(at(0.0))
    taken += console.poll(at(0.0))
    assert len(taken) == 1600
    assert [command.sequence for command in taken] == list(range(1600))


def test_a_console_that_nobody_uses_is_no_fault(at: ContextAt) -> None:
    console = open_console(InputSpec("console"))
    assert console.health(0.0).state is ChannelState.NEVER_SEEN
    console.push(Pause())
    console.poll(at(1.0))
    assert console.health(900.0)[:2] == (ChannelState.LIVE, "last used 899 s ago")
    assert console.health(900.0).last_seen is None, "no page has ever reported its presence, so none can be missed"


def test_once_a_page_has_told_that_it_is_there_its_silence_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    wall = [50.0]
    monkeypatch.setattr("higvf_console.channels.console.AwakeClock", lambda: AwakeClock(lambda: wall[0]))
    console = open_console(InputSpec("console"))
    console.heartbeat()
    for _ in range(4):
        wall[0] += 0.75
        console.health(20.0)
    assert console.health(20.0).last_seen == pytest.approx(17.0)
    console.heartbeat()
    assert console.health(20.0).last_seen == pytest.approx(20.0)
    wall[0] += 30.0
    assert console.health(20.0).last_seen == pytest.approx(19.0), "the console itself was stopped, not the page silent"


def test_an_unknown_option_is_refused() -> None:
    with pytest.raises(InputError, match=r"stle: unknown key"):
        open_console(InputSpec("console", options={"stle": "5"}))


def test_a_file_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"input console=look\.tsv: the console's channel reads the browser, not a file"
    ):
        open_console(InputSpec("console", "look.tsv"))
