"""Latency, jitter and loss hold for every interface, and their sizes are as given."""

import itertools
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from higvf_console.channels import channels as opening
from higvf_console.channels.channels import Channels, open_interface
from higvf_console.channels.input_reports import Reporter
from higvf_console.channels.inspection import inspect
from higvf_console.channels.link import Link, LinkErrors, split_link
from higvf_console.core.commands import Acknowledge, EmergencyStop, HandOver, NextTask, OperatorCommand, Pause
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelHealth, ChannelState, InputSpec, OperatorContext
from tests.fake_interfaces import FakeInterface

LATE = {"latency": "0.5"}


def at(time: float) -> OperatorContext:
    return OperatorContext(time, "o", None, False, False, 0, (), 3)


def log(tmp_path: Path, text: str = "time,label\n1,robot1\n") -> str:
    path = tmp_path / "log.csv"
    path.write_text(text)
    return str(path)


class Pressed:
    """A device that gives what it was made with, each command at its time."""

    name = "glove"

    def __init__(self, commands: Sequence[OperatorCommand]) -> None:
        self.commands = list(commands)

    def poll(self, context: OperatorContext) -> list[OperatorCommand]:
        due = [command for command in self.commands if command.time <= context.time]
        self.commands = [command for command in self.commands if command.time > context.time]
        return due

    def health(self, now: float) -> ChannelHealth:
        return ChannelHealth(ChannelState.ENDED if not self.commands else ChannelState.LIVE, f"at {now:g}")

    def close(self) -> None:
        self.commands = []


def test_the_link_is_that_of_any_interface_which_is_not_told_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[InputSpec] = []

    def opener(spec: InputSpec) -> Pressed:
        told.append(spec)
        return Pressed([Pause(time=1.0)])

    point = SimpleNamespace(name="glove", value="glove:open", load=lambda: opener)

    def installed(group: str) -> list[SimpleNamespace]:
        return [point] if group == opening.GROUP else []

    monkeypatch.setattr(opening, "entry_points", installed)
    glove = open_interface(InputSpec("glove", "", {**LATE, "seed": "3", "hand": "left"}, {"jitter": 0.0}))
    assert (dict(told[0].options), dict(told[0].settings), told[0].seed) == ({"hand": "left"}, {}, 3)
    assert glove.poll(at(1.2)) == []
    assert "emulated link: latency=0.5" in glove.health(1.2).detail
    assert [command.time for command in glove.poll(at(2.0))] == [1.5]
    open_interface(InputSpec("glove", "", {"seed": "3"}))
    assert dict(told[1].options) == {"seed": "3"}, "without a link, the option is the interface's own"


def test_latency_jitter_and_dropout_have_the_given_sizes() -> None:
    times = np.arange(1, 3001) / 10
    link = Link(Pressed([NextTask(time=time) for time in times.tolist()]), LinkErrors(0.4, 0.02, 0.3, 0))
    come = [command for k in range(310) for command in link.poll(at(float(k)))]
    assert len(come) / len(times) == pytest.approx(0.7, abs=0.03)
    late = [command.time - round(command.time - 0.41, 1) for command in come]
    assert np.mean(late) == pytest.approx(0.42, abs=0.01)
    assert [command.sequence for command in come] == list(range(len(come)))
    assert all(one.time <= other.time for one, other in itertools.pairwise(come))


def test_what_arrives_does_not_depend_on_the_polling_rate_but_on_the_seed() -> None:
    def played(period: float, seed: int) -> list[float]:
        link = Link(Pressed([NextTask(time=k / 10) for k in range(300)]), LinkErrors(0.3, 0.5, 0.2, seed))
        return [command.time for k in range(round(60 / period)) for command in link.poll(at(k * period))]

    assert played(0.02, 7) == played(1.0, 7)
    assert played(1.0, 7) != played(1.0, 8)


def test_a_stroke_stays_complete_and_stop_is_never_lost(tmp_path: Path) -> None:
    text = (
        "- {at_s: 1, do: stroke, points_m: [[0, 0], [10, 0], [20, 5]]}\n- {at_s: 2, do: pause}\n- {at_s: 2, do: stop}\n"
    )
    script = open_interface(InputSpec("script", log(tmp_path, text), {"latency": "0.3", "dropout": "1"}))
    assert script.poll(at(1.2)) == []
    come = [(type(command).__name__, command.time) for command in script.poll(at(4.0))]
    assert come == [("StrokeBegin", 1.3), ("StrokeEnd", 1.3), ("EmergencyStop", 2.3)]


def test_who_steers_and_what_is_acknowledged_pass_at_once() -> None:
    device = Pressed(
        [Pause(time=1.0), Acknowledge(time=1.0), HandOver("a", "first", time=1.0), EmergencyStop(time=1.0)]
    )
    link = Link(device, LinkErrors(5.0, 0.0, 1.0, 0))
    assert [type(command) for command in link.poll(at(1.0))] == [Acknowledge, HandOver]
    assert [type(command) for command in link.poll(at(6.0))] == [EmergencyStop]


def test_a_channel_has_not_ended_while_a_command_is_on_its_way_and_a_reset_drops_it(tmp_path: Path) -> None:
    bci = open_interface(InputSpec("bci", log(tmp_path), {"latency": "5"}))
    assert bci.poll(at(3.0)) == []
    assert bci.health(3.0).state is ChannelState.LIVE
    assert [list(bci.poll(at(time))) for time in (0.0, 0.5, 0.99)] == [[], [], []]
    assert [command.time for command in bci.poll(at(6.0))] == [6.0]
    assert bci.health(6.0).state is ChannelState.ENDED


def test_the_console_may_have_a_link_and_still_takes_the_pages_commands() -> None:
    channels = Channels([open_interface(InputSpec("console", "", LATE)), FakeInterface("eye")])
    assert channels.pointer_name == "console"
    channels.pointer.heartbeat()
    channels.pointer.push(Pause())
    assert channels.poll(at(1.0))[0]["console"] == []
    assert [type(command) for command in channels.poll(at(1.6))[0]["console"]] == [Pause]


def test_reports_are_asked_of_the_interface_behind_the_link(tmp_path: Path) -> None:
    channels = Channels([open_interface(InputSpec("bci", log(tmp_path), LATE))])
    channels.poll(at(1.1))
    ((name, report),) = Reporter(channels, 0.02).take(1.1).decisions
    assert (name, report.label) == ("bci", "robot1")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"latency": -1}, "input bci: latency: -1 is not a number from 0 to 60 s"),
        ({"dropout": "much"}, "dropout: 'much' is not a number from 0 to 1"),
        ({"jitter": 1, "seed": -1}, "seed: -1 is not a number from 0"),
    ],
)
def test_invalid_errors_of_a_link_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        split_link(InputSpec("bci", settings=options))
    assert message in str(refusal.value)


def test_an_inspection_says_that_the_link_is_left_out(tmp_path: Path) -> None:
    told = inspect(InputSpec("bci", log(tmp_path), {"latency": "0.4", "dropout": "0.1"}))
    assert told["warnings"] == [
        "latency=0.4, dropout=0.1: errors of the link, which hold in a run and are not applied here"
    ]
