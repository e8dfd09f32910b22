"""Stops the wheels when commands cease: for robots whose driver has no watchdog. Runs on the robot's side.

    python -m higvf_interfaces.teams.relay mqtt://192.168.1.2 --name 1 --driver './wheels'
    python relay.py mqtt://192.168.1.2 --name 1 --to motors/1

It needs nothing but Python 3.9 and paho-mqtt, and runs as this one file. It takes the commands of one robot from the
broker, passes on the newest, and confirms them. When none has come for `--silence` seconds, when the broker is lost, or
when the console stops all, it passes on a command to stand, at once and then ten times a second.

The driver is a program that reads one JSON object per line, {"v": m/s, "w": rad/s} (or "vx", "vy"), from its standard
input, and may write lines of JSON to its standard output: {"x", "y", "theta", "t"} is published as a pose, {"battery"}
is told with the confirmations. It must stand at the end of its input: then the relay is gone. Instead of a program,
`--to` names a topic of the same broker, with a command to stand as the relay's last will; what hears it must stand by
itself when it loses the broker.
"""

from __future__ import annotations

import argparse
import fcntl
import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast
from urllib.parse import urlsplit

import paho.mqtt.client as paho
from paho.mqtt.enums import CallbackAPIVersion

SILENCE = 0.3  # after which the wheels stop [s]
LONGEST = 1024  # payload that is looked at [bytes]
_AGAIN = 0.1  # after which a command to stand is repeated [s]
_STUCK = 0.5  # a driver that takes no command for so long is ended, so that its wheels stop [s]
_PIPE = 4096  # that a driver may be behind [bytes]
_SET_PIPE_SIZE = 1031  # F_SETPIPE_SZ of Linux
_HEADING, _ANY_WAY = ("v", "w"), ("vx", "vy")


class RefusedError(ValueError):
    """A message is no command."""


def command_of(payload: bytes) -> tuple[dict[str, float], int, float]:
    """Motion, number (-1 = none) and validity [s] (inf = none is told) of a command.

    Raises:
        RefusedError: it is none.
    """
    if len(payload) > LONGEST:
        raise RefusedError(f"{len(payload)} bytes; at most {LONGEST}")
    try:
        read: Any = json.loads(payload)
    except (ValueError, RecursionError) as problem:
        raise RefusedError("it is not JSON") from problem
    values: dict[str, Any] = cast(dict[str, Any], read) if isinstance(read, dict) else {}
    keys = next((keys for keys in (_HEADING, _ANY_WAY) if keys[0] in values), None)
    if keys is None:
        raise RefusedError("it has neither v and w nor vx and vy")
    motion = {key: _finite(values, key, math.nan) for key in keys}
    number = values.get("n", -1)
    if isinstance(number, bool) or not isinstance(number, int):
        raise RefusedError("n is not a whole number")
    valid = _finite(values, "valid_s", math.inf)
    if valid <= 0.0:
        raise RefusedError("valid_s is not greater than 0")
    return motion, number, valid


def _finite(values: dict[str, Any], key: str, otherwise: float) -> float:
    if key not in values and otherwise == math.inf:
        return otherwise
    value = values.get(key)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e9:
        raise RefusedError(f"{key} is not a finite number")
    return float(value)


class Watchdog:
    """Which command holds: the newest that has not expired, else to stand."""

    def __init__(self, silence: float) -> None:
        """Stands; `silence` is the longest time for which a command holds [s]."""
        self._silence = silence
        self._motion: dict[str, float] = {"v": 0.0, "w": 0.0}
        self._number, self._until = -1, -math.inf

    def hear(self, motion: dict[str, float], number: int, valid: float, now: float) -> None:
        """Takes a command.

        Raises:
            RefusedError: it is older than the one that holds, or from another console.
        """
        if 0 <= number < self._number and now < self._until:
            raise RefusedError(f"n {number} comes after {self._number}: it is late, or two consoles drive this robot")
        self._motion, self._number = motion, number
        self._until = now + min(valid, self._silence)

    def stop(self) -> None:
        """Stands until the next command."""
        self._until = -math.inf

    def remaining(self, now: float) -> float:
        """For how long the command holds [s]; 0 = it does not."""
        return max(self._until - now, 0.0)

    def motion(self, now: float) -> dict[str, float]:
        """What the wheels shall do."""
        return dict(self._motion) if now < self._until else dict.fromkeys(self._motion, 0.0)


class Driver:
    """A program that drives the wheels, told by lines on its standard input."""

    def __init__(self, command: str, tells: Callable[[dict[str, Any]], None]) -> None:
        """Starts it; `tells` is called with each object that it writes."""
        self._process = subprocess.Popen(
            command, shell=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
        )
        assert self._process.stdin is not None and self._process.stdout is not None
        self._input, self._output = self._process.stdin, self._process.stdout
        os.set_blocking(self._input.fileno(), False)
        if sys.platform == "linux":
            fcntl.fcntl(self._input.fileno(), _SET_PIPE_SIZE, _PIPE)
        self._tells, self._rest, self._stuck_since = tells, b"", math.nan
        threading.Thread(target=self._read, daemon=True).start()

    def drive(self, motion: dict[str, float]) -> str:
        """Passes a command on, without waiting; returns why the driver has failed, or ""."""
        lines = self._rest + json.dumps(motion).encode() + b"\n"
        try:
            written = os.write(self._input.fileno(), lines)
        except BlockingIOError:
            written = 0
        except OSError:
            return f"the driver has ended (status {self._process.poll()})"
        if written:
            self._stuck_since, self._rest = math.nan, lines[written:]
        elif math.isnan(self._stuck_since):
            self._stuck_since = time.monotonic()
        elif time.monotonic() - self._stuck_since > _STUCK:
            return f"the driver has taken no command for {_STUCK:g} s"
        return ""

    def close(self) -> None:
        """Ends its input, then the program and what it has started."""
        self._input.close()
        try:
            self._process.wait(1.0)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()

    def _read(self) -> None:
        while line := self._output.readline(LONGEST):
            try:
                values: Any = json.loads(line)
            except (ValueError, RecursionError):
                continue
            if isinstance(values, dict):
                self._tells(cast(dict[str, Any], values))


class Relay:
    """Between the broker and the wheels of one robot."""

    def __init__(self, given: argparse.Namespace) -> None:
        """Connects, and starts the driver; errors of the address are `SystemExit`s."""
        topic = f"{given.prefix}/{given.name}"
        self._command, self._stop = f"{topic}/cmd", f"{given.prefix}/stop"
        self._ack, self._pose = f"{topic}/ack", f"{topic}/pose"
        self._to: str | None = given.to
        self._watchdog, self._changed = Watchdog(given.silence), threading.Condition()
        self._new, self._battery, self._counts = False, math.nan, {"refused": 0}
        self._reported = -math.inf
        self._client = self._connected_to(given)
        self._driver = Driver(given.driver, self._told) if given.driver else None

    def run(self) -> str:
        """Until the driver fails; returns why."""
        next_stand = -math.inf
        while True:
            with self._changed:
                now = time.monotonic()
                remaining = self._watchdog.remaining(now)
                wait = min(remaining, _AGAIN) if remaining > 0.0 else max(next_stand - now, 0.0)
                if not self._new and wait > 0.0:
                    self._changed.wait(wait)
                now = time.monotonic()
                fresh, self._new = self._new, False
                stands, motion = self._watchdog.remaining(now) == 0.0, self._watchdog.motion(now)
            if fresh or (stands and now >= next_stand):
                next_stand = now + _AGAIN if stands else now
                if problem := self._pass_on(motion):
                    return problem

    def close(self) -> None:
        """Stops the wheels, ends the driver, disconnects."""
        with self._changed:
            self._watchdog.stop()
            motion = self._watchdog.motion(time.monotonic())
        self._pass_on(motion)
        if self._driver is not None:
            self._driver.close()
        self._client.disconnect()
        self._client.loop_stop()

    def _pass_on(self, motion: dict[str, float]) -> str:
        if self._driver is not None:
            return self._driver.drive(motion)
        self._client.publish(self._to or "", json.dumps(motion))
        return ""

    def _connected_to(self, given: argparse.Namespace) -> paho.Client:
        parts = urlsplit(str(given.broker))
        if parts.scheme not in ("mqtt", "mqtts") or not parts.hostname or "@" in parts.netloc:
            sys.exit(f"relay: {parts.hostname or given.broker!r}: give mqtt://HOST:PORT or mqtts://HOST:PORT")
        client = paho.Client(CallbackAPIVersion.VERSION2)
        client.reconnect_delay_set(1, 2)
        client.suppress_exceptions = True
        client.on_connect, client.on_disconnect, client.on_message = self._connected, self._lost, self._heard
        if given.auth:
            client.username_pw_set(*account_of(Path(given.auth)))
        if parts.scheme == "mqtts":
            client.tls_set(ca_certs=given.ca)  # pyright: ignore[reportUnknownMemberType] (half typed)
        if given.to:
            client.will_set(given.to, json.dumps({"v": 0.0, "w": 0.0}))
        client.connect_async(parts.hostname, parts.port or (8883 if parts.scheme == "mqtts" else 1883), keepalive=2)
        client.loop_start()
        return client

    def _connected(self, client: paho.Client, _data: Any, _flags: Any, reason: Any, _properties: Any) -> None:
        if reason.is_failure:
            self._report(f"the broker refuses: {reason}")
            return
        client.subscribe([(self._command, 0), (self._stop, 0)])

    def _lost(self, *_: Any) -> None:
        with self._changed:
            self._watchdog.stop()
            self._new = True
            self._changed.notify()

    def _heard(self, client: paho.Client, _data: Any, message: paho.MQTTMessage) -> None:
        if message.retain:
            return
        if message.topic == self._stop:
            self._lost()
            return
        try:
            motion, number, valid = command_of(bytes(message.payload))
            with self._changed:
                self._watchdog.hear(motion, number, valid, time.monotonic())
                self._new = True
                self._changed.notify()
        except RefusedError as why:
            self._counts["refused"] += 1
            self._report(f"{self._counts['refused']} messages refused, the last one: {why}")
            return
        if number >= 0:
            told = {"n": number} if math.isnan(self._battery) else {"n": number, "battery": self._battery}
            client.publish(self._ack, json.dumps(told))

    def _told(self, values: dict[str, Any]) -> None:
        battery = values.get("battery")
        if isinstance(battery, (int, float)) and 0.0 <= battery <= 1.0:
            self._battery = float(battery)
        if "x" in values and "y" in values:
            self._client.publish(self._pose, json.dumps(values))

    def _report(self, text: str) -> None:
        """On standard error, at most once a minute."""
        if time.monotonic() - self._reported > 60.0:
            self._reported = time.monotonic()
            print(f"relay: {text}", file=sys.stderr, flush=True)


def account_of(file: Path) -> tuple[str, str]:
    """Name and password out of the lines 'username NAME' and 'password SECRET'."""
    if file.stat().st_mode & 0o077:
        sys.exit(f"relay: --auth {file}: others may read it; run: chmod 600 {file}")
    lines = (line.strip().partition(" ") for line in file.read_text(encoding="utf-8").splitlines())
    found = {key: value for key, _, value in lines}
    return found.get("username", ""), found.get("password", "")


def parser() -> argparse.ArgumentParser:
    """Of the arguments."""
    whole = argparse.ArgumentParser(prog="relay", description="Stops a robot's wheels when its commands cease.")
    whole.add_argument("broker", metavar="mqtt://HOST[:PORT]", help="or mqtts:// for TLS")
    whole.add_argument("--name", required=True, help="of the robot in the topics")
    whole.add_argument("--prefix", default="robots", help="of the topics (default robots)")
    whole.add_argument(
        "--silence", type=float, default=SILENCE, help=f"after which the wheels stop [s] (default {SILENCE:g})"
    )
    whole.add_argument("--auth", metavar="FILE", help="file with 'username NAME' and 'password SECRET'")
    whole.add_argument("--ca", metavar="FILE", help="certificates (PEM) to trust with mqtts://")
    to = whole.add_mutually_exclusive_group(required=True)
    to.add_argument("--driver", metavar="COMMAND", help="program that drives the wheels")
    to.add_argument("--to", metavar="TOPIC", help="topic of the driver")
    return whole


def main() -> int:
    """Runs until the driver ends or it is interrupted."""
    given = parser().parse_args()
    if not 0.0 < given.silence <= 1.0:
        sys.exit(f"relay: --silence {given.silence:g}: give more than 0 and at most 1 s")
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    relay = Relay(given)
    try:
        print(f"relay: {relay.run()}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 0
    finally:
        relay.close()


if __name__ == "__main__":
    sys.exit(main())
