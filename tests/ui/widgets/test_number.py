"""What people type into a number field, and what is made of it; pure, without a browser."""

import asyncio
import math
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any, cast

import pytest
import viser

from higvf_console.core.numbers import grouped
from higvf_console.ui.widgets.number import NumberField, NumberRange, labelled, number_typed, typed_form

LENGTH = NumberRange("m", 0.0, 5000.0)
RANGE = NumberRange("m", words={"unlimited": math.inf})


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("1e-1", 0.1), ("25", 25.0), (" 25 m ", 25.0), ("2.5", 2.5), ("2,5", 2.5), ("0,125", 0.125), ("1 500", 1500.0),
        (grouped(1500), 1500.0), ("1.5E2", 150.0), ("+3", 3.0), (".5", 0.5),
    ],
)  # fmt: skip
def test_a_number_is_what_was_typed(text: str, number: float) -> None:
    assert number_typed(text, LENGTH) == number


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("1e", "'1e' is not a number"), ("", "'' is not a number"), ("far", "'far' is not a number"),
        ("12 s", "'12 s' is not a number"), ("nan", "not a finite number"), ("inf", "not a finite number"),
        ("-1", "-1 is not from 0 to 5000 m"), ("5001", "5001 is not from 0 to 5000 m"),
        ("1,500", "may part thousands or decimals"), ("1.500,2", "may part thousands or decimals"),
    ],
)  # fmt: skip
def test_what_is_no_such_number_is_refused_with_the_reason(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        number_typed(text, LENGTH)


def test_a_word_stands_for_its_number_and_a_whole_number_has_no_fraction() -> None:
    assert number_typed(" Unlimited ", RANGE) == math.inf
    assert typed_form(math.inf, RANGE.words) == "unlimited"
    with pytest.raises(ValueError, match=r"2\.5 is not a whole number"):
        number_typed("2.5", NumberRange(low=1, high=9, whole=True))


def test_a_number_is_shown_as_it_is_typed_with_its_unit_in_the_label() -> None:
    assert [typed_form(value) for value in (0.1, -0.0, 249.99998680, 1e-7)] == ["0.1", "0", "249.999987", "1e-07"]
    assert labelled("Smoothing", "m") == "Smoothing (m)"
    assert labelled("Needs", "") == "Needs"


class Widget:
    """A text field, and a page that types into it and is told something."""

    update_timestamp = 0.0

    def __init__(self) -> None:
        self.value, self.react, self.told = "", cast(Any, None), list[str]()

    def on_update(self, react: Any) -> None:
        self.react = react

    def tell(self, _title: str, body: str, **_: object) -> None:
        self.told.append(body)

    def type(self, text: str, client_id: int | None = 7) -> None:
        self.value = text
        client = SimpleNamespace(add_notification=self.tell)
        event = SimpleNamespace(client_id=client_id, client=client, target=self)
        with ThreadPoolExecutor(1) as server:  # this thread may have a loop of a browser test
            server.submit(lambda: asyncio.run(self.react(event))).result()


def field(widget: Widget, heard: list[float]) -> NumberField:
    def add_text(_label: str, value: str, **_: Any) -> Widget:
        widget.value = value
        return widget

    gui = cast(viser.GuiApi, SimpleNamespace(add_text=add_text))
    return NumberField(gui, "Smoothing", 2.0, LENGTH, heard.append)


def test_a_field_gives_the_number_and_refuses_what_is_none_in_words_and_shows_the_old_one() -> None:
    widget, heard = Widget(), list[float]()
    shown = field(widget, heard)
    widget.type("1e-1")
    widget.type("9", client_id=None)  # the console's own assignment
    assert heard == [0.1]
    shown.show(0.1)
    assert widget.value == "0.1"
    widget.type("soft")
    assert heard == [0.1]
    assert widget.value == "0.1"
    assert widget.told == ["Smoothing: 'soft' is not a number; 0.1 stays."]
