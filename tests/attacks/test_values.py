"""Wrong values, random bytes: no traceback, a log that stays small, and an honest page that goes on."""

import logging
import random
import struct
from collections.abc import Callable
from typing import Any

import pytest

from tests.attacks.raw_page import Login, RawPage, framed, message, said
from tests.browser import wait_until
from tests.consoles import Running
from tests.ui.page.test_message_table import CAMERA, HONEST

WRONG: tuple[Any, ...] = (
    None, True, -1, 0, 2**63, 1e308, float("nan"), float("inf"), "", "x" * 100_000, "\0", b"\xff" * 50, [], [[]],
    [None] * 1000, {}, {"value": {"value": 1}}, [float("nan")] * 4, "../../etc/passwd", "<script>alert(1)</script>",
)  # fmt: skip
MOST_LINES = 60  # of the log in a minute, whatever comes: one for each kind, that is for each field
LONGEST_LINE = 300  # characters


def wrong_bodies(topic: str, chance: random.Random) -> list[bytes]:
    """Each field with each wrong value, and some fields missing or too many."""
    body = HONEST[topic]
    frames = [said(topic, **body | {field: value}) for field in body for value in WRONG]
    frames += [said(topic, **{k: v for k, v in body.items() if k != field}) for field in body]
    return [*frames, said(topic, **body, more=chance.choice(WRONG))]


def test_wrong_values_of_every_field_of_our_own_messages(
    running: Running, honest: RawPage, login: Login, caplog: pytest.LogCaptureFixture, figure: Callable[[str], None]
) -> None:
    chance = random.Random(13)
    frames = [frame for topic in HONEST for frame in wrong_bodies(topic, chance)]
    attack(running, honest, login, frames, caplog, figure)


def test_wrong_values_of_every_widget(
    running: Running, honest: RawPage, login: Login, caplog: pytest.LogCaptureFixture, figure: Callable[[str], None]
) -> None:
    uuids = list(running.server.gui._gui_input_handle_from_uuid)  # pyright: ignore[reportPrivateUsage]
    frames = [message("GuiUpdateMessage", uuid=uuid, updates={"value": value}) for uuid in uuids for value in WRONG]
    attack(running, honest, login, frames, caplog, figure)


def test_wrong_values_of_viser_s_messages(
    running: Running, honest: RawPage, login: Login, caplog: pytest.LogCaptureFixture, figure: Callable[[str], None]
) -> None:
    frames = [message("ViewerCameraMessage", **CAMERA | {field: value}) for field in CAMERA for value in WRONG]
    frames += [message("CommandTriggerMessage", uuid=value) for value in WRONG]
    frames += [message("GuiUpdateMessage", uuid="u", updates=value) for value in WRONG]
    attack(running, honest, login, frames, caplog, figure)


def test_random_bytes(
    running: Running, honest: RawPage, login: Login, caplog: pytest.LogCaptureFixture, figure: Callable[[str], None]
) -> None:
    chance = random.Random(7)
    frames = [framed(chance.randbytes(chance.randrange(400)), chance.choice((1, 2))) for _ in range(300)]
    whole = said("viewport", **HONEST["viewport"])[6:]
    for _ in range(300):
        place = chance.randrange(len(whole))
        frames.append(framed(whole[:place] + struct.pack("B", chance.randrange(256)) + whole[place + 1 :]))
    attack(running, honest, login, frames, caplog, figure)


def attack(
    running: Running,
    honest: RawPage,
    login: Login,
    frames: list[bytes],
    caplog: pytest.LogCaptureFixture,
    figure: Callable[[str], None],
) -> None:
    """Sends the frames from a page that steers, a new one for every 300, since one page may not send so many."""
    roles = running.console._roles  # pyright: ignore[reportPrivateUsage]
    caplog.set_level(logging.WARNING)
    for start in range(0, len(frames), 300):
        with RawPage(running.url, login) as attacker:
            identity = f"the attacker, page {start:06}"
            attacker.hello(identity)
            attacker.send(said("control", act="take", page=""))
            attacker.send(*frames[start : start + 300])
            attacker.hello(identity)
            attacker.send(framed(struct.pack("!H", 1000), 8))
            assert attacker.closed.wait(60.0)
    wait_until(lambda: len(roles._identities) == 1)  # pyright: ignore[reportPrivateUsage]
    honest.send(said("control", act="take", page=""), said("key", name="pick_1", number=0))
    honest.send(said("key", name="pick_3", number=0))
    wait_until(lambda: running.state.intent.influenced == 2)
    figure(f"{len(frames)} messages")
    figure(f"{len(caplog.records)} lines of log")
    assert not [record.getMessage() for record in caplog.records if record.exc_info]
    assert len(caplog.records) <= MOST_LINES
    assert max((len(record.getMessage()) for record in caplog.records), default=0) <= LONGEST_LINE
    assert running.session.error is None
