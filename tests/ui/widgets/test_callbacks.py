"""What widgets take from a page, and what the page is told when a value is refused; pure, without a browser."""

import logging
import math
import time
from types import SimpleNamespace
from typing import Any

import pytest

from higvf_console.core.arguments import one_of
from higvf_console.ui.page.notice import telling
from higvf_console.ui.widgets.callbacks import SETTLE_S, chosen, mirror, number_in, reaction, truth


def test_values_that_no_widget_offers_are_refused() -> None:
    for value in ("nothing", 3, None, ["Off"]):
        with pytest.raises(ValueError, match="is not one of Off"):
            chosen(value, {"Off": None})
    for value in (math.nan, math.inf, -1, 10.5, "5", True, None):
        with pytest.raises(ValueError, match="from 0 to 10"):
            number_in(value, 0, 10)
    with pytest.raises(ValueError, match="neither True nor False"):
        truth("True")
    assert chosen("Off", {"Off": 7}) == 7
    assert number_in(10, 0, 10) == 10.0
    assert truth(False) is False


class Client:
    """A page that notes what it is told."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def add_notification(self, title: str, body: str, **_: object) -> None:
        self.told.append(f"{title}: {body}")


def fire(reacts: Any, value: object, client_id: int | None = 1, client: Client | None = None) -> None:
    target = SimpleNamespace(value=value, label="Theme")
    with pytest.raises(StopIteration):  # it waits for nothing, so one step runs it to its end
        reacts(SimpleNamespace(client_id=client_id, client=client, target=target)).send(None)


def test_a_callback_takes_a_page_s_value_but_not_the_console_s_own(caplog: pytest.LogCaptureFixture) -> None:
    taken: list[object] = []
    reacts = reaction(taken.append)
    fire(reacts, "from a page")
    fire(reacts, "from the console", client_id=None)
    assert taken == ["from a page"]
    assert caplog.records == []


def test_a_callback_that_fails_is_logged_and_does_not_raise(caplog: pytest.LogCaptureFixture) -> None:
    fire(reaction(lambda value: chosen(value, {"Off": None})), "evil")
    fire(reaction({}.__delitem__), "anything")
    assert [record.levelno for record in caplog.records] == [logging.WARNING, logging.ERROR]


def test_the_page_is_told_which_field_refused_which_value_and_what_may_be_chosen() -> None:
    client = Client()
    fire(reaction(lambda value: chosen(value, {"Dark": 0, "Light": 1})), "Dork", client=client)
    fire(reaction(lambda value: number_in(value, 0.0, 2.0)), 7, client=client)
    fire(reaction({}.__delitem__), "anything", client=client)
    assert client.told == [
        "Not possible: Theme: 'Dork' is not one of Dark, Light (did you mean 'Dark'?)",
        "Not possible: Theme: 7 is not a number from 0 to 2",
        "Not possible: Theme: it failed, and nothing was done; the reason is in the server's log.",
    ]


def test_a_message_that_is_refused_is_told_to_the_page_that_sent_it() -> None:
    client, taken = Client(), list[tuple[int, str]]()
    server: Any = SimpleNamespace(get_clients=lambda: {3: client})

    def take(client_id: int, word: str) -> None:
        taken.append((client_id, one_of("button", word, ("start", "keep"))))

    heard = telling(server, take)
    heard(3, "start")
    for page in (3, 4):  # the other one has left
        with pytest.raises(ValueError, match="button: 'stert' is not one of start, keep"):
            heard(page, "stert")
    assert taken == [(3, "start")]
    assert client.told == ["Not possible: button: 'stert' is not one of start, keep (did you mean 'start'?)"]


def test_a_widget_that_was_just_touched_is_left_alone_until_the_session_has_answered() -> None:
    touched = SimpleNamespace(value="8", update_timestamp=time.time())
    settled = SimpleNamespace(value="8", update_timestamp=time.time() - 2 * SETTLE_S)
    for widget in (touched, settled):
        mirror(widget, "1")  # pyright: ignore[reportArgumentType]
    assert (touched.value, settled.value) == ("8", "1")
