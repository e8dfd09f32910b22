"""The checker passes what keeps the contract and names what breaks it."""

from collections.abc import Sequence
from dataclasses import replace
from threading import Event
from time import thread_time
from typing import Any

import numpy as np
import pytest

from higvf_console.channels import interface_check
from higvf_console.channels.interface_check import check_interface
from higvf_console.cli.main import main
from higvf_console.core.commands import Cursor, OperatorCommand, Pause, Pick, Resume, StrokePoints
from higvf_console.core.interface import ChannelHealth, ChannelState, InputSpec, OperatorContext


class Good:
    """Pauses once a second of session time."""

    def __init__(self, name: str = "good") -> None:
        self.name = name
        self.now = -1.0
        self.given = 0

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        before, self.now = self.now, context.time
        if int(context.time) == int(before):
            return []
        return [self.signed(Pause(), context)]

    def signed(self, command: OperatorCommand, context: OperatorContext) -> OperatorCommand:
        self.given += 1
        return replace(
            command, time=context.time, source=self.name, operator=context.operator, sequence=self.given
        )  # fmt: skip

    def health(self, now: float) -> ChannelHealth:
        return ChannelHealth(ChannelState.LIVE, f"at {now:g} s")

    def close(self) -> None:
        pass


class Giving(Good):
    """Gives the same command at each poll, as it is told to."""

    def __init__(self, command: Any, **fields: Any) -> None:
        super().__init__()
        self.command, self.fields = command, fields

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        if not isinstance(self.command, Pause | Pick | Cursor | StrokePoints | Resume):
            return [self.command]
        return [replace(self.signed(self.command, context), **self.fields)]


class Hanging(Good):
    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        Event().wait()
        return super().poll(context)


class FailingAfterReset(Good):
    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        if context.time < self.now:
            raise ValueError("time went back")
        return super().poll(context)


class LateAfterReset(Good):
    """Never notices that the time went back."""

    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        self.now = max(self.now, context.time)
        return [self.signed(Pause(), context._replace(time=self.now))]


class SlowToReset(Good):
    def poll(self, context: OperatorContext) -> Sequence[OperatorCommand]:
        if context.time < self.now:
            end = thread_time() + 1.5 * interface_check.LONGEST
            while thread_time() < end:
                pass
        return super().poll(context)


class Ill(Good):
    def health(self, now: float) -> ChannelHealth:
        if now > 1e5:
            raise ZeroDivisionError("no rate yet")
        return super().health(now)


class ClosedOnce(Good):
    closed = False

    def close(self) -> None:
        if self.closed:
            raise OSError("already closed")
        self.closed = True


class Headless:
    name = "good"


def broken(monkeypatch: pytest.MonkeyPatch, interface: object) -> dict[str, str]:
    """The rules that an interface breaks, with what was seen."""

    def opened(_: InputSpec) -> Any:
        return interface

    monkeypatch.setattr(interface_check, "open_interface", opened)
    found = check_interface(InputSpec("good"), seconds=3.0)
    return {finding.rule: finding.detail for finding in found if not finding.kept}


def test_a_good_interface_breaks_no_rule(monkeypatch: pytest.MonkeyPatch) -> None:
    assert broken(monkeypatch, Good()) == {}


@pytest.mark.parametrize(
    ("interface", "rule", "detail"),
    [
        (Headless(), "has poll, health and close", "missing: poll, health, close"),
        (Good("other"), "is named as its channel", "name 'other', channel 'good'"),
        (Giving("pause"), "gives only known commands", "first: 'pause'"),
        (Giving(Pause(), time=1e9), "gives commands in order of time, none from the future", "Pause at 1e+09 s"),
        (Giving(Pause(), time=float("nan")), "gives commands in order of time, none from the future", "nan"),
        (Giving(Pause(), source="console"), "signs commands with source, operator and a running number", "'console'"),
        (Giving(Pause(), sequence=0), "signs commands with source, operator and a running number", "sequence 0"),
        (Giving(Pause(), confidence=87.0), "gives a confidence of 0 to 1, or none", "confidence 87.0"),
        (Giving(Pick(7)), "gives points (n, 2) and robots that are there", "robot index 7 of 3"),
        (Giving(Cursor(np.zeros(3))), "gives points (n, 2) and robots that are there", "Cursor of shape (3,)"),
        (Giving(StrokePoints(np.zeros(2))), "gives points (n, 2) and robots that are there", "StrokePoints of shape"),
        (Giving(StrokePoints(np.full((1, 2), np.nan))), "gives points (n, 2) and robots that are there", "not finite"),
        (FailingAfterReset(), "survives a reset of the time to 0", "ValueError: time went back"),
        (LateAfterReset(), "gives commands in order of time, none from the future after a reset", "Pause at 3 s"),
        (Ill(), "health never fails, and reports a state and a detail", "ZeroDivisionError: no rate yet"),
        (ClosedOnce(), "close may be called twice", "OSError: already closed"),
    ],
)
def test_a_broken_rule_is_named_with_what_was_seen(
    monkeypatch: pytest.MonkeyPatch, interface: object, rule: str, detail: str
) -> None:
    found = broken(monkeypatch, interface)
    assert detail in found[rule]


def test_a_poll_that_hangs_does_not_hang_the_checker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interface_check, "PATIENCE", 0.1)
    assert broken(monkeypatch, Hanging()) == {"poll does not fail": "did not come back within 0.1 s"}


def test_slow_polls_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interface_check, "PROMPT", -1.0)
    assert list(broken(monkeypatch, Good())) == ["poll returns at once", "poll returns at once after a reset"]


def test_a_single_poll_that_holds_the_team_up_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    found = broken(monkeypatch, SlowToReset())
    assert list(found) == ["poll returns at once after a reset"]
    assert found["poll returns at once after a reset"].endswith(" ms at 0 s")


def test_the_command_tells_each_rule_and_its_exit_status(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def opened(_: InputSpec) -> Any:
        return ClosedOnce("console")

    assert main(["check-interface", "console", "--seconds", "1"]) == 0
    monkeypatch.setattr(interface_check, "open_interface", opened)
    assert main(["check-interface", "console", "--seconds", "1"]) == 1
    assert "FAILED close may be called twice: OSError: already closed" in capsys.readouterr().out
    assert main(["check-interface", "console", "--input", "gaze=a.tsv"]) == 2
    assert "the input is for the interface 'gaze', not 'console'" in capsys.readouterr().err
