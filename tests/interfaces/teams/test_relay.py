"""The relay stops the wheels on silence, on the loss of the broker and on the console's stop."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from higvf_interfaces.teams import relay
from higvf_interfaces.teams.relay import RefusedError, Watchdog, command_of
from tests.mqtt import Broker, Client, mosquitto, soon

# Notes each command, and tells a pose and its battery at the start.
DRIVER = """
import json, sys
print('{"x": 1.0, "y": 0.5, "theta": 0.1}', flush=True)
print('{"battery": 0.7}', flush=True)
print('not json', flush=True)
with open(sys.argv[1], "a") as out:
    for line in sys.stdin:
        print(line, end="", file=out, flush=True)
    print('{"ended": true}', file=out, flush=True)
"""
MOVING = {"v": 0.1, "w": 0.5}


def test_a_command_is_taken_apart() -> None:
    assert command_of(b'{"v": 0.1, "w": 1, "n": 4, "valid_s": 0.2}') == ({"v": 0.1, "w": 1.0}, 4, 0.2)
    assert command_of(b'{"vx": 0.1, "vy": 0}') == ({"vx": 0.1, "vy": 0.0}, -1, float("inf"))


@pytest.mark.parametrize(
    "raw",
    [b"", b"[1]", b"{}", b'{"v": 1}', b'{"v": NaN, "w": 0}', b'{"v": "1", "w": 0}', b'{"v": 1, "w": 0, "n": 1.5}',
     b'{"v": 1, "w": 0, "valid_s": 0}', b'{"v": 1, "w": true}', b"[" * 1000, b" " * 2000],
)  # fmt: skip
def test_what_is_no_command_is_refused(raw: bytes) -> None:
    with pytest.raises(RefusedError):
        command_of(raw)


def test_a_command_holds_until_it_expires_but_never_longer_than_the_silence() -> None:
    watchdog = Watchdog(0.3)
    assert watchdog.motion(0.0) == {"v": 0.0, "w": 0.0}
    watchdog.hear(MOVING, 1, 60.0, 10.0)
    assert watchdog.motion(10.29) == MOVING
    assert watchdog.motion(10.31) == {"v": 0.0, "w": 0.0}
    watchdog.hear(MOVING, 2, 0.1, 11.0)
    assert watchdog.motion(11.11) == {"v": 0.0, "w": 0.0}


def test_a_late_command_is_refused_while_a_newer_one_holds() -> None:
    watchdog = Watchdog(0.3)
    watchdog.hear(MOVING, 7, 0.3, 10.0)
    with pytest.raises(RefusedError, match="n 6 comes after 7"):
        watchdog.hear(MOVING, 6, 0.3, 10.1)
    watchdog.hear(MOVING, 1, 0.3, 11.0)  # a console that was started anew
    assert watchdog.motion(11.1) == MOVING


class Robot:
    """A relay in a process of its own."""

    def __init__(self, broker: Broker, folder: Path, *arguments: str) -> None:
        self.file = folder / "relay.py"
        shutil.copy(relay.__file__, self.file)  # it runs as this one file
        self.process = subprocess.Popen(
            [sys.executable, "-P", self.file, broker.address, "--name", "1", *arguments],
            stderr=subprocess.PIPE,
            cwd=folder,
        )

    def close(self) -> None:
        self.process.terminate()
        self.process.wait()
        assert self.process.stderr is not None
        self.process.stderr.close()


@pytest.fixture
def driver(tmp_path: Path) -> tuple[str, Callable[[], list[dict[str, float]]]]:
    """Command line of a driver, and what it has been told so far."""
    program, noted = tmp_path / "driver.py", tmp_path / "noted"
    program.write_text(DRIVER)

    def told() -> list[dict[str, float]]:
        lines = noted.read_text().splitlines() if noted.exists() else []
        found: list[dict[str, float]] = []
        for line in lines:
            with suppress(ValueError):  # the last one may be half written
                found.append(json.loads(line))
        return found

    return f"exec {sys.executable} {program} {noted}", told


@pytest.fixture
def own_broker(tmp_path: Path) -> Iterator[Broker]:
    with mosquitto(tmp_path) as broker:
        yield broker


def drive_until(client: Client, holds: Callable[[], object]) -> None:
    """Commands to move until something holds."""
    numbers: list[int] = []

    def sent() -> bool:
        numbers.append(1)
        client.say("robots/1/cmd", {**MOVING, "n": len(numbers), "valid_s": 0.3})
        return bool(holds())

    soon(sent)


def moves(told: list[dict[str, float]]) -> bool:
    return bool(told) and told[-1].get("v", 0.0) > 0.0


def stands(told: list[dict[str, float]]) -> bool:
    return bool(told) and told[-1].get("v") == 0.0


def test_the_wheels_stop_on_silence_and_go_on_with_the_next_command(
    own_broker: Broker, tmp_path: Path, driver: tuple[str, Callable[[], list[dict[str, float]]]]
) -> None:
    command, told = driver
    client = Client(own_broker, "robots/#")
    robot = Robot(own_broker, tmp_path, "--driver", command)
    try:
        soon(lambda: stands(told()))  # before any command
        drive_until(client, lambda: moves(told()))
        soon(lambda: stands(told()))
        soon(lambda: client.of("robots/1/pose") == [{"x": 1.0, "y": 0.5, "theta": 0.1}])
        assert client.of("robots/1/ack")[-1]["battery"] == 0.7
        drive_until(client, lambda: moves(told()))
        client.say("robots/stop", {"stop": True})
        soon(lambda: stands(told()))
    finally:
        robot.close()
        client.close()
    assert told()[-1] == {"ended": True}


def test_the_wheels_stop_when_the_broker_is_lost(
    own_broker: Broker, tmp_path: Path, driver: tuple[str, Callable[[], list[dict[str, float]]]]
) -> None:
    command, told = driver
    client = Client(own_broker, "robots/#")
    robot = Robot(own_broker, tmp_path, "--driver", command, "--silence", "1")
    try:
        drive_until(client, lambda: moves(told()))
        own_broker.kill()
        soon(lambda: stands(told()))
        own_broker.start()
        drive_until(client, lambda: moves(told()))
    finally:
        robot.close()
        client.close()


def test_from_topic_to_topic_a_relay_that_is_killed_leaves_a_command_to_stand(
    own_broker: Broker, tmp_path: Path
) -> None:
    client = Client(own_broker, "motors/1")
    robot = Robot(own_broker, tmp_path, "--to", "motors/1")
    try:
        drive_until(client, lambda: moves(client.of("motors/1")))
        client.say("robots/1/cmd", {**MOVING, "n": 1}, retain=True)
        soon(lambda: stands(client.of("motors/1")))
        drive_until(client, lambda: moves(client.of("motors/1")))
        robot.process.kill()
        soon(lambda: stands(client.of("motors/1")))
    finally:
        robot.close()
        client.close()


def test_a_driver_that_ends_or_takes_no_commands_ends_the_relay(own_broker: Broker, tmp_path: Path) -> None:
    for command, why in (("exit 3", b"the driver has ended"), ("exec sleep 60", b"taken no command for 0.5 s")):
        client = Client(own_broker)
        robot = Robot(own_broker, tmp_path, "--driver", command)
        try:
            drive_until(client, lambda robot=robot: robot.process.poll() is not None)
            assert robot.process.stderr is not None and why in robot.process.stderr.read()
            assert robot.process.returncode == 1
        finally:
            robot.close()
            client.close()
